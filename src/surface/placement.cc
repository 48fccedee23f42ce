#include "surface/placement.h"

#include "grid/cube.h"
#include "grid/touched.h"
#include "surface/planes.h"
#include "surface/table.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace kerf::surface {

namespace cube = grid::cube;
using grid::CellId;
using grid::Cuts;
using grid::EdgeId;
using grid::FaceId;
using grid::Grid;

namespace {

constexpr std::array<unsigned, 6> lines_of_face = [] {
  std::array<unsigned, 6> masks{};
  for (int face = 0; face < cube::n_faces; ++face)
    for (const int line : cube::face_lines[face])
      masks[face] |= 1u << line;
  return masks;
}();

/// Calls f(i) for each bit i of a mask, upwards.
template <class Function>
void for_each_bit(unsigned mask, const Function& f) {
  for (; mask != 0; mask &= mask - 1)
    f(std::countr_zero(mask));
}

/// A cell, with the planes of its cut edges; sets are bits, of lines or of vertices.
struct View {
  CellId cell;
  Vec3 lower, upper; ///< the cell's corners [m]
  unsigned cut = 0, old = 0, skin = 0;
  unsigned material = 0;
  std::array<Plane, 12> planes; ///< by line, where it is cut
  std::array<grid::CutLabel, 12> labels;
};

/// A face or a cell, with the planes of its cut edges sorted by what they ask of its vertex.
struct Site {
  Site(const View& of, const Directions& directions) : view(of), inside(directions), allowed(directions) {}

  const View& view;
  Directions inside;  ///< the directions within it
  Directions allowed; ///< those of them that keep the skin's volume
  Planes skin;        ///< the skin that stood before
  Planes locked;      ///< cuts that already separate material here: the vertex stays on them
  Few<grid::CutLabel, 12> locked_labels;
  Planes open;         ///< cuts that the vertex has yet to meet
  bool splits = false; ///< with all cuts, material here is separated

  /// Does it reach along the axis?
  bool reaches(const int axis) const { return inside.projection(axis, axis) != 0; }
  void lock(const Plane& plane, const grid::CutLabel label) {
    locked.push_back(plane);
    locked_labels.push_back(label);
  }
};

/// Figure 2.15 (b), (c): where two cut lines in a face are joined.
class Joint {
 public:
  explicit Joint(const double sharp_angle)
    : smooth_(std::cos(sharp_angle)), turning_back_(std::cos(std::min(0.5 * std::numbers::pi + sharp_angle, limit))) {}

  /// u and v are the axes of the face.
  Vec3 operator()(const Plane& a, const Plane& b, const int u, const int v) const {
    const Vec3 middle = 0.5 * (a.point + b.point);
    const double mu = a.normal[u], mv = a.normal[v], nu = b.normal[u], nv = b.normal[v];
    const double sine = mu * nv - mv * nu, lengths2 = (mu * mu + mv * mv) * (nu * nu + nv * nv);
    if (sine * sine < 1e-12 * lengths2 || lengths2 == 0)
      return middle;
    const double da = a.normal.dot(a.point - middle), db = b.normal.dot(b.point - middle);
    Vec3 meeting = middle;
    meeting[u] += (da * nv - db * mv) / sine;
    meeting[v] += (db * mu - da * nu) / sine;
    const Vec3 arriving = meeting - a.point, leaving = b.point - meeting;
    const double turn = arriving.dot(leaving), lengths = std::sqrt(arriving.squaredNorm() * leaving.squaredNorm());
    if (turn < turning_back_ * lengths)
      return middle; // the curve would turn back: the two planes do not belong to one cut
    return turn < smooth_ * lengths ? meeting : Vec3(0.25 * (a.point + 2 * meeting + b.point));
  }

