#include "surface/placement.h"

#include "grid/cube.h"
#include "grid/material.h"
#include "grid/touched.h"
#include "surface/cell_rim.h"
#include "surface/fold.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace kerf::surface {

namespace cube = grid::cube;
using grid::CellId;
using grid::EdgeId;
using grid::FaceId;
using grid::Solid;

namespace {

constexpr int no_axis = -1;

/// A face or a cell, with the planes of its cut edges sorted by what they ask of its vertex.
struct Site {
  Site(const View& of, const Directions& directions) : view(of), inside(directions) {}

  const View& view;
  Directions inside; ///< the directions within it
  Planes locked;     ///< cuts that already separate material here: the vertex stays on them
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

class Placer {
 public:
  Placer(Solid& solid, const Placement& placement)
    : solid_(solid),
      join_(placement.sharp_angle * std::numbers::pi / 180),
      threshold_(std::tan(0.5 * placement.sharp_angle * std::numbers::pi / 180)) {}

  PlacementCounts run() { return run(changed_cells()); }
  /// `cells` ascending: all around new cuts, and beside newly parted faces that blades have cut.
  PlacementCounts run(const std::span<const CellId> cells) {
    for (const CellId c : cells) {
      const View view = look_at(solid_, c);
      const unsigned new_lines = view.now.cut & ~view.old;
      if (new_lines == 0 && view.parted_faces == 0)
        continue;
      const auto faces = solid_.grid.faces(c);
      for (int face = 0; face < cube::n_faces; ++face) {
        const FaceId f = faces[face];
        const bool first_seen = (face & 1) == 1 || !solid_.grid.cells(f)[0].valid(); // else done from the cell below
        const bool has_changed = (new_lines & cube::lines_of_face[face]) != 0 || (view.parted_faces >> face & 1) != 0;
        if (has_changed && first_seen) {
          solid_.cuts.set_point(f, place_face(view, face));
          count_held();
        }
      }
      const Vec3 before = grid::cell_point(solid_, c);
      solid_.cuts.set_point(c, place_cell(view));
      if (view.now.has_two_points())
        unfold(view, before);
      count_held();
    }
    solid_.cuts.settle();
    return counts_;
  }

 private:
  void count_held() {
    counts_.n_clamped += is_held_;
    is_held_ = false;
  }

  /// Those around new cuts, and beside newly parted faces; ascending.
  std::vector<CellId> changed_cells() const {
    std::vector<EdgeId> edges;
    for (const grid::EdgeCut& cut : solid_.cuts.new_cuts())
      edges.push_back(cut.edge);
    std::vector<CellId> cells;
    for (const grid::TouchedCell& touched : grid::touched_cells(solid_.grid, edges))
      cells.push_back(touched.cell);
    if (solid_.cuts.newly_parted().empty())
      return cells;
    for (const FaceId f : solid_.cuts.newly_parted())
      for (const CellId c : solid_.grid.cells(f))
        if (c.valid())
          cells.push_back(c);
    std::sort(cells.begin(), cells.end());
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    return cells;
  }

  /// Sorts the cuts of a face or cell into those that separated material there before and open ones.
  static Site make_site(const View& view, const unsigned vertices, const unsigned lines, const Directions& inside) {
    Site site(view, inside);
    const unsigned cut = view.now.cut & lines, old = view.old & lines, material = view.now.material & vertices;
    const auto separates = [&](const unsigned cut_lines) {
      return std::popcount(cut_lines) > 1 && material != 0 &&
             (material & ~cube::reachable(std::countr_zero(material), cut_lines, vertices)) != 0;
    };
    site.splits = material != vertices || separates(cut);
    const bool was_split = separates(old);
    for_each_bit(cut, [&](const int line) {
      if (was_split && (old >> line & 1))
        site.lock(view.planes[line], view.labels[line]);
      else
        site.open.push_back(view.planes[line]);
    });
    return site;
  }

  /// The same of the blades' cuts alone, where the skin has a vertex of its own.
  static Site make_site_of_blades(const View& view, const unsigned lines, const Directions& inside, const int n_before,
                                  const int n_old, const int n_now) {
    Site site(view, inside);
    site.splits = n_now > n_before;
    for_each_bit(view.now.blades() & lines, [&](const int line) {
      if (n_old > n_before && (view.old >> line & 1))
        site.lock(view.planes[line], view.labels[line]);
      else
        site.open.push_back(view.planes[line]);
    });
    return site;
  }

