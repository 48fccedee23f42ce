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

std::vector<CellId> cells_around(const grid::Grid& grid, const std::span<const grid::EdgeId> edges) {
  std::vector<CellId> cells;
  for (const auto e : edges)
    for (const CellId c : grid.cells(e))
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

/// How much material a cell of the skin wins or loses is told.
void measure_skin_cells(const Subject& subject, const std::vector<CellId>& cells, Tally& tally) {
  for (const CellId c : cells)
    tally.worst_skin_cell =
      std::max(tally.worst_skin_cell, std::abs(subject.volumes[c].sum() - subject.first_volumes[c]));
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

/// What `cuts` has more than the complex and the surface: edges that are cut or named, maybe twice.
void follow_cuts(Subject& subject, const grid::Cuts& cuts, const std::span<const grid::EdgeId> edges, Tally& tally) {
  const grid::Grid& grid = subject.grid();
  const auto cells = cells_around(grid, edges), keeping = cells_that_keep_mass(subject, cells);
  const auto masses = corner_masses(grid, subject.cuts, subject.complex, keeping);
  tally.n_cut_edges += cuts.all().size() - subject.cuts.all().size();
  tally.n_rinds += cuts.n_cut_twice() - subject.cuts.n_cut_twice();

  subject.cuts = cuts;
  const auto placed = surface::place(grid, subject.cuts, {});
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
    subject.volumes[c] = require_sound_volumes(grid, subject.cuts, subject.complex, c, tally);
  measure_skin_cells(subject, cells, tally);
  require_sound(subject, tally);
  require_inherited(masses, corner_masses(grid, subject.cuts, subject.complex, keeping), parents, tally);

  ++tally.n_releases;
  tally.n_placed += placed.n_placed;
  tally.n_clamped += placed.n_clamped;
  tally.n_most_pieces = std::max<std::size_t>(tally.n_most_pieces, grid::n_pieces(subject.complex));
}

bool is_of_skin(const grid::Grid& grid, const grid::EdgeId e) {
  const auto& [lower, upper] = grid.ends(e);
  return grid.is_material(lower) != grid.is_material(upper);
}

bool is_cut_by_blade(const grid::Grid& grid, const grid::Cuts& cuts, const grid::EdgeId e) {
  return cuts.is_cut_twice(e) || (cuts.is_cut(e) && !is_of_skin(grid, e));
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
  Subject subject{.specimen = specimen,
                  .cuts = specimen.body.cuts,
                  .complex = std::move(complex),
                  .surface = {},
                  .index = {},
                  .boxes = std::move(boxes),
                  .open_ends = {},
                  .x = {},
                  .x_before = {},
                  .volumes = {},
                  .first_volumes = {}};
  subject.surface = surface::build_surface(grid, subject.cuts, subject.complex, subject.index);
  subject.x = subject.x_before = grid::rest_positions(grid, subject.complex);
  subject.volume = surface::enclosed_volume(subject.surface.rest, subject.surface.triangles);
  for (const CellId c : ids<CellId>(grid.n_cells())) {
    subject.volumes.push_back(require_sound_volumes(grid, subject.cuts, subject.complex, c, tally));
    subject.first_volumes.push_back(subject.volumes[c].sum());
  }
  require_sound(subject, tally);
  return subject;
}

void cut(Subject& subject, const std::span<const grid::EdgeCut> new_cuts, const Front front, Tally& tally) {
  grid::Cuts cuts = subject.cuts;
  const auto edges = cut::add_cuts(subject.grid(), cuts, subject.complex, subject.x, new_cuts, front).edges;
  if (!edges.empty())
    follow_cuts(subject, cuts, edges, tally);
}

void cut(Subject& subject, const std::span<const grid::EdgeCut> new_cuts,
         const std::span<const std::array<Vec3, 3>> strip, const grid::CutLabel of_strip,
         const cut::PendingCuts& pending, Tally& tally) {
  const grid::Grid& grid = subject.grid();
  grid::Cuts cuts = subject.cuts;
  std::vector<grid::EdgeId> ended;
  constexpr std::span<const std::array<Vec3, 3>> gone;
  for (auto& [label, ends] : subject.open_ends)
    for (const auto e :
         ends.close(label == of_strip ? strip : gone, pending, grid, cuts, subject.complex, subject.x, label))
      ended.push_back(e);
  tally.n_ended += ended.size();
  auto edges = cut::add_cuts(grid, cuts, subject.complex, subject.x, new_cuts, Front::possible).edges;
  edges.insert(edges.end(), ended.begin(), ended.end());
  if (edges.empty())
    return;
  follow_cuts(subject, cuts, edges, tally);
  for (const auto& cut : new_cuts)
    subject.open_ends[cut.label];
  for (auto& [label, ends] : subject.open_ends)
    ends.note(grid, subject.cuts, edges, label);
}

void cut(Subject& subject, const grid::histories::Step& step, Tally& tally) {
  grid::Cuts cuts = subject.cuts;
  std::vector<grid::EdgeId> edges;
  for (const auto& cut : step.cuts) {
    cuts.add(subject.grid(), cut);
    edges.push_back(cut.edge);
  }
  for (const auto& [face, seam] : step.seams) {
    cuts.set_seam(face, seam);
    for (const auto e : grid::histories::edges_of(subject.grid(), face))
      if (seam == grid::Seam::parted && is_cut_by_blade(subject.grid(), cuts, e))
        edges.push_back(e);
  }
  follow_cuts(subject, cuts, edges, tally);
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
    sum.add(copy.rinds);
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