 private:
  static constexpr double limit = std::numbers::pi;
  double smooth_, turning_back_; ///< cosines of the turns where these begin
};

unsigned skin_lines(const Grid& grid, const Cuts& cuts, const CellId c) {
  unsigned lines = 0;
  const auto edges = grid.edges(c);
  for (int line = 0; line < cube::n_lines; ++line) {
    const grid::EdgeCut* cut = cuts.find(edges[line]);
    lines |= unsigned(cut && cut->label == grid::skin_label) << line;
  }
  return lines;
}

/// Calls f(e, first face, its vertex, second face, its vertex) for each quadrilateral of the skin in the cell, seen
/// from the cell's vertex. Volume is linear in each vertex: a move at right angles to its derivative keeps it exactly.
template <class Function>
void for_each_skin_quad(const Grid& grid, const Cuts& cuts, const CellId c, const Function& f) {
  const Vec3 origin = grid::cell_point(grid, cuts, c);
  const auto nodes = grid.nodes(c);
  const auto edges = grid.edges(c);
  const auto faces = grid.faces(c);
  for (const Quad& quad : splitting_table().row(skin_lines(grid, cuts, c))) {
    if (!grid.is_material(nodes[quad.end]))
      continue;
    const int first = quad.vertices[1].index, second = quad.vertices[3].index;
    const auto face = [&](const int i) -> Vec3 { return grid::face_point(grid, cuts, faces[i]) - origin; };
    f(grid::edge_point(grid, cuts, edges[quad.line]) - origin, first, face(first), second, face(second));
  }
}

/// The derivative of the skin's volume (times 6) in a cell by the cell's vertex.
Vec3 volume_by_centre(const Grid& grid, const Cuts& cuts, const CellId c) {
  Vec3 sum = Vec3::Zero();
  for_each_skin_quad(grid, cuts, c,
                     [&](const Vec3& e, int, const Vec3& f, int, const Vec3& g) { sum += e.cross(f) + g.cross(e); });
  return sum;
}

/// The same by the vertex in a face, of the triangles in both cells.
Vec3 volume_by_face(const Grid& grid, const Cuts& cuts, const FaceId f) {
  Vec3 result = Vec3::Zero();
  for (const CellId c : grid.cells(f)) {
    if (!c.valid())
      continue;
    const auto faces = grid.faces(c);
    const auto face = std::find(faces.begin(), faces.end(), f) - faces.begin();
    Vec3 sum = Vec3::Zero();
    // The triangles (e, p, centre) and (e, centre, q), each seen from a face point's own place.
    for_each_skin_quad(grid, cuts, c,
                       [&](const Vec3& e, const int first, const Vec3& p, const int second, const Vec3& q) {
                         if (first == face)
                           sum += (-p).cross(e - p);
                         if (second == face)
                           sum += (e - q).cross(-q);
                       });
    result += sum;
  }
  return result;
}

class Placer {
 public:
  Placer(const Grid& grid, Cuts& cuts, const Placement& placement)
    : grid_(grid),
      cuts_(cuts),
      join_(placement.sharp_angle * std::numbers::pi / 180),
      threshold_(std::tan(0.5 * placement.sharp_angle * std::numbers::pi / 180)) {}

  PlacementCounts run(const std::span<const EdgeId> new_edges) {
    for (const auto& [c, new_lines] : grid::touched_cells(grid_, new_edges)) {
      const View view = look_at(c, new_lines);
      const auto faces = grid_.faces(c);
      for (int face = 0; face < cube::n_faces; ++face) {
        const FaceId f = faces[face];
        const bool first_seen = (face & 1) == 1 || !grid_.cells(f)[0].valid(); // else done from the cell below
        if ((new_lines & lines_of_face[face]) != 0 && first_seen)
          cuts_.set_point(f, place_face(view, face));
      }
      cuts_.set_point(c, place_cell(view));
    }
    return counts_;
  }

 private:
  View look_at(const CellId c, const unsigned new_lines) const {
    View view;
    view.cell = c;
    const auto nodes = grid_.nodes(c);
    const auto edges = grid_.edges(c);
    Index3 index = grid_.index(nodes[0]);
    view.lower = grid_.lattice().position(index);
    for (int& i : index)
      ++i;
    view.upper = grid_.lattice().position(index);
    for (int v = 0; v < cube::n_vertices; ++v)
      view.material |= unsigned(grid_.is_material(nodes[v])) << v;
    for (int line = 0; line < cube::n_lines; ++line)
      if (const grid::EdgeCut* cut = cuts_.find(edges[line])) {
        view.cut |= 1u << line;
        view.planes[line] = {point_on(view, line, cut->t), cut->normal};
        view.labels[line] = cut->label;
        view.skin |= unsigned(cut->label == grid::skin_label) << line;
      }
    view.old = view.cut & ~new_lines;
    return view;
  }

