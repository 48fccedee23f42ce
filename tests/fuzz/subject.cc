#include "tests/fuzz/subject.h"

#include "tests/fuzz/invariants.h"
#include "tests/support/placed.h"
#include "tests/support/same.h"

#include <algorithm>
#include <cstring>

namespace kerf::fuzz {

using grid::CellId;
using grid::CornerId;

namespace {

std::vector<CellId> cells_around(const grid::Grid& grid, const std::span<const grid::EdgeCut> cuts) {
  std::vector<CellId> cells;
  for (const auto& cut : cuts)
    for (const CellId c : grid.cells(cut.edge))
      if (c.valid())
        cells.push_back(c);
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

/// Those whose heirs must share the mass corner by corner: a cell of one copy that a plane skin bounds, or none.
std::vector<CellId> cells_that_keep_mass(const Subject& subject, std::vector<CellId> cells) {
  const grid::CellComplex& complex = subject.complex;
  std::erase_if(cells, [&](const CellId c) {
    const bool one_copy = !complex.copies[complex.first_copy[c]].next.valid();
    return !one_copy || (subject.specimen.skin == Skin::curved && support::is_skin_cell(subject.grid(), c));
  });
  return cells;
}

/// The skin keeps its volume vertex by vertex: what one cell loses, its neighbour wins. How much that is, is told.
void measure_skin_cells(const Subject& subject, const std::vector<CellId>& cells, Tally& tally) {
  for (const CellId c : cells) {
    double change = 0;
    for (int v = 0; v < 8; ++v)
      if (subject.grid().is_material(subject.grid().nodes(c)[v]))
        change += subject.octants[c][v] - subject.first_octants[c][v];
    tally.worst_skin_cell = std::max(tally.worst_skin_cell, std::abs(change));
  }
}

void require_inherited(const Table<CornerId, double>& before, const Table<CornerId, double>& after,
                       const Table<CornerId, CornerId>& parents, Tally& tally) {
  Table<CornerId, double> inherited(before.size(), 0.0);
  for (const auto corner : ids<CornerId>(after.size()))
    inherited[parents[corner]] += after[corner];
  for (const auto corner : ids<CornerId>(before.size())) {
    const double difference = std::abs(inherited[corner] - before[corner]);
    tally.n_masses += before[corner] > 0;
    tally.worst_mass = std::max(tally.worst_mass, difference);
    if (!(difference < 1e-12))
      throw Violation("the mass of corner " + std::to_string(corner.value) + " changes by " +
                      std::to_string(1e12 * difference) + "e-12 h^3 on its way to its heirs");
  }
}

/// Where each corner comes from; the old ones stay.
Table<CornerId, CornerId> all_parents(const grid::ComplexChange& change) {
  Table<CornerId, CornerId> parents;
  for (const auto corner : ids<CornerId>(change.n_corners_before))
    parents.push_back(corner);
  for (const CornerId parent : change.parents)
    parents.push_back(parent);
  return parents;
}

/// Updated is built anew.
void require_as_built(const Subject& subject) {
  const auto complex = grid::build_complex(subject.grid(), subject.cuts);
  const auto names = support::renaming(subject.complex, complex);
  if (!names)
    throw Violation("the updated complex is not the one that is built");
  if (!support::is_same(subject.surface, surface::build_surface(subject.grid(), subject.cuts, complex), *names))
    throw Violation("the updated surface is not the one that is built");
}

class Fnv {
 public:
  explicit Fnv(const std::uint64_t start) : value(start) {}

  template <class T>
  void add(const T& item) {
    std::array<unsigned char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), &item, sizeof(T));
    for (const unsigned char byte : bytes)
      value = (value ^ byte) * 0x100000001b3;
  }
  void add(const Points& points) {
    for (const Vec3& p : points)
      for (const double coordinate : p)
        add(coordinate);
  }

  std::uint64_t value;
};

} // namespace

Subject make_subject(const Specimen& specimen, Tally& tally) {
  const grid::Grid& grid = specimen.body.grid;
  auto complex = grid::build_complex(grid, specimen.body.cuts);
  cut::EdgeBoxes boxes(grid, complex);
  Subject subject{specimen,
                  specimen.body.cuts,
                  std::move(complex),
                  {},
                  {},
                  std::move(boxes),
                  {},
                  {},
                  Table<CellId, OctantVolumes>(grid.n_cells()),
                  {},
                  0};
  subject.surface = surface::build_surface(grid, subject.cuts, subject.complex, subject.index);
  subject.x = subject.x_before = grid::rest_positions(grid, subject.complex);
  subject.volume = surface::enclosed_volume(subject.surface.rest, subject.surface.triangles);
  for (const CellId c : ids<CellId>(grid.n_cells()))
    subject.octants[c] = require_positive_octants(grid, subject.cuts, c);
  subject.first_octants = subject.octants;
  require_sound(subject, tally);
  return subject;
}

void cut(Subject& subject, const std::span<const grid::EdgeCut> cuts, Tally& tally) {
  const grid::Grid& grid = subject.grid();
  const auto cells = cells_around(grid, cuts), keeping = cells_that_keep_mass(subject, cells);
  const auto masses = corner_masses(grid, subject.cuts, subject.complex, keeping);

  std::vector<grid::EdgeId> edges;
  for (const auto& cut : cuts) {
    subject.cuts.add(cut);
    edges.push_back(cut.edge);
  }
  const auto placed = surface::place(grid, subject.cuts, edges, {});
  const auto before = subject.complex;
  const auto change = grid::update_complex(grid, subject.cuts, edges, subject.complex);
  const auto parents = all_parents(change);
  require_sound_change(before, subject.complex, change);
  require_sound_parents(before, subject.complex, parents);
  surface::update_surface(grid, subject.cuts, subject.complex, edges, change, subject.surface, subject.index);
  require_as_built(subject);
  grid::inherit(change, subject.x);
  grid::inherit(change, subject.x_before);

  for (const CellId c : cells)
    subject.octants[c] = require_positive_octants(grid, subject.cuts, c);
  measure_skin_cells(subject, cells, tally);
  require_sound(subject, tally);
  require_inherited(masses, corner_masses(grid, subject.cuts, subject.complex, keeping), parents, tally);

  ++tally.n_releases;
  tally.n_cut_edges += cuts.size();
  tally.n_placed += placed.n_placed;
  tally.n_clamped += placed.n_clamped;
  tally.n_most_pieces = std::max<std::size_t>(tally.n_most_pieces, grid::n_pieces(subject.complex));
}

std::uint64_t digest(const Subject& subject, const std::uint64_t start) {
  Fnv sum(start);
  for (const auto& cut : subject.cuts.all()) {
    sum.add(cut.edge.value);
    sum.add(cut.t);
    sum.add(Points{cut.normal});
    sum.add(cut.label);
  }
  for (const auto& copy : subject.complex.copies) {
    sum.add(copy.nodes);
    for (const auto corner : copy.corners)
      sum.add(corner.value);
  }
  Points positions;
  surface::follow(subject.surface, subject.x, positions);
  for (const Points& points : {subject.x, subject.x_before, subject.surface.rest, positions})
    sum.add(points);
  for (const auto& triangle : subject.surface.triangles)
    sum.add(triangle);
  return sum.value;
}

} // namespace kerf::fuzz
