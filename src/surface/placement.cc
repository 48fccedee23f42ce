#include "surface/placement.h"

#include "grid/cube.h"
#include "surface/table.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <vector>

namespace kerf::surface {

namespace cube = grid::cube;
using grid::CellId;
using grid::Cuts;
using grid::EdgeId;
using grid::FaceId;
using grid::Grid;

namespace {

struct Plane {
  Vec3 point, normal;
};
using Planes = std::vector<Plane>;
/// Columns span the directions in which a vertex may move.
using Directions = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3>;

/// A face or a cell, with the planes of its cut edges sorted by what they ask of its vertex.
struct Site {
  CellId cell;
  unsigned vertices = 0; ///< bits of its vertices in the cell
  Directions inside;     ///< the directions within it
  Directions allowed;    ///< those of them that keep the skin's volume
  Planes locked;         ///< cuts that already separate material here: the vertex stays on them
  Planes open;           ///< cuts that the vertex has yet to meet
  bool splits = false;   ///< with all cuts, material here is separated
};

Vec3 mean_point(const Planes& planes) {
  Vec3 sum = Vec3::Zero();
  for (const Plane& plane : planes)
    sum += plane.point;
  return sum / static_cast<double>(planes.size());
}

/// Singular value decomposition of the planes' normals, as seen from the allowed directions.
Eigen::JacobiSVD<Eigen::MatrixXd> decompose(const Planes& planes, const Directions& allowed) {
  Eigen::MatrixXd normals(planes.size(), allowed.cols());
  for (std::size_t i = 0; i < planes.size(); ++i)
    normals.row(i) = planes[i].normal.transpose() * allowed;
  return Eigen::JacobiSVD<Eigen::MatrixXd>(normals, Eigen::ComputeFullV | Eigen::ComputeThinU);
}

/// How many directions the planes fix: those whose singular value is not small beside the largest.
int rank(const Eigen::JacobiSVD<Eigen::MatrixXd>& svd, const double threshold) {
  constexpr double parallel = 0.1; // a plane that leans less than this against what may move fixes nothing
  const auto& s = svd.singularValues();
  int n = 0;
  while (n < s.size() && s[n] > parallel && s[n] > threshold * s[0])
    ++n;
  return n;
}

/// The allowed directions along which all planes stay met.
Directions free_directions(const Planes& planes, const Directions& allowed, const double threshold) {
  const auto svd = decompose(planes, allowed);
  return allowed * svd.matrixV().rightCols(allowed.cols() - rank(svd, threshold));
}

/// The smallest moves of p within the allowed directions that minimise the squared distances to the planes [GH97]:
/// first to as many independent ones as there are, then to ever fewer, the weakest left out first. Never empty.
Points moves_to_planes(const Vec3& p, const Planes& planes, const Directions& allowed, const double threshold) {
  Points moves = {Vec3::Zero()};
  if (allowed.cols() == 0 || planes.empty())
    return moves;
  const auto svd = decompose(planes, allowed);
  Eigen::VectorXd distances(planes.size());
  for (std::size_t i = 0; i < planes.size(); ++i)
    distances[i] = planes[i].normal.dot(planes[i].point - p);
  for (int n = 0; n < rank(svd, threshold); ++n)
    moves.push_back(moves.back() +
                    allowed * svd.matrixV().col(n) * svd.matrixU().col(n).dot(distances) / svd.singularValues()[n]);
  if (moves.size() > 1)
    moves.erase(moves.begin());
  std::reverse(moves.begin(), moves.end());
  return moves;
}

/// Figure 2.15 (b), (c): where two cut lines in a face are joined.
Vec3 join(const Plane& a, const Plane& b, const Directions& in_face, const double sharp_angle) {
  const Vec3 middle = 0.5 * (a.point + b.point);
  const Eigen::Vector2d m = in_face.transpose() * a.normal, n = in_face.transpose() * b.normal;
  const double sine = m[0] * n[1] - m[1] * n[0];
  if (std::abs(sine) < 1e-6 * m.norm() * n.norm() || m.norm() * n.norm() == 0)
    return middle;
  const double da = a.normal.dot(a.point - middle), db = b.normal.dot(b.point - middle);
  const Vec3 meeting = middle + in_face * Eigen::Vector2d(da * n[1] - db * m[1], db * m[0] - da * n[0]) / sine;
  const Vec3 arriving = meeting - a.point, leaving = b.point - meeting;
  const double turn = std::atan2(arriving.cross(leaving).norm(), arriving.dot(leaving));
  if (turn > 0.5 * std::numbers::pi + sharp_angle)
    return middle; // the curve would turn back: the two planes do not belong to one cut
  return turn > sharp_angle ? meeting : Vec3(0.25 * (a.point + 2 * meeting + b.point));
}

/// The derivatives of a cell's skin volume (times 6) by its vertices, summed over the skin's triangles in the cell.
/// Volume is linear in each vertex: a move at right angles to the derivative keeps it exactly.
struct VolumeDerivatives {
  Vec3 by_centre = Vec3::Zero();
  std::array<Vec3, 6> by_face{Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
};

VolumeDerivatives skin_volume_derivatives(const Grid& grid, const Cuts& cuts, const CellId c) {
  VolumeDerivatives result;
  const Vec3 origin = grid::cell_point(grid, cuts, c);
  unsigned skin_lines = 0;
  for (int line = 0; line < cube::n_lines; ++line) {
    const grid::EdgeCut* cut = cuts.find(grid.edges(c)[line]);
    skin_lines |= unsigned(cut && cut->label == grid::skin_label) << line;
  }
  for (const Quad& quad : splitting_table().row(skin_lines)) {
    if (!grid.is_material(grid.nodes(c)[quad.end]))
      continue;
    const int first = quad.vertices[1].index, second = quad.vertices[3].index;
    const Vec3 e = grid::edge_point(grid, cuts, grid.edges(c)[quad.line]) - origin;
    const Vec3 f = grid::face_point(grid, cuts, grid.faces(c)[first]) - origin;
    const Vec3 g = grid::face_point(grid, cuts, grid.faces(c)[second]) - origin;
    result.by_centre += e.cross(f) + g.cross(e);
    // The triangles (e, f, centre) and (e, centre, g), each seen from a face point's own place.
    result.by_face[first] += (Vec3::Zero() - f).cross(e - f);
    result.by_face[second] += (e - g).cross(Vec3::Zero() - g);
  }
  return result;
}

class Placer {
 public:
  Placer(const Grid& grid, Cuts& cuts, std::span<const EdgeId> new_edges, const Placement& placement)
    : grid_(grid),
      cuts_(cuts),
      new_edges_(new_edges.begin(), new_edges.end()),
      sharp_angle_(placement.sharp_angle * std::numbers::pi / 180),
      threshold_(std::tan(0.5 * sharp_angle_)) {
    std::sort(new_edges_.begin(), new_edges_.end());
  }

