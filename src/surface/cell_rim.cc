#include "surface/cell_rim.h"

#include "grid/material.h"

#include <Eigen/Geometry>

#include <bit>
#include <cmath>
#include <vector>

namespace kerf::surface {

namespace cube = grid::cube;

namespace {

/// One cell with a rim.
class CellRim {
 public:
  CellRim(const grid::Solid& solid, const View& view)
    : cuts_(solid.cuts),
      view_(view),
      h_(solid.grid.h()),
      faces_(solid.grid.faces(view.cell)),
      skin_(*solid.cuts.skin_point(view.cell)) {
    unsigned lines = 0;
    for (int face = 0; face < cube::n_faces; ++face) {
      in_face_[face] = grid::face_point(solid, faces_[face]);
      for (const grid::SkinArc& arc : grid::skin_arcs(face, view.now.material))
        if (view.now.is_rim(face, arc)) {
          rim_.push_back(in_face_[face]);
          lines |= view.now.blades() & grid::CellCuts::beside(arc);
        }
    }
    plane_ = view.mean_plane(lines);
  }

  std::optional<RimVertex> place() {
    const Vec3 p = view_.inside(rim_in_fan(plane_, rim_[0], rim_[1], skin_.p, spokes()));
    skin_.lines = lines_beside_corner();
    skin_.has_rim = true;
    const Vec3 q = p + volume_move(p);
    // A bent skin has its volume back by a small move; where it is sharp, a vertex beside the rim would blunt it.
    constexpr double negligible = 1e-13, little = 0.1;
    if (std::abs(excess(p)) > (is_sharp() ? negligible : little) || view_.inside(q) != q ||
        std::abs(excess(q)) > negligible)
      return std::nullopt;
    return RimVertex{q, skin_};
  }

 private:
  /// The ends of the spokes of the skin.
  std::vector<Vec3> spokes() const {
    std::vector<Vec3> ends;
    for_each_bit(view_.now.skin, [&](const int line) { ends.push_back(view_.skin_at(line)); });
    for (int face = 0; face < cube::n_faces; ++face)
      if (grid::skin_arcs(face, view_.now.material).n > 0)
        ends.push_back(corner_of(face));
    return ends;
  }

  /// The skin's vertex in a face.
  Vec3 corner_of(const int face) const {
    const grid::SkinPoint* const of_skin = cuts_.skin_point(faces_[face]);
    return of_skin ? of_skin->p : in_face_[face];
  }

  /// The lines of the skin under which the part lies that has the skin's vertex, on its side of the cut.
  std::uint16_t lines_beside_corner() const {
    const auto height = [&](const Vec3& p) { return plane_.normal.dot(p - plane_.point); };
    const double side = std::copysign(1.0, height(skin_.p));
    int farthest = std::countr_zero(view_.now.skin);
    for_each_bit(view_.now.skin, [&](const int line) {
      if (side * height(view_.skin_at(line)) > side * height(view_.skin_at(farthest)))
        farthest = line;
    });
    const auto is_under = [&](const grid::Part& part, const int line) {
      const auto& [v, w] = cube::line_vertices[line];
      return view_.now.twice >> line & 1 ? (part.rinds >> line & 1) != 0
                                         : ((part.nodes >> v | part.nodes >> w) & 1) != 0;
    };
    std::uint16_t lines = 0;
    for (const grid::Part& part : parts_of(view_.now))
      if (is_under(part, farthest))
        for_each_bit(view_.now.skin, [&](const int line) {
          lines |= static_cast<std::uint16_t>(unsigned(is_under(part, line)) << line);
        });
    return lines;
  }

  /// Do the planes of the skin make a sharp edge, as those of a box do?
  bool is_sharp() const {
    constexpr double sharp = 0.5; // cosine
    bool result = false;
    for_each_bit(view_.now.skin, [&](const int a) {
      for_each_bit(view_.now.skin,
                   [&](const int b) { result |= view_.skin_plane(a).normal.dot(view_.skin_plane(b).normal) < sharp; });
    });
    return result;
  }