  Vec3 point_on(const View& view, const int line, const double t) const {
    const int v = cube::line_vertices[line][0];
    Vec3 p(v & 1 ? view.upper[0] : view.lower[0], v & 2 ? view.upper[1] : view.lower[1],
           v & 4 ? view.upper[2] : view.lower[2]);
    p[cube::line_axis(line)] += grid_.h() * t;
    return p;
  }

  /// Sorts the cuts of a face or cell into old skin, locked and open ones.
  static Site make_site(const View& view, const unsigned vertices, const unsigned lines, const Directions& inside) {
    Site site(view, inside);
    const unsigned cut = view.cut & lines, old = view.old & lines, material = view.material & vertices;
    const auto separates = [&](const unsigned cut_lines) {
      return std::popcount(cut_lines) > 1 && material != 0 &&
             (material & ~cube::reachable(std::countr_zero(material), cut_lines, vertices)) != 0;
    };
    site.splits = material != vertices || separates(cut);
    const bool was_split = separates(old);
    for_each_bit(cut, [&](const int line) {
      const Plane& plane = view.planes[line];
      if ((old & view.skin) >> line & 1)
        site.skin.push_back(plane);
      else if (was_split && (old >> line & 1))
        site.lock(plane, view.labels[line]);
      else
        site.open.push_back(plane);
    });
    return site;
  }

  /// Locks a vertex of the skin: it moves at right angles to the volume's derivative, and along a sharp edge of the
  /// skin only.
  void lock_skin(Site& site, const Vec3& derivative) const {
    const Vec3 normal = site.inside.projection * derivative;
    const bool sharp = fixed_directions(site.skin, site.inside, threshold_).n > 1;
    const bool opposed = normal.norm() < 1e-9 * grid_.h() * grid_.h(); // sheets that face each other
    if (!opposed)
      site.allowed.remove(normal.normalized(), 0.5);
    if (sharp || opposed)
      for (const Plane& plane : site.skin)
        site.lock(plane, grid::skin_label);
  }

  Vec3 place_face(const View& view, const int face) {
    const FaceId f = grid_.faces(view.cell)[face];
    const int normal = cube::face_axis(face);
    Directions in_face{Mat3::Identity(), 2};
    in_face.projection(normal, normal) = 0;
    Site site = make_site(view, cube::face_mask(face), lines_of_face[face], in_face);
    if (!site.skin.empty())
      lock_skin(site, volume_by_face(grid_, cuts_, f));
    if (!site.skin.empty() || !site.locked.empty())
      return slide(site, grid::face_point(grid_, cuts_, f));
    if (site.open.size() == 2) {
      const Vec3 middle = inside(site, mean_point(site.open));
      Moves moves;
      moves.push_back(join_(site.open[0], site.open[1], (normal + 1) % 3, (normal + 2) % 3) - middle);
      moves.push_back(Vec3::Zero());
      return hold_inside(site, middle, moves);
    }
    return meet(site, grid::centre(grid_, f));
  }

  Vec3 place_cell(const View& view) {
    Site site = make_site(view, 0xff, 0xfff, Directions());
    if (!site.skin.empty())
      lock_skin(site, volume_by_centre(grid_, cuts_, view.cell));
    if (!site.skin.empty() || !site.locked.empty())
      return slide(site, grid::cell_point(grid_, cuts_, view.cell));
    return meet(site, 0.5 * (view.lower + view.upper));
  }

