#include "grid/material.h"

#include "grid/cube.h"
#include "grid/shape.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>
#include <span>

namespace kerf::grid {

namespace {

/// Where the material of a cell is divided: on its lines, in its faces, in it. Ahead of a front where its plane is.
class Divisions {
 public:
  Divisions(const Solid& solid, const CellId c)
    : solid_(solid), front_(solid.cuts.front(c)), cell_(c), edges_(solid.grid.edges(c)), faces_(solid.grid.faces(c)) {}

  Vec3 on_line(const int line) const {
    const Vec3 p = edge_point(solid_, edges_[line]);
    if (!is_ahead(line))
      return p;
    Vec3 q = solid_.grid.position(solid_.grid.ends(edges_[line])[0]);
    const int axis = cube::line_axis(line);
    const double t = front_->normal.dot(front_->point - q) / (front_->normal[axis] * solid_.grid.h());
    q[axis] += solid_.grid.h() * std::clamp(t, min_edge_parameter, 1 - min_edge_parameter);
    return q;
  }
  /// On a segment of the skin from a to b, in the unit cube.
  double in_skin(const int segment, const Vec3& a, const Vec3& b) const {
    if (front_ == nullptr || (front_->ahead >> segment & 1) == 0)
      return 0.5;
    const auto height = [&](const Vec3& xi) {
      return front_->normal.dot(solid_.grid.origin(cell_) + solid_.grid.h() * xi - front_->point);
    };
    const double at_a = height(a), at_b = height(b);
    return at_a == at_b ? 0.5 : std::clamp(at_a / (at_a - at_b), 0.0, 1.0);
  }
  Vec3 in_face(const int face) const {
    if (front_ == nullptr || solid_.cuts.point(faces_[face]) != nullptr)
      return face_point(solid_, faces_[face]);
    return mean(cube::face_lines[face], face_point(solid_, faces_[face]));
  }
  Vec3 centre() const {
    static constexpr std::array<int, 12> all = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
    if (front_ == nullptr || solid_.cuts.point(cell_) != nullptr)
      return cell_point(solid_, cell_);
    return mean(all, cell_point(solid_, cell_));
  }

 private:
  bool is_ahead(const int line) const {
    return front_ != nullptr && (front_->ahead >> line & 1) != 0 && solid_.cuts.can_be_cut(solid_.grid, edges_[line]);
  }

  /// Of the divisions on lines that are cut, or ahead of the front.
  Vec3 mean(const std::span<const int> lines, const Vec3& if_none) const {
    Vec3 sum = Vec3::Zero();
    int n = 0;
    for (const int line : lines)
      if (is_ahead(line) || solid_.cuts.is_cut(edges_[line])) {
        sum += on_line(line);
        ++n;
      }
    return n == 0 ? if_none : Vec3(sum / n);
  }

  const Solid& solid_;
  const Front* front_; // none in most cells
  CellId cell_;
  std::array<EdgeId, 12> edges_;
  std::array<FaceId, 6> faces_;
};

} // namespace

std::array<Tetrahedron, 6> octant(const Solid& solid, const CellId c, const int vertex) {
  const Vec3 origin = solid.grid.origin(c);
  const Divisions at(solid, c);
  const auto local = [&](const Vec3& p) -> Vec3 { return (p - origin) / solid.grid.h(); };
  const Vec3 node(vertex & 1, vertex >> 1 & 1, vertex >> 2 & 1);
  const Vec3 middle = local(at.centre());
  std::array<Vec3, 3> on_edge, in_face;  // by the edge's direction, by the face's normal
  for (int axis = 0; axis < 3; ++axis) { // right on the edge and in the face: round-off may not turn a thin octant over
    on_edge[axis] = node;
    on_edge[axis][axis] = local(at.on_line(cube::line_at(vertex, axis)))[axis];
    in_face[axis] = local(at.in_face(cube::face_at(vertex, axis)));
    in_face[axis][axis] = node[axis];
  }
  std::array<Tetrahedron, 6> tetrahedra;
  for (int i = 0; i < 6; ++i) {
    const int edge = i % 3, normal = (edge + (i < 3 ? 1 : 2)) % 3;
    Tetrahedron& t = tetrahedra[i];
    t = {node, on_edge[edge], in_face[normal], middle};
    const bool mirrored = (std::popcount(static_cast<unsigned>(vertex)) & 1) != 0;
    if (mirrored == (i >= 3))
      std::swap(t[1], t[2]);
  }
  return tetrahedra;
}

namespace {

/// A cell in coordinates of the unit cube [1]. What lies in a face lies right in it, and on a line right on it: round-
/// off may not turn a thin tetrahedron over.
class LocalSkeleton {
 public:
  LocalSkeleton(const Solid& solid, const CellId c, const VerticesOfCuts vertices)
    : solid_(solid),
      cell_(c),
      vertices_(vertices),
      skeleton_(skeleton_of(material_of(solid.grid, c))),
      blades_(cuts_of_copies(solid, c).blades),
      divisions_(solid, c),
      faces_(solid.grid.faces(c)),
      origin_(solid.grid.origin(c)) {
    for (Items left = skeleton_.items; left != 0; left &= left - 1)
      items_[std::countr_zero(left)] = item(std::countr_zero(left));
  }

