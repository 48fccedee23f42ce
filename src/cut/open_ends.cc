#include "cut/open_ends.h"

#include "cut/nodes_apart.h"
#include "cut/part_face.h"
#include "geometry/triangle.h"

#include <algorithm>
#include <bit>

namespace kerf::cut {

namespace cube = grid::cube;

namespace {

/// Has the blade cut beside the skin of a face an odd number of times, and not parted it?
bool is_open(const grid::Solid& solid, const grid::CellId c, const grid::CellCuts& cell, const int face,
             const grid::CutLabel label) {
  const auto edges = solid.grid.edges(c);
  for (const grid::SkinArc& arc : grid::skin_arcs(face, cell.material)) {
    const unsigned lines = cell.blades() & grid::CellCuts::beside(arc);
    int n = 0, n_others = 0; // where others have cut before, CrossedAgain has told
    for (unsigned left = lines; left != 0; left &= left - 1)
      ++(solid.cuts.find(edges[std::countr_zero(left)])->label == label ? n : n_others);
    if (n % 2 != 0 && n_others == 0 && cell.is_whole(face, arc))
      return true;
  }
  return false;
}

bool is_cut_by(const grid::Solid& solid, const grid::CellId c, const grid::CellCuts& cell, const grid::CutLabel label) {
  const auto edges = solid.grid.edges(c);
  for (unsigned left = cell.blades(); left != 0; left &= left - 1)
    if (solid.cuts.find(edges[std::countr_zero(left)])->label == label)
      return true;
  return false;
}

/// Does the rind of an edge hang together with something where the blade's cut goes through?
bool is_held(const grid::Solid& solid, const grid::EdgeId edge, const grid::CutLabel label) {
  for (const grid::CellId c : solid.grid.cells(edge)) {
    if (!c.valid())
      continue;
    const grid::CellCuts cell = grid::cuts_of(solid, c);
    const auto edges = solid.grid.edges(c);
    const auto line = std::find(edges.begin(), edges.end(), edge) - edges.begin();
    for (int face = 0; face < cube::n_faces; ++face)
      for (const grid::SkinArc& arc : grid::skin_arcs(face, cell.material))
        if ((arc.lines[0] == line || arc.lines[1] == line) && cell.is_whole(face, arc) &&
            !is_open(solid, c, cell, face, label))
          return true;
  }
  return false;
}

/// Is any of the triangles within a cell's width of a copy?
bool is_near(const std::span<const std::array<Vec3, 3>> blade, const grid::Copy& copy, const Points& x) {
  Vec3 middle = Vec3::Zero();
  for (const grid::CornerId corner : copy.corners)
    middle += x[corner.value] / cube::n_vertices;
  double reach = 0;
  for (const grid::CornerId corner : copy.corners)
    reach = std::max(reach, (x[corner.value] - middle).norm());
  return std::ranges::any_of(blade, [&](const std::array<Vec3, 3>& triangle) {
    return (geometry::closest_point(middle, triangle) - middle).norm() < 2 * reach;
  });
}

/// Do cuts wait in the cell or beside it?
bool wait_near(const PendingCuts& pending, const grid::Grid& grid, const grid::CellId c) {
  if (pending.size() == 0)
    return false;
  const auto waits_in = [&](const grid::CellId around) {
    return around.valid() && std::ranges::any_of(grid.edges(around), [&](const auto e) { return pending.waits(e); });
  };
  return std::ranges::any_of(grid.edges(c), [&](const auto e) { return std::ranges::any_of(grid.cells(e), waits_in); });
}

template <class T>
void sort_unique(std::vector<T>& items) {
  std::sort(items.begin(), items.end());
  items.erase(std::unique(items.begin(), items.end()), items.end());
}

} // namespace

void OpenEnds::note(const grid::Solid& solid, const std::span<const grid::CellId> cells, const grid::CutLabel label) {
  for (const grid::CellId c : cells) {
    const grid::CellCuts cell = grid::cuts_of(solid, c);
    for (int face = 0; cell.skin != 0 && face < cube::n_faces; ++face)
      if (is_open(solid, c, cell, face, label))
        faces_.push_back({c, face});
    if (is_cut_by(solid, c, cell, label) && must_be_parted(solid, c))
      cells_.push_back(c);
  }
  sort_unique(faces_);
  sort_unique(cells_);
}

std::vector<grid::EdgeId> OpenEnds::close(const std::span<const std::array<Vec3, 3>> blade, const PendingCuts& pending,
                                          grid::Solid& solid, const Points& x, const grid::CutLabel label) {
  std::vector<grid::EdgeId> closed;
  const auto may_go_on = [&](const grid::CellId c) {
    if (wait_near(pending, solid.grid, c))
      return true;
    for (const grid::CopyId copy : solid.complex.copies_of(c))
      if (is_near(blade, solid.complex.copies[copy], x))
        return true;
    return false;
  };
  std::vector<Face> faces;
  for (const Face& f : faces_) {
    const grid::CellCuts cell = grid::cuts_of(solid, f.cell);
    if (!is_open(solid, f.cell, cell, f.face, label))
      continue;
    if (may_go_on(f.cell)) {
      faces.push_back(f);
      continue;
    }
    const auto edges = solid.grid.edges(f.cell);
    const bool is_last_hold = std::ranges::any_of(cube::face_lines[f.face], [&](const int line) {
      return (cell.twice >> line & 1) != 0 && !is_held(solid, edges[line], label);
    });
    if (!is_last_hold) // of a rind
      part_face(solid, f.cell, f.face, closed);
  }
  faces_ = std::move(faces);
  std::vector<grid::CellId> cells;
  for (const grid::CellId c : cells_) {
    if (!must_be_parted(solid, c))
      continue;
    if (may_go_on(c)) {
      cells.push_back(c);
      continue;
    }
    const auto parted = keep_nodes_apart(solid, c);
    closed.insert(closed.end(), parted.begin(), parted.end());
  }
  cells_ = std::move(cells);
  return closed;
}

} // namespace kerf::cut
