#include "grid/cuts.h"

#include "grid/parts.h"
#include "grid/solid.h"

#include <algorithm>
#include <stdexcept>

namespace kerf::grid {

Cuts::Cuts(const Grid& grid)
  : edge_cut_(grid.n_edges()),
    outer_cut_(grid.n_edges()),
    face_point_(grid.n_faces()),
    cell_point_(grid.n_cells()),
    front_of_cell_(grid.n_cells()),
    skin_of_face_(grid.n_faces()),
    skin_of_cell_(grid.n_cells()) {}

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
    const bool is_inside = grid.is_material(grid.ends(cut.edge)[0]) ? cut.t <= t_skin : cut.t >= t_skin;
    if (!can_be_cut(grid, cut.edge) || !is_inside)
      throw std::logic_error("an edge is cut once; one of the skin once more, below the skin");
    outer_cut_.at(cut.edge) = index;
    ++n_cut_twice_;
  }
  index = static_cast<std::uint32_t>(cuts_.size());
  cuts_.push_back(cut);
  edges_left_whole_.erase(cut.edge);
}

void Cuts::add_to(std::vector<LaterCut>& all, const LaterCut& later) {
  if (std::ranges::find(all, later.label, &LaterCut::label) == all.end())
    all.push_back(later);
}

void Cuts::set_joined(const CellId c, std::vector<Joined> groups) {
  if (groups.empty())
    joined_.erase(c);
  else
    joined_[c] = std::move(groups);
}

void Cuts::set(const Front& front) {
  std::uint32_t& index = front_of_cell_.at(front.cell);
  if (index == none) {
    index = static_cast<std::uint32_t>(fronts_.size());
    fronts_.push_back(front);
  } else
    fronts_[index] = front;
}

void Cuts::take_back_front(const CellId c) {
  const std::uint32_t index = front_of_cell_[c];
  fronts_[index] = fronts_.back();
  fronts_.pop_back();
  if (index < fronts_.size())
    front_of_cell_.at(fronts_[index].cell) = index;
  front_of_cell_.at(c) = none;
}

std::uint32_t Cuts::index(const SkinSegment& segment) const {
  if (segment.face.valid()) {
    const std::uint32_t i = skin_of_face_[segment.face];
    return i == none ? none : faces_[i][SkinOfFace::halves + segment.place];
  }
  const std::uint32_t i = skin_of_cell_[segment.cell];
  return i == none ? none : cells_[i][SkinOfCell::spokes + segment.place];
}

std::uint32_t& Cuts::entry(const SkinSegment& segment) {
  return segment.face.valid() ? face(segment.face)[SkinOfFace::halves + segment.place]
                              : cell(segment.cell)[SkinOfCell::spokes + segment.place];
}

void Cuts::add(SkinCut cut) {
  std::uint32_t& index = entry(cut.segment);
  if (index != none)
    throw std::logic_error("a segment of the skin is cut once");
  cut.t = std::clamp(cut.t, min_edge_parameter, 1 - min_edge_parameter);
  index = static_cast<std::uint32_t>(skin_cuts_.size());
  skin_cuts_.push_back(cut);
  segments_left_whole_.erase(cut.segment);
}

void Cuts::leave_whole(const std::span<const EdgeId> edges) {
  for (const EdgeId e : edges)
    if (is_new(e)) {
      const EdgeCut& cut = *find(e);
      const LaterCut met = {cut.t, cut.normal, cut.label};
      add(e, met);
      edges_left_whole_.insert_or_assign(e, met);
    }
  std::size_t n = n_settled_;
  for (std::size_t i = n; i < cuts_.size(); ++i) {
    const EdgeId e = cuts_[i].edge;
    const bool is_outer = outer_cut_[e] == i;
    if (is_outer || !std::ranges::binary_search(edges, e)) {
      (is_outer ? outer_cut_ : edge_cut_).at(e) = static_cast<std::uint32_t>(n);
      cuts_[n++] = cuts_[i];
      continue;
    }
    edge_cut_.at(e) = outer_cut_[e];
    if (outer_cut_[e] != none) {
      outer_cut_.at(e) = none;
      --n_cut_twice_;
    }
  }
  cuts_.resize(n);
}

