#include "grid/cuts.h"

#include "grid/cube.h"
#include "grid/solid.h"

#include <algorithm>
#include <stdexcept>

namespace kerf::grid {

Cuts::Cuts(const Grid& grid)
  : edge_cut_(grid.n_edges()),
    outer_cut_(grid.n_edges()),
    seam_(grid.n_faces()),
    face_point_(grid.n_faces()),
    face_skin_point_(grid.n_faces()),
    cell_point_(grid.n_cells()),
    cell_skin_point_(grid.n_cells()) {}

bool Cuts::can_be_cut(const Grid& grid, const EdgeId e) const {
  const auto& [lower, upper] = grid.ends(e);
  const bool of_skin = grid.is_material(lower) != grid.is_material(upper);
  return of_skin ? is_cut(e) && !is_cut_twice(e) : !is_cut(e) && grid.is_material(lower);
}

void Cuts::add(const Grid& grid, EdgeCut cut) {
  std::uint32_t& index = edge_cut_.at(cut.edge);
  cut.t = std::clamp(cut.t, min_edge_parameter, 1 - min_edge_parameter);
  if (index != none) {
    const double t_skin = cuts_[index].t;
    const bool is_inside = grid.is_material(grid.ends(cut.edge)[0]) ? cut.t < t_skin : cut.t > t_skin;
    if (!can_be_cut(grid, cut.edge) || !is_inside)
      throw std::logic_error("an edge is cut once; one of the skin once more, below the skin");
    outer_cut_.at(cut.edge) = index;
    ++n_cut_twice_;
  }
  index = static_cast<std::uint32_t>(cuts_.size());
  cuts_.push_back(cut);
}

void Cuts::set_seam(const FaceId f, const Seam seam) {
  std::uint32_t& now = seam_.at(f);
  if (seam == Seam::parted && now != static_cast<std::uint32_t>(seam))
    newly_parted_.insert(std::ranges::lower_bound(newly_parted_, f), f);
  now = static_cast<std::uint32_t>(seam);
}

void Cuts::settle() {
  n_settled_ = cuts_.size();
  newly_parted_.clear();
}

unsigned Cuts::configuration(const Grid& grid, const CellId c) const {
  const auto edges = grid.edges(c);
  unsigned lines = 0;
  for (int line = 0; line < cube::n_lines; ++line)
    if (is_cut(edges[line]))
      lines |= 1u << line;
  return lines;
}

std::size_t Cuts::n_bytes() const {
  return edge_cut_.n_bytes() + outer_cut_.n_bytes() + seam_.n_bytes() + face_point_.n_bytes() +
         face_skin_point_.n_bytes() + cell_point_.n_bytes() + cell_skin_point_.n_bytes() +
         newly_parted_.capacity() * sizeof(FaceId) + cuts_.capacity() * sizeof(EdgeCut) +
         points_.capacity() * sizeof(Vec3) + skin_points_.capacity() * sizeof(SkinPoint);
}

void Cuts::set(std::uint32_t& index, const Vec3& p) {
  if (index == none) {
    index = static_cast<std::uint32_t>(points_.size());
    points_.push_back(p);
  } else
    points_[index] = p;
}

void Cuts::set(std::uint32_t& index, const SkinPoint& p) {
  if (index == none) {
    index = static_cast<std::uint32_t>(skin_points_.size());
    skin_points_.push_back(p);
  } else
    skin_points_[index] = p;
}

namespace {

Vec3 point_on(const Grid& grid, const EdgeId e, const EdgeCut* const cut) {
  Vec3 p = grid.position(grid.ends(e)[0]);
  p[grid.axis(e)] += grid.h() * (cut ? cut->t : 0.5);
  return p;
}

} // namespace

Vec3 edge_point(const Solid& solid, const EdgeId e) { return point_on(solid.grid, e, solid.cuts.find(e)); }

Vec3 edge_skin_point(const Solid& solid, const EdgeId e) { return point_on(solid.grid, e, solid.cuts.find_outer(e)); }

Vec3 centre(const Grid& grid, const CellId c) { return grid.origin(c) + Vec3::Constant(0.5 * grid.h()); }

Vec3 centre(const Grid& grid, const FaceId f) {
  const auto& [below, above] = grid.cells(f);
  const CellId c = below.valid() ? below : above;
  const auto& faces = grid.faces(c);
  const int local = static_cast<int>(std::find(faces.begin(), faces.end(), f) - faces.begin());
  Vec3 p = centre(grid, c);
  p[cube::face_axis(local)] += (local & 1 ? 0.5 : -0.5) * grid.h();
  return p;
}

Vec3 face_point(const Solid& solid, const FaceId f) {
  const Vec3* p = solid.cuts.point(f);
  return p ? *p : centre(solid.grid, f);
}

Vec3 cell_point(const Solid& solid, const CellId c) {
  const Vec3* p = solid.cuts.point(c);
  return p ? *p : centre(solid.grid, c);
}

Vec3 face_skin_point(const Solid& solid, const FaceId f, const int i) {
  const SkinPoint* const of_skin = solid.cuts.skin_point(f);
  return of_skin && (of_skin->lines >> i & 1) ? of_skin->p : face_point(solid, f);
}

Vec3 cell_skin_point(const Solid& solid, const CellId c, const int line) {
  const SkinPoint* const of_skin = solid.cuts.skin_point(c);
  return of_skin && (of_skin->lines >> line & 1) ? of_skin->p : cell_point(solid, c);
}

} // namespace kerf::grid
