#include "tests/fuzz/subject.h"

#include "tests/fuzz/invariants.h"
#include "tests/support/placed.h"

#include <algorithm>
#include <cstring>

namespace kerf::fuzz {

using grid::CellId;
using grid::CornerId;

namespace {

Specimen box(const std::string& name, const Vec3& size, const double h, const Vec3& offset) {
  return {name, support::embedded(geometry::box_mesh(Vec3::Zero(), size), h, offset), Skin::plane};
}

Specimen sphere(const std::string& name, const double h, const Vec3& offset) {
  return {name, support::embedded(geometry::sphere_mesh(1, Vec3::Zero(), 3), h, offset), Skin::curved};
}

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
  const auto& first_copy = subject.complex.first_copy;
  std::erase_if(cells, [&](const CellId c) {
    const bool one_copy = first_copy[CellId(c.value + 1)] - first_copy[c] == 1;
    return !one_copy || (subject.specimen.skin == Skin::curved && support::is_skin_cell(subject.grid(), c));
  });
  return cells;
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

Points inherited(const Points& of_corners, const Table<CornerId, CornerId>& parents) {
  Points values;
  for (const auto parent : parents)
    values.push_back(of_corners[parent.value]);
  return values;
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

std::vector<Specimen> small_specimens() {
  const auto liver = support::liver_mesh();
  std::vector<Specimen> all;
  all.push_back(box("box on lattice planes", {0.5, 0.4, 0.3}, 0.1, Vec3::Zero()));
  all.push_back(box("box midway", {0.4, 0.4, 0.3}, 0.1, Vec3::Constant(0.5)));
  all.push_back(box("box anywhere", {0.53, 0.37, 0.31}, 0.1, {0.31, 0.83, 0.12}));
  all.push_back(box("cube in binary fractions", Vec3::Ones(), 0.25, Vec3::Zero()));
  all.push_back(box("plate of one node", {0.6, 0.6, 0.05}, 0.1, {0.5, 0.5, 0.25}));
  all.push_back(box("rod", {0.9, 0.1, 0.1}, 0.1, Vec3::Constant(0.5)));
  all.push_back(sphere("sphere", 0.37, Vec3::Zero()));
  all.push_back(sphere("sphere off the lattice", 0.41, {0.2, 0.4, 0.9}));
  all.push_back({"liver", support::embedded(liver, 0.032, {0.5, 0.3, 0.1}), Skin::curved});
  all.push_back({"coarse liver", support::embedded(liver, 0.045, Vec3::Zero()), Skin::curved});
  return all;
}

std::vector<Specimen> large_specimens() {
  std::vector<Specimen> all;
  all.push_back(box("large box", {1.4, 1.3, 1.2}, 0.1, Vec3::Zero()));
  all.push_back(sphere("large sphere", 0.13, Vec3::Zero()));
  all.push_back({"large liver", support::embedded(support::liver_mesh(), 0.011, {0.5, 0.3, 0.1}), Skin::curved});
  return all;
}

Subject make_subject(const Specimen& specimen, Tally& tally) {
  const grid::Grid& grid = specimen.body.grid;
  Subject subject{specimen, specimen.body.cuts, {}, {}, {}, {}, Table<CellId, OctantVolumes>(grid.n_cells()), 0};
  subject.complex = grid::build_complex(grid, subject.cuts);
  subject.surface = surface::build_surface(grid, subject.cuts, subject.complex);
  subject.x = subject.x_before = grid::rest_positions(grid, subject.complex);
  subject.volume = surface::enclosed_volume(subject.surface.rest, subject.surface.triangles);
  for (const CellId c : ids<CellId>(grid.n_cells()))
    subject.octants[c] = require_positive_octants(grid, subject.cuts, c);
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
  auto complex = grid::build_complex(grid, subject.cuts);
  const auto parents = grid::parents(subject.complex, complex);
  require_sound_parents(subject.complex, complex, parents);
  subject.complex = std::move(complex);
  subject.surface = surface::build_surface(grid, subject.cuts, subject.complex);
  subject.x = inherited(subject.x, parents);
  subject.x_before = inherited(subject.x_before, parents);

  for (const CellId c : cells)
    subject.octants[c] = require_positive_octants(grid, subject.cuts, c);
  require_sound(subject, tally);
  require_inherited(masses, corner_masses(grid, subject.cuts, subject.complex, keeping), parents, tally);

  ++tally.n_releases;
  tally.n_cut_edges += cuts.size();
  tally.n_placed += placed.n_placed;
  tally.n_clamped += placed.n_clamped;
  tally.n_most_pieces = std::max<std::size_t>(tally.n_most_pieces, subject.complex.n_pieces);
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