  const Skeleton& skeleton() const { return skeleton_; }
  const Vec3& at(const int item) const { return items_[item]; }

  Vec3 cut(const int segment) const {
    const auto& [a, b] = skeleton_.segment[segment].ends;
    if ((blades_ >> segment & 1) == 0)
      return 0.5 * (items_[a] + items_[b]);
    if (segment < skeleton::first_half)
      return on_segment(a, b, on_line(segment, local(divisions_.on_line(segment))));
    const SkinCut* const of_skin = solid_.cuts.find(skin_segment(solid_.grid, cell_, segment));
    const double t = of_skin ? of_skin->t : divisions_.in_skin(segment, items_[a], items_[b]);
    const Vec3 on_segment = items_[a] + t * (items_[b] - items_[a]);
    return of_skin ? Vec3(on_segment + of_skin->aside / solid_.grid.h()) : on_segment;
  }

  Vec3 in_side(const int side) const {
    if (vertices_ == VerticesOfCuts::amid_cuts)
      return middle_of(side);
    if (side < skeleton::first_triangle) {
      const FaceId f = faces_[side / 2];
      if (skeleton_.side[side].n == 4 && (skeleton_.items >> skeleton::on_arc(side / 2, 0) & 1) == 0)
        return in_face(side / 2, local(divisions_.in_face(side / 2)));
      const Vec3* const p = solid_.cuts.inner_point(f, side % 2);
      return p ? in_face(side / 2, local(*p)) : middle_of(side);
    }
    const Vec3* const p = solid_.cuts.inner_point(cell_, side - skeleton::first_triangle);
    return p ? local(*p) : middle_of(side);
  }

  Vec3 centre() const {
    const Vec3* const p = solid_.cuts.inner_point(cell_);
    if (p && vertices_ == VerticesOfCuts::placed)
      return local(*p);
    return blades_ != 0 ? mean_cut(blades_) : local(cell_point(solid_, cell_));
  }

 private:
  Vec3 local(const Vec3& p) const { return (p - origin_) / solid_.grid.h(); }

  static Vec3 on_line(const int line, const Vec3& p) {
    const int lower = cube::line_vertices[line][0], axis = cube::line_axis(line);
    Vec3 result(lower & 1, lower >> 1 & 1, lower >> 2 & 1);
    result[axis] = p[axis];
    return result;
  }
  static Vec3 in_face(const int face, Vec3 p) {
    p[cube::face_axis(face)] = face & 1;
    return p;
  }
  /// A front's plane may meet a line beyond the skin: it is where the body is deformed that it passes between both ends.
  Vec3 on_segment(const int a, const int b, const Vec3& p) const {
    const Vec3 way = items_[b] - items_[a];
    const double t = way.dot(p - items_[a]) / way.squaredNorm();
    return t > 0 && t < 1 ? p : items_[a] + std::clamp(t, min_edge_parameter, 1 - min_edge_parameter) * way;
  }

  Vec3 item(const int i) const {
    if (i < skeleton::first_on_line)
      return Vec3(i & 1, i >> 1 & 1, i >> 2 & 1);
    const Vec3 p = local(item_point(solid_, cell_, i));
    if (i < skeleton::first_on_arc)
      return on_line(i - skeleton::first_on_line, p);
    return i < skeleton::first_middle ? in_face((i - skeleton::first_on_arc) / 2, p) : p;
  }

  /// Where no vertex has been placed: between its cuts, if there are some.
  Vec3 middle_of(const int side) const {
    const Skeleton::Side& of = skeleton_.side[side];
    Segments border = 0;
    Vec3 sum = Vec3::Zero();
    for (int i = 0; i < of.n; ++i) {
      border |= Segments(1) << of.segments[i];
      sum += items_[of.items[i]];
    }
    return (border & blades_) != 0 ? mean_cut(border & blades_) : Vec3(sum / of.n);
  }

  Vec3 mean_cut(const Segments cuts) const {
    Vec3 sum = Vec3::Zero();
    for (Segments left = cuts; left != 0; left &= left - 1)
      sum += cut(std::countr_zero(left));
    return sum / std::popcount(cuts);
  }