  /// The move of the cuts' vertex from p, along the plane of the cut, that gives the cell its volume: that is linear in
  /// each vertex.
  Vec3 volume_move(const Vec3& p) const {
    const double lost = excess(p);
    Vec3 slope;
    for (int axis = 0; axis < 3; ++axis)
      slope[axis] = (excess(p + h_ * Vec3::Unit(axis)) - lost) / h_;
    const Vec3 along = slope - slope.dot(plane_.normal) * plane_.normal;
    const double rate = along.dot(slope), least = 1e-3 / h_;
    return rate > least * least ? Vec3(-lost / rate * along) : Vec3::Zero();
  }

  /// Volume of the cell's material beyond that under its skin, with the cuts' vertex at p [h^3].
  double excess(const Vec3& p) const {
    double sum = 0;
    for_each_bit(view_.now.skin, [&](const int line) {
      const int axis = cube::line_axis(line), lower = cube::line_vertices[line][0];
      const int vertex = view_.now.material >> lower & 1 ? lower : cube::line_vertices[line][1];
      const bool turned = (std::popcount(static_cast<unsigned>(vertex)) & 1) != 0;
      for (int i = 0; i < 2; ++i) {
        const int face = cube::face_at(vertex, (axis + 1 + i) % 3);
        const grid::SkinPoint* const of_skin = cuts_.skin_point(faces_[face]);
        const bool is_cut_short = of_skin && !(of_skin->lines >> cube::place_in_face(face, line) & 1);
        const std::array<Vec3, 3> of_cuts = {view_.planes[line].point, in_face_[face], p};
        const std::array<Vec3, 3> is = {view_.skin_at(line), is_cut_short ? in_face_[face] : corner_of(face),
                                        skin_.lines >> line & 1 ? skin_.p : p};
        const std::array<Vec3, 3> was = {view_.skin_at(line), corner_of(face), skin_.p};
        sum += volume(of_cuts, is, turned == (i == 1)) - volume(of_cuts, was, turned == (i == 1));
      }
    });
    return sum / (h_ * h_ * h_);
  }

  static double volume(const std::array<Vec3, 3>& from, const std::array<Vec3, 3>& to, const bool mirrored) {
    double sum = 0;
    for (const grid::Tetrahedron& t : grid::prism(from, to, mirrored))
      sum += grid::volume(t);
    return sum;
  }

  const grid::Cuts& cuts_;
  const View& view_;
  double h_;
  std::array<grid::FaceId, 6> faces_;
  std::array<Vec3, 6> in_face_; // the cuts' vertices
  grid::SkinPoint skin_;
  Few<Vec3, 12> rim_; // its points in the faces
  Plane plane_;       // of the cut
};

} // namespace

void for_each_skin_triangle(const grid::Solid& solid, const View& view,
                            const std::function<void(const std::array<Vec3, 3>&)>& f) {
  const auto faces = solid.grid.faces(view.cell);
  const Vec3 centre = solid.cuts.skin_point(view.cell)->p;
  for (int face = 0; face < cube::n_faces; ++face)
    for (const grid::SkinArc& arc : grid::skin_arcs(face, view.now.material)) {
      const grid::SkinPoint* const of_skin = solid.cuts.skin_point(faces[face]);
      const Vec3 corner = of_skin ? of_skin->p : grid::face_point(solid, faces[face]);
      for (const int line : arc.lines)
        f({view.skin_at(line), corner, centre});
    }
}

bool rim_passes(const grid::Solid& solid, const View& view) {
  const auto faces = solid.grid.faces(view.cell);
  int n = 0;
  for (int face = 0; face < cube::n_faces; ++face)
    for (const grid::SkinArc& arc : grid::skin_arcs(face, view.now.material))
      if (view.now.is_rim(face, arc)) {
        if (!solid.cuts.skin_point(faces[face])->has_rim)
          return false;
        ++n;
      }
  return n > 1;
}

std::optional<RimVertex> place_on_rim(const grid::Solid& solid, const View& view) {
  return CellRim(solid, view).place();
}

} // namespace kerf::surface