  /// The directions that keep all locked planes: what each cut fixes alone, so that a cut that meets an earlier one at
  /// a small angle is not taken for one bent cut with it.
  Directions along_locked(const Site& site) const {
    constexpr double same = 1e-6; // sine of the angle below which sheets are taken for one, or for a side of the site
    Directions along = site.allowed;
    for (int i = 0; i < site.locked.size(); ++i) {
      const grid::CutLabel label = site.locked_labels[i];
      const auto* labels = site.locked_labels.begin();
      if (std::find(labels, labels + i, label) != labels + i)
        continue;
      Planes of_label;
      for (int k = i; k < site.locked.size(); ++k)
        if (site.locked_labels[k] == label)
          of_label.push_back(site.locked[k]);
      const Directions& seen_from = label == grid::skin_label ? site.allowed : site.inside;
      const Fixed fixed =
        fixed_directions(of_label, seen_from, threshold_, label == grid::skin_label ? least_lean : same);
      for (int k = 0; k < fixed.n; ++k)
        along.remove(fixed.of.vectors.col(k), same);
    }
    return along;
  }

  /// Later cuts: to the open planes along the locked ones; where that ends at a side of the site, on along the side.
  Vec3 slide(const Site& site, const Vec3& p) {
    const Directions along = along_locked(site);
    const Vec3 q = hold_inside(site, p, moves_to_planes(p, site.open, along, threshold_));
    const Planes sides = sides_at(site, q);
    if (sides.empty() || along.n < 2)
      return q;
    const Vec3 move = moves_to_planes(q, site.open, free_directions(sides, along, threshold_), threshold_).back();
    return q + part_inside(site, q, move) * move;
  }

  /// First cuts: the quadric's minimum nearest the middle of the cut, or nearest the centre where a front ends.
  Vec3 meet(const Site& site, const Vec3& centre) {
    const Vec3 start = inside(site, site.splits ? mean_point(site.open) : centre);
    return hold_inside(site, start, moves_to_planes(start, site.open, site.inside, threshold_));
  }

  double margin() const { return grid::min_edge_parameter * grid_.h(); }

  /// p, no closer to the sides of the site than a vertex may be.
  Vec3 inside(const Site& site, Vec3 p) const {
    const Vec3& lower = site.view.lower;
    for (int axis = 0; axis < 3; ++axis)
      if (site.reaches(axis))
        p[axis] = std::clamp(p[axis], lower[axis] + margin(), lower[axis] + grid_.h() - margin());
    return p;
  }

  /// The sides of the site that p has reached.
  Planes sides_at(const Site& site, const Vec3& p) const {
    const Vec3& lower = site.view.lower;
    const double reach = 2 * margin();
    Planes sides;
    for (int axis = 0; axis < 3; ++axis)
      if (site.reaches(axis) && (p[axis] < lower[axis] + reach || p[axis] > lower[axis] + grid_.h() - reach))
        sides.push_back({p, Vec3::Unit(axis)});
    return sides;
  }

  /// p and the first of the moves that stays in the site; the last one is shortened where none does.
  Vec3 hold_inside(const Site& site, const Vec3& p, const Moves& moves) {
    ++counts_.n_placed;
    for (const Vec3& move : moves) {
      if (part_inside(site, p, move) == 1)
        return p + move;
      counts_.n_clamped += &move == moves.begin();
    }
    return p + part_inside(site, p, moves.back()) * moves.back();
  }

  /// How much of a move from p stays in the site, in [0, 1].
  double part_inside(const Site& site, const Vec3& p, const Vec3& move) const {
    const Vec3& lower = site.view.lower;
    const double slack = 0.01 * margin(); // round-off of a vertex that is at a side and moves along it
    double part = 1;
    for (int axis = 0; axis < 3; ++axis) {
      if (!site.reaches(axis))
        continue;
      const double low = lower[axis] + margin(), high = lower[axis] + grid_.h() - margin();
      const double end = p[axis] + move[axis];
      if (end > high + slack)
        part = std::min(part, (high - p[axis]) / move[axis]);
      else if (end < low - slack)
        part = std::min(part, (low - p[axis]) / move[axis]);
    }
    return std::max(part, 0.0);
  }

  const Grid& grid_;
  Cuts& cuts_;
  Joint join_;
  double threshold_;
  PlacementCounts counts_;
};

} // namespace

PlacementCounts place(const Grid& grid, Cuts& cuts, const std::span<const EdgeId> new_edges,
                      const Placement& placement) {
  return Placer(grid, cuts, placement).run(new_edges);
}

} // namespace kerf::surface