  PlacementCounts run() {
    for (const CellId c : touched_cells()) {
      for (int face = 0; face < cube::n_faces; ++face) {
        const FaceId f = grid_.faces(c)[face];
        const bool first_seen = (face & 1) == 1 || !grid_.cells(f)[0].valid(); // else done from the cell below
        if (first_seen && face_touches_new(c, face))
          cuts_.set_point(f, place_face(c, face));
      }
      cuts_.set_point(c, place_cell(c));
    }
    return counts_;
  }

 private:
  bool is_new(const EdgeId e) const { return std::binary_search(new_edges_.begin(), new_edges_.end(), e); }

  bool face_touches_new(const CellId c, const int face) const {
    const auto& lines = cube::face_lines[face];
    return std::any_of(lines.begin(), lines.end(), [&](const int line) { return is_new(grid_.edges(c)[line]); });
  }

  std::vector<CellId> touched_cells() const {
    std::vector<CellId> cells;
    for (const EdgeId e : new_edges_)
      for (const CellId c : grid_.cells(e))
        if (c.valid())
          cells.push_back(c);
    std::sort(cells.begin(), cells.end());
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    return cells;
  }

  /// Locks a vertex of the skin: it moves at right angles to the volume's derivative, and along a sharp edge of the
  /// skin only.
  void lock_skin(Site& site, const Planes& skin, const Vec3& p, const Vec3& derivative) const {
    Vec3 normal = Vec3::Zero();
    for (int k = 0; k < site.inside.cols(); ++k)
      normal += site.inside.col(k) * site.inside.col(k).dot(derivative);
    const bool sharp = rank(decompose(skin, site.inside), threshold_) > 1;
    const bool opposed = normal.norm() < 1e-9 * grid_.h() * grid_.h(); // sheets that face each other
    if (!opposed)
      site.allowed = free_directions({{p, normal.normalized()}}, site.inside, threshold_);
    if (sharp || opposed)
      site.locked.insert(site.locked.end(), skin.begin(), skin.end());
  }

