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

/// Those whose heirs must share the mass corner by corner: cells of one copy. Where a cell has several, a later cut may
/// move the vertex that they share.
std::vector<CellId> cells_that_keep_mass(const grid::CellComplex& complex, std::vector<CellId> cells) {
  std::erase_if(cells, [&](const CellId c) { return complex.copies[complex.first_copy[c]].next.valid(); });
  return cells;
}

/// The skin stays where it is, and so every cell keeps its material.
void require_kept_cells(const Subject& subject, const std::vector<CellId>& cells, Tally& tally) {
  for (const CellId c : cells) {
    const double change = std::abs(subject.volumes[c].sum() - subject.first_volumes[c]);
    tally.worst_cell = std::max(tally.worst_cell, change);
    if (!(change < 1e-12))
      throw Violation("the material of cell " + std::to_string(c.value) + " changes by " +
                      std::to_string(1e12 * change) + "e-12 h^3");
  }
}

void require_inherited(const Table<CornerId, double>& before, const Table<CornerId, double>& after,
                       const Table<CornerId, CornerId>& parents, UnionFind together, Tally& tally) {
  Table<CornerId, double> missing(before.size(), 0.0);
  for (const auto corner : ids<CornerId>(before.size()))
    missing[CornerId(together.root(corner.value))] += before[corner];
  for (const auto corner : ids<CornerId>(after.size()))
    missing[CornerId(together.root(parents[corner].value))] -= after[corner];
  for (const auto corner : ids<CornerId>(before.size())) {
    const double difference = std::abs(missing[corner]);
    tally.n_masses += before[corner] > 0;
    tally.worst_mass = std::max(tally.worst_mass, difference);
    if (!(difference < 1e-12))
      throw Violation("the mass of corner " + std::to_string(corner.value) + " changes by " +
                      std::to_string(1e12 * difference) + "e-12 h^3 on its way to its heirs");
  }
}

/// Where each corner comes from; the old ones stay.
Table<CornerId, CornerId> all_parents(const grid::CutChange& change) {
  Table<CornerId, CornerId> parents;
  for (const auto corner : ids<CornerId>(change.n_corners_before))
    parents.push_back(corner);
  for (const CornerId parent : change.parents)
    parents.push_back(parent);
  return parents;
}

/// Updated is built anew.
void require_as_built(const Subject& subject) {
  const grid::Solid built = support::with_copies(subject.solid);
  const auto names = support::renaming(subject.solid.complex, built.complex);
  if (!names)
    throw Violation("the updated complex is not the one that is built");
  if (!support::is_same(subject.surface, surface::build_surface(built), *names))
    throw Violation("the updated surface is not the one that is built");
}

/// Lets all else follow what has become of the solid that was `before`.
void follow_cut(Subject& subject, const grid::Solid& before, grid::CutChange& change, Tally& tally) {
  grid::Solid& solid = subject.solid;
  tally.n_cut_edges += solid.cuts.all().size() - before.cuts.all().size();
  tally.n_below_skin += solid.cuts.n_cut_twice() - before.cuts.n_cut_twice();
  tally.n_of_skin += solid.cuts.skin_cuts().size() - before.cuts.skin_cuts().size();

  const auto placed = surface::place(solid, change, {});
  const auto keeping = cells_that_keep_mass(before.complex, change.cells);
  const auto parents = all_parents(change);
  require_sound_change(before.complex, solid.complex, change);
  const UnionFind together = require_sound_parents(before.complex, solid.complex, parents);
  surface::update_surface(solid, change, subject.surface, subject.index);
  require_as_built(subject);
  grid::inherit(change, subject.x);
  grid::update_pieces(solid, change, subject.pieces);

  for (const CellId c : change.cells)
    subject.volumes[c] = require_sound_volumes(solid, c);
  require_kept_cells(subject, change.cells, tally);
  require_sound(subject, tally);
  require_inherited(corner_masses(before, keeping), corner_masses(solid, keeping), parents, together, tally);

  ++tally.n_releases;
  tally.placed += placed;
  if (placed.n_folded > 0)
    throw Violation("in some cells a part has less than nothing");
  tally.n_most_pieces = std::max<std::size_t>(tally.n_most_pieces, grid::n_pieces(solid.complex));
}

void require_pieces_as_found(const Subject& subject) {
  const grid::Pieces found = grid::pieces(subject.solid.complex);
  if (found.n_pieces != subject.pieces.n_pieces || !std::ranges::equal(found.piece, subject.pieces.piece))
    throw Violation("the updated pieces are not those that are found");
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
  grid::Solid solid = support::with_copies(specimen.body);
  cut::EdgeBoxes boxes(solid);
  Subject subject{.specimen = specimen,
                  .solid = std::move(solid),
                  .surface = {},
                  .index = {},
                  .boxes = std::move(boxes),
                  .cutter = cut::Cutter(0),
                  .x = {},
                  .pieces = {},
                  .volumes = {},
                  .first_volumes = {}};
  subject.surface = surface::build_surface(subject.solid, subject.index);
  subject.x = grid::rest_positions(subject.solid);
  subject.pieces = grid::pieces(subject.solid.complex);
  subject.volume = surface::enclosed_volume(subject.surface.rest, subject.surface.triangles);
  for (const CellId c : ids<CellId>(subject.grid().n_cells())) {
    subject.volumes.push_back(require_sound_volumes(subject.solid, c));
    subject.first_volumes.push_back(subject.volumes[c].sum());
  }
  require_sound(subject, tally);
  return subject;
}

void cut(Subject& subject, const std::function<grid::CutChange(Subject&)>& make, Tally& tally) {
  const grid::Solid before = subject.solid;
  grid::CutChange change = make(subject);
  if (change.any())
    follow_cut(subject, before, change, tally);
  require_material(subject, change.cells, tally);
  require_pieces_as_found(subject);
}

void cut(Subject& subject, const grid::histories::Step& step, Tally& tally) {
  const grid::Solid before = subject.solid;
  grid::histories::apply(step, subject.solid);
  grid::CutChange change = grid::update_complex(subject.solid, step.edges(), step.segments());
  if (change.any())
    follow_cut(subject, before, change, tally);
  require_pieces_as_found(subject);
}

std::uint64_t digest(const Subject& subject, const std::uint64_t start) {
  Fnv sum(start);
  for (const auto& cut : subject.solid.cuts.all()) {
    sum.add(cut.edge.value);
    sum.add(cut.t);
    sum.add(Points{cut.normal});
    sum.add(cut.label);
  }
  for (const auto& cut : subject.solid.cuts.skin_cuts()) {
    sum.add(cut.segment.face.value);
    sum.add(cut.segment.cell.value);
    sum.add(cut.segment.place);
    sum.add(cut.t);
    sum.add(Points{cut.normal});
    sum.add(cut.label);
  }
  for (const grid::Front& front : subject.solid.cuts.fronts()) {
    sum.add(front.cell.value);
    sum.add(front.ahead);
    sum.add(Points{front.point, front.normal, Vec3(front.held[0], front.passed, front.label)});
  }
  for (const auto& copy : subject.solid.complex.copies) {
    sum.add(copy.nodes);
    sum.add(copy.skin);
    for (const auto corner : copy.corners)
      sum.add(corner.value);
  }
  Points positions;
  surface::follow(subject.surface, subject.x, positions);
  for (const Points& points : {subject.x, subject.surface.rest, positions})
    sum.add(points);
  for (const auto& triangle : subject.surface.triangles)
    sum.add(triangle);
  return sum.value;
}

} // namespace kerf::fuzz