  Vec3 place_face(const View& view, const int face) {
    const FaceId f = solid_.grid.faces(view.cell)[face];
    const int normal = cube::face_axis(face);
    Directions in_face{Mat3::Identity(), 2};
    in_face.projection(normal, normal) = 0;
    const unsigned vertices = cube::face_mask(face), lines = cube::lines_of_face[face];
    if (!view.now.has_two_points(face))
      return place_in(make_site(view, vertices, lines, in_face), normal, grid::face_point(solid_, f),
                      grid::centre(solid_.grid, f));
    const int n_old = keep_skin_point(f) ? 0 : parts_of(view.before(), face).n;
    const int n_before = parts_of(view.without_blades(), face).n;
    for (const grid::SkinArc& arc : grid::skin_arcs(face, view.now.material))
      if (view.now.is_rim(face, arc) && (solid_.cuts.skin_point(f)->has_rim || n_old <= n_before))
        return place_on_rim(view, face, arc);
    const Site site = make_site_of_blades(view, lines, in_face, n_before, n_old, parts_of(view.now, face).n);
    const Vec3 p = place_in(site, normal, grid::face_point(solid_, f), middle_of_material(site, vertices));
    const Vec3 from = mean_point_of_blades(view, lines);
    double part = 1;
    for (const grid::SkinArc& arc : grid::skin_arcs(face, view.now.material))
      part = std::min(part, part_before_line(from, p, view.skin_at(arc.lines[0]), solid_.cuts.skin_point(f)->p,
                                             view.skin_at(arc.lines[1]), normal));
    const Vec3 q = inside(site, hold_below_skin(from, p, part));
    const grid::SkinPoint& skin = *solid_.cuts.skin_point(f);
    if (!is_folded(view, face, q, skin))
      return q;
    is_held_ = true;
    const Vec3 before = grid::face_point(solid_, f);
    return is_folded(view, face, before, skin) ? skin.p : before;
  }

  Vec3 place_cell(const View& view) {
    const Vec3 p = grid::cell_point(solid_, view.cell);
    if (!view.now.has_two_points())
      return place_in(make_site(view, 0xff, 0xfff, Directions()), no_axis, p, 0.5 * (view.lower + view.upper));
    const int n_old = keep_skin_point(view.cell) ? 0 : parts_of(view.before()).n;
    const int n_before = parts_of(view.without_blades()).n;
    if (solid_.cuts.skin_point(view.cell)->has_rim)
      return p; // an earlier rim stays
    if (n_old <= n_before && rim_passes(solid_, view)) {
      const auto on_rim = surface::place_on_rim(solid_, view);
      is_held_ |= !on_rim;
      if (on_rim) {
        ++counts_.n_placed;
        solid_.cuts.set_skin_point(view.cell, on_rim->skin);
        return on_rim->p;
      }
    }
    const Site site = make_site_of_blades(view, 0xfff, Directions(), n_before, n_old, parts_of(view.now).n);
    const Vec3 q = place_in(site, no_axis, p, middle_of_material(site, 0xff));
    const Vec3 from = mean_point_of_blades(view, 0xfff);
    double part = 1;
    for_each_skin_triangle(solid_, view, [&](const std::array<Vec3, 3>& triangle) {
      part = std::min(part, part_before(from, q, triangle));
    });
    return inside(site, hold_below_skin(from, q, part));
  }

  /// Where the cell's vertex folds the skin, it goes back to where it was, on earlier cuts, or else to the skin's.
  void unfold(const View& view, const Vec3& before) {
    const Vec3 of_skin = solid_.cuts.skin_point(view.cell)->p;
    for (const Vec3& p : {before, of_skin})
      if (is_folded(solid_, view)) {
        solid_.cuts.set_point(view.cell, p);
        solid_.cuts.set_skin_point(view.cell, {of_skin});
        is_held_ = true;
      }
  }

  static Vec3 mean_point_of_blades(const View& view, const unsigned lines) {
    Planes planes;
    for_each_bit(view.now.blades() & lines, [&](const int line) { planes.push_back(view.planes[line]); });
    return mean_point(planes);
  }

  /// p, or where the way there from the cuts' edges still lies below the skin: material has no negative volume.
  Vec3 hold_below_skin(const Vec3& from, const Vec3& p, const double part) {
    constexpr double inside = 0.9;
    if (part >= 1)
      return p;
    is_held_ = true;
    return from + inside * part * (p - from);
  }

  /// Where the cuts ask for the vertex that is at p now; the first cuts of a front bring it near `middle`. A face has
  /// its normal's axis.
  Vec3 place_in(const Site& site, const int normal, const Vec3& p, const Vec3& middle) {
    if (!site.locked.empty())
      return slide(site, p);
    if (normal != no_axis && site.open.size() == 2) {
      const Vec3 start = inside(site, mean_point(site.open));
      Moves moves;
      moves.push_back(join_(site.open[0], site.open[1], (normal + 1) % 3, (normal + 2) % 3) - start);
      moves.push_back(Vec3::Zero());
      return hold_inside(site, start, moves);
    }
    return meet(site, middle);
  }

  /// Where blades come to have a vertex of their own, the one that was there stays with the skin. Returns whether that
  /// is so.
  template <class Id>
  bool keep_skin_point(const Id id) {
    if (solid_.cuts.skin_point(id))
      return false;
    solid_.cuts.set_skin_point(id, {point_of(id)});
    return true;
  }
  Vec3 point_of(const FaceId f) const { return grid::face_point(solid_, f); }
  Vec3 point_of(const CellId c) const { return grid::cell_point(solid_, c); }