void Cuts::leave_whole(const std::span<const SkinSegment> segments) {
  for (const SkinSegment& segment : segments)
    if (is_new(segment)) {
      const SkinCut& cut = *find(segment);
      const LaterCut met = {cut.t, cut.normal, cut.label};
      add(segment, met);
      segments_left_whole_.insert_or_assign(segment, met);
    }
  std::size_t n = n_settled_of_skin_;
  for (std::size_t i = n; i < skin_cuts_.size(); ++i) {
    const bool is_taken = std::ranges::binary_search(segments, skin_cuts_[i].segment);
    entry(skin_cuts_[i].segment) = is_taken ? none : static_cast<std::uint32_t>(n);
    if (!is_taken)
      skin_cuts_[n++] = skin_cuts_[i];
  }
  skin_cuts_.resize(n);
}

const Vec3* Cuts::inner_point(const FaceId f, const int arc) const {
  const std::uint32_t i = skin_of_face_[f];
  return i == none ? nullptr : point_at(faces_[i][SkinOfFace::inner + arc]);
}

const Vec3* Cuts::inner_point_of(const CellId c, const int entry) const {
  const std::uint32_t i = skin_of_cell_[c];
  return i == none ? nullptr : point_at(cells_[i][entry]);
}

void Cuts::set_inner_point(const FaceId f, const int arc, const Vec3& p) { set(face(f)[SkinOfFace::inner + arc], p); }

Cuts::FaceEntries& Cuts::face(const FaceId f) {
  std::uint32_t& index = skin_of_face_.at(f);
  if (index == none) {
    index = static_cast<std::uint32_t>(faces_.size());
    faces_.emplace_back().fill(none);
  }
  return faces_[index];
}

Cuts::CellEntries& Cuts::cell(const CellId c) {
  std::uint32_t& index = skin_of_cell_.at(c);
  if (index == none) {
    index = static_cast<std::uint32_t>(cells_.size());
    cells_.emplace_back().fill(none);
  }
  return cells_[index];
}

void Cuts::settle() {
  n_settled_ = cuts_.size();
  n_settled_of_skin_ = skin_cuts_.size();
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
  return edge_cut_.n_bytes() + outer_cut_.n_bytes() + face_point_.n_bytes() + cell_point_.n_bytes() +
         skin_of_face_.n_bytes() + skin_of_cell_.n_bytes() + faces_.capacity() * sizeof(FaceEntries) +
         cells_.capacity() * sizeof(CellEntries) + cuts_.capacity() * sizeof(EdgeCut) +
         skin_cuts_.capacity() * sizeof(SkinCut) + points_.capacity() * sizeof(Vec3);
}

void Cuts::set(std::uint32_t& index, const Vec3& p) {
  if (index == none) {
    index = static_cast<std::uint32_t>(points_.size());
    points_.push_back(p);
  } else
    points_[index] = p;
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

Vec3 item_point(const Solid& solid, const CellId c, const int item) {
  if (item < skeleton::first_on_line)
    return solid.grid.position(solid.grid.nodes(c)[item]);
  if (item < skeleton::first_on_arc)
    return edge_skin_point(solid, solid.grid.edges(c)[item - skeleton::first_on_line]);
  return item < skeleton::first_middle ? face_point(solid, solid.grid.faces(c)[(item - skeleton::first_on_arc) / 2])
                                       : cell_point(solid, c);
}

Vec3 segment_point(const Solid& solid, const CellId c, const Skeleton& skeleton, const int segment) {
  const auto& [a, b] = skeleton.segment[segment].ends;
  if (segment < skeleton::first_half) {
    const EdgeId e = solid.grid.edges(c)[segment];
    if (solid.cuts.is_cut_twice(e) || (b < skeleton::first_on_line && solid.cuts.is_cut(e)))
      return edge_point(solid, e);
  }
  const Vec3 p = item_point(solid, c, a), q = item_point(solid, c, b);
  const SkinCut* const cut =
    segment < skeleton::first_half ? nullptr : solid.cuts.find(skin_segment(solid.grid, c, segment));
  return cut ? Vec3(p + cut->t * (q - p) + cut->aside) : Vec3(0.5 * (p + q));
}

} // namespace kerf::grid