  const Solid& solid_;
  CellId cell_;
  VerticesOfCuts vertices_;
  const Skeleton& skeleton_;
  Segments blades_;
  Divisions divisions_;
  std::array<FaceId, 6> faces_;
  Vec3 origin_;
  std::array<Vec3, skeleton::n_items> items_;
};

/// Integral over a tetrahedron of a product of three functions that are linear in it and not negative at its vertices,
/// over its volume: products of barycentric coordinates integrate to 3! times the factorials of the exponents over 6!.
double mean_product(const Eigen::Array4d& f, const Eigen::Array4d& g, const Eigen::Array4d& h) {
  const double F = f.sum(), G = g.sum(), H = h.sum();
  return (F * G * H + F * (g * h).sum() + G * (f * h).sum() + H * (f * g).sum() + 2 * (f * g * h).sum()) / 120;
}

} // namespace

std::vector<MaterialPiece> pieces_of(const Solid& solid, const CellId c, const Items items,
                                     const VerticesOfCuts vertices) {
  const LocalSkeleton cell(solid, c, vertices);
  const Skeleton& skeleton = cell.skeleton();
  const Vec3 centre = cell.centre();
  std::vector<MaterialPiece> pieces;
  for (Segments left = skeleton.segments; left != 0; left &= left - 1) {
    const int s = std::countr_zero(left);
    const Skeleton::Segment& segment = skeleton.segment[s];
    if ((items >> segment.ends[0] & 1) == 0 && (items >> segment.ends[1] & 1) == 0)
      continue;
    const Vec3 cut = cell.cut(s);
    for (const int way : {0, 1}) {
      const Vec3 in_side = cell.in_side(segment.sides[way]);
      for (const int end : {0, 1}) {
        const int item = segment.ends[end];
        if (items >> item & 1) // the side's border passes from here to the cut, or from the cut to here
          pieces.push_back({way == end ? Tetrahedron{cell.at(item), in_side, cut, centre}
                                       : Tetrahedron{cell.at(item), cut, in_side, centre},
                            skeleton.vertex[item]});
      }
    }
  }
  return pieces;
}

Vec3 vertex_of_cuts(const Solid& solid, const CellId c) {
  return solid.grid.origin(c) + solid.grid.h() * LocalSkeleton(solid, c, VerticesOfCuts::placed).centre();
}
Vec3 vertex_of_cuts(const Solid& solid, const CellId c, const int side) {
  return solid.grid.origin(c) + solid.grid.h() * LocalSkeleton(solid, c, VerticesOfCuts::placed).in_side(side);
}

double volume(const Tetrahedron& t) { return (t[1] - t[0]).dot((t[2] - t[0]).cross(t[3] - t[0])) / 6; }

std::array<double, 8> shape_integrals(const Tetrahedron& t) {
  const double size = volume(t);
  std::array<std::array<Eigen::Array4d, 2>, 3> factor; // by axis and by the side of the cube
  for (int axis = 0; axis < 3; ++axis) {
    factor[axis][1] = Eigen::Array4d(t[0][axis], t[1][axis], t[2][axis], t[3][axis]).max(0).min(1);
    factor[axis][0] = 1 - factor[axis][1];
  }
  std::array<double, 8> integrals;
  for (int a = 0; a < 8; ++a)
    integrals[a] = size * mean_product(factor[0][a & 1], factor[1][a >> 1 & 1], factor[2][a >> 2 & 1]);
  return integrals;
}

void add_shape_products(const Tetrahedron& t, Eigen::Matrix<double, 8, 8>& products) {
  struct Orbit { // of a point with these barycentric coordinates, in every order
    double a, b, c, d, weight;
  };
  // Exact for degree 6: P. Keast 1986, Moderate-degree tetrahedral quadrature formulas, Comput. Methods Appl. Mech.
  // Eng. 55, 339-348, table 1.
  static constexpr std::array<Orbit, 4> orbits{
    {{0.3561913862225449, 0.2146028712591517, 0.2146028712591517, 0.2146028712591517, 0.03992275025816787},
     {0.8779781243961660, 0.0406739585346113, 0.0406739585346113, 0.0406739585346113, 0.01007721105532066},
     {0.0329863295731731, 0.3223378901422757, 0.3223378901422757, 0.3223378901422757, 0.05535718154365439},
     {0.6030056647916491, 0.2696723314583159, 0.0636610018750175, 0.0636610018750175, 0.04821428571428571}}};
  const double size = volume(t);
  for (const auto& [a, b, c, d, weight] : orbits)
    for (int i = 0; i < 4; ++i) // where a is
      for (int j = 0; j < 4; ++j) { // and b
        if (j == i || (b == c && j != (i == 0 ? 1 : 0)))
          continue;
        Vec3 p = Vec3::Zero();
        for (int k = 0; k < 4; ++k)
          p += (k == i ? a : k == j ? b : c) * t[k];
        Eigen::Matrix<double, 8, 1> N;
        for (int v = 0; v < 8; ++v)
          N[v] = shape(v, p);
        products.selfadjointView<Eigen::Lower>().rankUpdate(N, weight * size);
      }
}

double fill(const Solid& solid, const Copy& copy) {
  if (copy.nodes == 0xff)
    return 1;
  double sum = 0;
  for_each_tetrahedron(solid, copy, [&](const Tetrahedron& t, int) { sum += volume(t); });
  return sum;
}

} // namespace kerf::grid