  Vec3 place_on_rim(const View& view, const int face, const grid::SkinArc& arc) {
    const FaceId f = solid_.grid.faces(view.cell)[face];
    grid::SkinPoint of_skin = *solid_.cuts.skin_point(f);
    if (of_skin.has_rim)
      return grid::face_point(solid_, f); // an earlier rim stays
    const RimPoint rim = meet_line(view.mean_plane(view.now.blades() & grid::CellCuts::beside(arc)),
                                   view.skin_at(arc.lines[0]), of_skin.p, view.skin_at(arc.lines[1]));
    of_skin.lines &= static_cast<std::uint16_t>(~(1u << cube::place_in_face(face, arc.lines[1 - rim.side_of_corner])));
    of_skin.has_rim = true;
    ++counts_.n_placed;
    is_held_ |= !rim.is_met;
    const Vec3 p = along_skin(view, cube::face_axis(face), rim.p, of_skin.p);
    constexpr double little = 0.02;
    if (is_folded(view, face, p, of_skin, little)) {
      is_held_ = true;
      return of_skin.p;
    }
    solid_.cuts.set_skin_point(f, of_skin);
    return p;
  }

  /// p, no closer to the sides of a face than a vertex may be: it moves towards the skin's vertex, along the skin.
  static Vec3 along_skin(const View& view, const int normal, const Vec3& p, const Vec3& corner) {
    const Vec3 inside = view.inside(p);
    double part = 0;
    for (int axis = 0; axis < 3; ++axis)
      if (axis != normal && inside[axis] != p[axis])
        part = std::max(part, corner[axis] != p[axis] ? (inside[axis] - p[axis]) / (corner[axis] - p[axis]) : 1);
    return p + std::min(part, 1.0) * (corner - p);
  }

  /// Halfway between the site's cuts and its material nodes: below the skin, where a front ends there.
  static Vec3 middle_of_material(const Site& site, const unsigned vertices) {
    const View& view = site.view;
    Vec3 sum = Vec3::Zero();
    int n = 0;
    for_each_bit(view.now.material & vertices, [&](const int v) {
      for (int axis = 0; axis < 3; ++axis)
        sum[axis] += v >> axis & 1 ? view.upper[axis] : view.lower[axis];
      ++n;
    });
    return 0.5 * (mean_point(site.open) + sum / n);
  }

  /// The directions that keep all locked planes: what each cut fixes alone, so that a cut that meets an earlier one at
  /// a small angle is not taken for one bent cut with it.
  Directions along_locked(const Site& site) const {
    constexpr double same = 1e-6; // sine of the angle below which sheets are taken for one, or for a side of the site
    Directions along = site.inside;
    for (int i = 0; i < site.locked.size(); ++i) {
      const grid::CutLabel label = site.locked_labels[i];
      const auto* labels = site.locked_labels.begin();
      if (std::find(labels, labels + i, label) != labels + i)
        continue;
      Planes of_label;
      for (int k = i; k < site.locked.size(); ++k)
        if (site.locked_labels[k] == label)
          of_label.push_back(site.locked[k]);
      const Fixed fixed = fixed_directions(of_label, site.inside, threshold_, same);
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

  double margin() const { return grid::min_edge_parameter * solid_.grid.h(); }

  /// p, no closer to the sides of the site than a vertex may be.
  Vec3 inside(const Site& site, const Vec3& p) const {
    Vec3 q = site.view.inside(p);
    for (int axis = 0; axis < 3; ++axis)
      if (!site.reaches(axis))
        q[axis] = p[axis];
    return q;
  }

  /// The sides of the site that p has reached.
  Planes sides_at(const Site& site, const Vec3& p) const {
    const Vec3& lower = site.view.lower;
    const double reach = 2 * margin();
    Planes sides;
    for (int axis = 0; axis < 3; ++axis)
      if (site.reaches(axis) && (p[axis] < lower[axis] + reach || p[axis] > lower[axis] + solid_.grid.h() - reach))
        sides.push_back({p, Vec3::Unit(axis)});
    return sides;
  }

  /// p and the first of the moves that stays in the site; the last one is shortened where none does.
  Vec3 hold_inside(const Site& site, const Vec3& p, const Moves& moves) {
    ++counts_.n_placed;
    for (const Vec3& move : moves) {
      if (part_inside(site, p, move) == 1)
        return p + move;
      is_held_ = true;
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
      const double low = lower[axis] + margin(), high = lower[axis] + solid_.grid.h() - margin();
      const double end = p[axis] + move[axis];
      if (end > high + slack)
        part = std::min(part, (high - p[axis]) / move[axis]);
      else if (end < low - slack)
        part = std::min(part, (low - p[axis]) / move[axis]);
    }
    return std::max(part, 0.0);
  }

  Solid& solid_;
  Joint join_;
  double threshold_;
  PlacementCounts counts_;
  bool is_held_ = false; ///< whether the vertex that is placed now was held back
};

} // namespace

PlacementCounts place(Solid& solid, const Placement& placement) { return Placer(solid, placement).run(); }

PlacementCounts place(Solid& solid, const grid::CutChange& change, const Placement& placement) {
  return Placer(solid, placement).run(change.cells);
}

} // namespace kerf::surface