  Vec3 face_derivative(const FaceId f) const {
    Vec3 sum = Vec3::Zero();
    for (const CellId c : grid_.cells(f))
      if (c.valid()) {
        const auto& faces = grid_.faces(c);
        sum +=
          skin_volume_derivatives(grid_, cuts_, c).by_face[std::find(faces.begin(), faces.end(), f) - faces.begin()];
      }
    return sum;
  }

  /// Sorts the cuts on `lines` of a cell into locked and open ones; those of the skin that stood before go to `skin`.
  template <class Lines>
  Site make_site(const CellId c, const unsigned vertices, const Lines& lines, const Directions& inside,
                 Planes& skin) const {
    Site site{c, vertices, inside, inside, {}, {}, false};
    unsigned cut_lines = 0, old_lines = 0, material = 0;
    for (const int line : lines)
      if (cuts_.is_cut(grid_.edges(c)[line])) {
        cut_lines |= 1u << line;
        if (!is_new(grid_.edges(c)[line]))
          old_lines |= 1u << line;
      }
    for (int v = 0; v < cube::n_vertices; ++v)
      if ((vertices >> v & 1) && grid_.is_material(grid_.nodes(c)[v]))
        material |= 1u << v;
    const auto separates = [&](const unsigned cut) {
      return material != 0 && (material & ~cube::reachable(std::countr_zero(material), cut, vertices)) != 0;
    };
    site.splits = material != vertices || separates(cut_lines);
    const bool was_split = separates(old_lines);
    for (const int line : lines)
      if (cut_lines >> line & 1) {
        const EdgeId e = grid_.edges(c)[line];
        const grid::EdgeCut& cut = *cuts_.find(e);
        const bool is_old = (old_lines >> line & 1) != 0;
        Planes& planes = is_old && cut.label == grid::skin_label ? skin : is_old && was_split ? site.locked : site.open;
        planes.push_back({grid::edge_point(grid_, cuts_, e), cut.normal});
      }
    return site;
  }

  Vec3 place_face(const CellId c, const int face) {
    const FaceId f = grid_.faces(c)[face];
    const int normal = cube::face_axis(face);
    Directions in_face(3, 2);
    in_face << Vec3::Unit((normal + 1) % 3), Vec3::Unit((normal + 2) % 3);
    Planes skin;
    Site site = make_site(c, cube::face_mask(face), cube::face_lines[face], in_face, skin);
    if (!skin.empty())
      lock_skin(site, skin, grid::face_point(grid_, cuts_, f), face_derivative(f));
    if (!skin.empty() || !site.locked.empty())
      return slide(site, grid::face_point(grid_, cuts_, f));
    if (site.open.size() == 2) {
      const Vec3 middle = inside(site, mean_point(site.open));
      return hold_inside(site, middle,
                         {join(site.open[0], site.open[1], in_face, sharp_angle_) - middle, Vec3::Zero()});
    }
    return meet(site, grid::centre(grid_, f));
  }

  Vec3 place_cell(const CellId c) {
    constexpr std::array<int, 12> lines = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
    Planes skin;
    Site site = make_site(c, 0xff, lines, Mat3::Identity(), skin);
    if (!skin.empty())
      lock_skin(site, skin, grid::cell_point(grid_, cuts_, c), skin_volume_derivatives(grid_, cuts_, c).by_centre);
    if (!skin.empty() || !site.locked.empty())
      return slide(site, grid::cell_point(grid_, cuts_, c));
    return meet(site, grid::centre(grid_, c));
  }

  /// Later cuts: to the open planes along the locked ones; where that ends at a side of the site, on along the side.
  Vec3 slide(const Site& site, const Vec3& p) {
    const Directions along =
      site.locked.empty() ? site.allowed : free_directions(site.locked, site.allowed, threshold_);
    const Vec3 q = hold_inside(site, p, moves_to_planes(p, site.open, along, threshold_));
    const Planes sides = sides_at(site, q);
    if (sides.empty() || along.cols() < 2)
      return q;
    const Vec3 move = moves_to_planes(q, site.open, free_directions(sides, along, threshold_), threshold_).back();
    return q + part_inside(site, q, move) * move;
  }

  /// First cuts: the quadric's minimum nearest the middle of the cut, or nearest the centre where a front ends.
  Vec3 meet(const Site& site, const Vec3& centre) {
    const Vec3 start = inside(site, site.splits ? mean_point(site.open) : centre);
    return hold_inside(site, start, moves_to_planes(start, site.open, site.inside, threshold_));
  }

  /// p, no closer to the sides of the site than a vertex may be.
  Vec3 inside(const Site& site, Vec3 p) const {
    const Vec3 lower = grid_.origin(site.cell);
    const double margin = grid::min_edge_parameter * grid_.h();
    for (int axis = 0; axis < 3; ++axis)
      if (!site.inside.row(axis).isZero())
        p[axis] = std::clamp(p[axis], lower[axis] + margin, lower[axis] + grid_.h() - margin);
    return p;
  }

  /// The sides of the site that p has reached.
  Planes sides_at(const Site& site, const Vec3& p) const {
    const Vec3 lower = grid_.origin(site.cell);
    const double reach = 2 * grid::min_edge_parameter * grid_.h();
    Planes sides;
    for (int axis = 0; axis < 3; ++axis)
      if (!site.inside.row(axis).isZero() &&
          (p[axis] < lower[axis] + reach || p[axis] > lower[axis] + grid_.h() - reach))
        sides.push_back({p, Vec3::Unit(axis)});
    return sides;
  }

  /// p and the first of the moves that stays in the site; the last one is shortened where none does.
  Vec3 hold_inside(const Site& site, const Vec3& p, const Points& moves) {
    ++counts_.n_placed;
    for (const Vec3& move : moves)
      if (part_inside(site, p, move) == 1)
        return p + move;
    ++counts_.n_clamped;
    return p + part_inside(site, p, moves.back()) * moves.back();
  }

  /// How much of a move from p stays in the site, in [0, 1].
  double part_inside(const Site& site, const Vec3& p, const Vec3& move) const {
    const Vec3 lower = grid_.origin(site.cell);
    const double margin = grid::min_edge_parameter * grid_.h();
    double part = 1;
    for (int axis = 0; axis < 3; ++axis) {
      if (site.inside.row(axis).isZero())
        continue;
      const double low = lower[axis] + margin, high = lower[axis] + grid_.h() - margin;
      const double end = p[axis] + move[axis];
      if (end > high)
        part = std::min(part, (high - p[axis]) / move[axis]);
      else if (end < low)
        part = std::min(part, (low - p[axis]) / move[axis]);
    }
    return std::max(part, 0.0);
  }

  const Grid& grid_;
  Cuts& cuts_;
  std::vector<EdgeId> new_edges_;
  double sharp_angle_, threshold_;
  PlacementCounts counts_;
};

} // namespace

PlacementCounts place(const Grid& grid, Cuts& cuts, const std::span<const EdgeId> new_edges,
                      const Placement& placement) {
  return Placer(grid, cuts, new_edges, placement).run();
}

} // namespace kerf::surface
