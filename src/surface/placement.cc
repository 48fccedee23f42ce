#include "surface/placement.h"

#include "base/sort_unique.h"
#include "grid/cube.h"
#include "grid/touched.h"
#include "surface/below_skin.h"
#include "surface/border.h"
#include "surface/crossing.h"
#include "surface/in_triangle.h"
#include "surface/sight.h"
#include "surface/site.h"
#include "surface/unfold.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace kerf::surface {

namespace cube = grid::cube;
namespace skeleton = grid::skeleton;
using grid::CellId;
using grid::EdgeId;
using grid::FaceId;
using grid::Skeleton;
using grid::Solid;

namespace {

constexpr int no_axis = -1;

class Placer {
 public:
  Placer(Solid& solid, const Placement& placement)
    : solid_(solid),
      join_(placement.sharp_angle * std::numbers::pi / 180),
      threshold_(std::tan(0.5 * placement.sharp_angle * std::numbers::pi / 180)) {}

  /// At what is cut and not settled.
  PlacementCounts run() {
    std::vector<EdgeId> edges;
    for (const grid::EdgeCut& cut : solid_.cuts.new_cuts())
      edges.push_back(cut.edge);
    std::vector<grid::SkinSegment> segments;
    for (const grid::SkinCut& cut : solid_.cuts.new_skin_cuts())
      segments.push_back(cut.segment);
    std::vector<CellId> cells = grid::touched_cells(solid_.grid, edges, segments);
    return run(cells);
  }
  /// `cells` ascending: all around new cuts, or with fronts. Adds those beside them whose vertices it had to move.
  PlacementCounts run(std::vector<CellId>& cells) {
    for (const CellId c : cells) {
      const View view = look_at(solid_, c);
      const auto faces = solid_.grid.faces(c);
      for (int face = 0; face < cube::n_faces; ++face)
        if ((face & 1) == 1 || !solid_.grid.cells(faces[face])[0].valid()) // else done from the cell below
          place_in_face(view, face, faces[face]);
      if (view.now.is_cut_at_skin()) {
        place_in_skin(view, move_to_crossings(solid_, view));
        if (view.now.blades != view.old_blades)
          place_inner(view);
      } else if ((view.now.cut & ~view.old) != 0) {
        solid_.cuts.set_point(c, place_in(make_site(view, 0xff, 0xfff, Directions()), no_axis,
                                          grid::cell_point(solid_, c), 0.5 * (view.lower + view.upper)));
        count_held();
      }
    }
    for (const CellId c : cells)
      take_back_crossings(c);
    counts_.n_folded = unfold(solid_, cells);
    solid_.cuts.settle();
    return counts_;
  }

 private:
  void count_held() {
    counts_.n_clamped += is_held_;
    is_held_ = false;
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
        site.open_to(view.planes[line], view.labels[line]);
    });
    return site;
  }

  /// The same of the blades' cuts alone, where the skin has a vertex of its own: of those segments, which have fallen
  /// into so many parts before any of them, before the new ones, and now.
  Site make_site_of_blades(const View& view, const grid::Segments of, const Directions& inside,
                           const std::array<int, 3>& n_parts) const {
    Site site(view, inside);
    const auto& [n_first, n_old, n_now] = n_parts;
    site.splits = n_now > n_first;
    site.at_skin = true;
    for_each_bit(view.now.blades & of, [&](const int segment) {
      const CutPlane cut = cut_plane(solid_, view, segment);
      if (n_old > n_first && (view.old_blades >> segment & 1) != 0)
        site.lock(cut.plane, cut.label);
      else
        site.open_to(cut.plane, cut.label);
    });
    return site;
  }

  /// Within a face, whose normal's axis stays.
  static Directions in_face(const int face) {
    Directions directions{Mat3::Identity(), 2};
    const int normal = cube::face_axis(face);
    directions.projection(normal, normal) = 0;
    return directions;
  }

  void place_in_face(const View& view, const int face, const FaceId f) {
    const unsigned vertices = cube::face_mask(face), lines = cube::lines_of_face[face];
    if (view.now.blades != 0 && (view.now.material & vertices) != vertices) {
      for (const int arc : {0, 1})
        if (const int side = skeleton::polygon(face, arc); (view.now.skeleton().sides >> side & 1) != 0)
          place_polygon(view, side, f);
    } else if ((view.now.cut & ~view.old & lines) != 0) {
      solid_.cuts.set_point(f, place_in(make_site(view, vertices, lines, in_face(face)), cube::face_axis(face),
                                        grid::face_point(solid_, f), grid::centre(solid_.grid, f)));
      count_held();
    }
  }

  /// Of the material beside an arc of the skin, in a face.
  void place_polygon(const View& view, const int side, const FaceId f) {
    const int face = side / 2, arc = side % 2;
    const grid::Segments of = border(view.now.skeleton().side[side]);
    if ((view.now.blades & ~view.old_blades & of) == 0)
      return;
    const auto n_parts = [&](const grid::Segments cut) { return std::max(1, std::popcount(cut & of)); };
    const Site site =
      make_site_of_blades(view, of, in_face(face), {1, n_parts(view.old_blades), n_parts(view.now.blades)});
    const Vec3 middle = middle_of(solid_, view, side);
    const Vec3* const before = solid_.cuts.inner_point(f, arc);
    const Vec3 p = place_in(site, cube::face_axis(face), before ? *before : middle,
                            0.5 * (mean_point_of(solid_, view, of) + middle));
    const grid::SkinArc& of_skin = grid::skin_arcs(face, view.now.material).arcs[arc];
    const auto at = [&](const int item) { return grid::item_point(solid_, view.cell, item); };
    const auto part = [&](const Vec3& from) {
      return part_before_line(from, p, at(skeleton::on_line(of_skin.lines[0])), at(skeleton::on_arc(face, arc)),
                              at(skeleton::on_line(of_skin.lines[1])), cube::face_axis(face));
    };
    const Vec3 from = site.locked.empty() ? between_cuts(site, p, part) : *before;
    const Vec3 q = hold_below_skin(from, p, part(from));
    const auto seeing = see(
      site, q, [&] { return cuts_are_in_plane(solid_, view, face, q); },
      [&](const Vec3& at) { return parts_have_areas(solid_, view, side, at); },
      [&](const std::vector<Plane>& in_planes) { return seeing_border(solid_, view, side, q, in_planes); });
    solid_.cuts.set_inner_point(f, arc, seeing);
    count_held();
  }

  /// A vertex at q, or near it where the material around it is seen (sight.h): within the plane of all cuts, or of those
  /// that it may not leave; else, but where all cuts around lie in one plane, along their bend or sheet, or off that as
  /// little as is good enough. What cuts in one plane leave is the same wherever in it the vertex lies.
  template <class IsFlat, class IsGood, class Seeing>
  Vec3 see(const Site& site, const Vec3& q, const IsFlat& is_flat, const IsGood& is_good, const Seeing& seeing) {
    Planes all = site.locked;
    for (const Plane& plane : site.open)
      all.push_back(plane);
    for (const Planes& planes : {all, site.locked})
      if (const auto plane = common_plane(planes, q, in_plane * solid_.grid.h()))
        if (const auto p = seeing({*plane}))
          return *p;
    if (is_flat())
      return q;
    const Fixed fixed = fixed_directions(all, site.inside, threshold_);
    for (int n = std::min(fixed.n, site.inside.n - 1); n > 0; --n) { // along a bend, or else the sheet
      std::vector<Plane> in_planes;
      for (int k = 0; k < n; ++k)
        in_planes.push_back({q, fixed.of.vectors.col(k)});
      if (const auto p = seeing(in_planes); p && is_good(*p)) {
        is_held_ |= *p != q;
        return *p;
      }
    }
    const auto p = seeing({});
    const Vec3 found = p ? nearest(q, *p, is_good) : q;
    is_held_ |= found != q;
    return found;
  }

  /// Where something new cuts a triangle, or it is to be placed anew.
  void place_in_skin(const View& view, const grid::Sides anew) {
    for_each_bit(view.now.skeleton().sides >> skeleton::first_triangle,
                 [&](const int triangle) { place_triangle(view, triangle, (anew >> triangle & 1) != 0); });
  }

  /// Where a part would have less than nothing else: planes that bend may not cross where those of their cuts do.
  void take_back_crossings(const CellId c) {
    if (!has_crossings(solid_, c) || has_material(solid_, look_at(solid_, c), nothing))
      return;
    const View view = look_at(solid_, c);
    place_in_skin(view, surface::take_back_crossings(solid_, view));
    place_inner(view);
  }

  void place_triangle(const View& view, const int triangle, const bool is_anew) {
    const grid::Segments of = border(view.now.skeleton().side[skeleton::first_triangle + triangle]);
    if ((view.now.blades & ~view.old_blades & of) == 0 && !is_anew)
      return;
    if (const auto p = point_in_triangle(solid_, view, triangle)) {
      solid_.cuts.set_inner_point(view.cell, triangle, *p);
      ++counts_.n_placed;
    }
  }

  /// In a cell with skin.
  void place_inner(const View& view) {
    const CellId c = view.cell;
    const auto n_parts = [&](const grid::Segments cut) {
      return grid::whole_parts_of({view.now.material, view.now.cut, cut}).n;
    };
    const Site site = make_site_of_blades(view, ~grid::Segments(0), Directions(),
                                          {n_parts(0), n_parts(view.old_blades), n_parts(view.now.blades)});
    const Vec3* const before = solid_.cuts.inner_point(c);
    const Vec3 middle = 0.5 * (mean_point_of(solid_, view, ~grid::Segments(0)) + mean_node(view)),
               p = place_in(site, no_axis, before ? *before : middle, middle);
    const auto part = [&](const Vec3& from) {
      double result = 1;
      for_each_bit(view.now.skeleton().sides >> skeleton::first_triangle, [&](const int triangle) {
        const auto& items = view.now.skeleton().side[skeleton::first_triangle + triangle].items;
        const auto at = [&](const int k) { return grid::item_point(solid_, c, items[k]); };
        result = std::min(result, part_before(from, p, {at(0), at(1), at(2)}));
      });
      return result;
    };
    const Vec3 from = site.locked.empty() ? between_cuts(site, p, part) : *before,
               q = hold_below_skin(from, p, part(from));
    constexpr double least = 1e-12; // of a cube
    const auto seeing = [&](const std::vector<Plane>& in_planes) { return seeing_skin(solid_, view, q, in_planes); };
    const auto is_good = [&](const Vec3& at) { return has_material(solid_, view, at, least); };
    solid_.cuts.set_inner_point(c, border_is_in_plane(solid_, view, q)
                                     ? point_that_sees_border(solid_, view, q).value_or(q)
                                     : see(site, q, [&] { return cuts_are_in_plane(solid_, view, q); },
                                           is_good, seeing));
    count_held();
  }

  Vec3 mean_node(const View& view) const {
    Vec3 sum = Vec3::Zero();
    for_each_bit(view.now.material, [&](const int v) { sum += grid::item_point(solid_, view.cell, v); });
    return sum / std::popcount(view.now.material);
  }

  /// Where the way to a vertex begins, a `part` of which the skin leaves: in the middle of the cuts; where these have
  /// several labels, of those on whose planes it lies, if that brings it into the material.
  template <class Part>
  static Vec3 between_cuts(const Site& site, const Vec3& p, const Part& part) {
    constexpr double least = 0.1;
    const Vec3 middle = mean_point(site.open);
    if (!site.has_several_labels() || part(middle) == 1)
      return middle;
    Vec3 own = middle;
    double nearest = std::numeric_limits<double>::infinity();
    for_each_label(site.open, site.open_labels, [&](grid::CutLabel, const Planes& of_label) {
      double distance = 0;
      for (const Plane& plane : of_label)
        distance = std::max(distance, std::abs(plane.normal.dot(p - plane.point)));
      if (distance < nearest) {
        nearest = distance;
        own = mean_point(of_label);
      }
    });
    return part(own) > least ? own : middle;
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
    if (normal != no_axis && site.open.size() == 2 && site.open_labels[0] == site.open_labels[1]) {
      const Vec3 start = inside(site, mean_point(site.open));
      Moves moves;
      moves.push_back(join_(site.open[0], site.open[1], (normal + 1) % 3, (normal + 2) % 3) - start);
      moves.push_back(Vec3::Zero());
      return *first_inside(site, start, moves);
    }
    return meet(site, middle);
  }

  /// The directions that keep all locked planes: what each cut fixes alone, so that a cut that meets an earlier one at
  /// a small angle is not taken for one bent cut with it.
  Directions along_locked(const Site& site) const {
    constexpr double same = 1e-6; // sine of the angle below which sheets are taken for one, or for a side of the site
    Directions along = site.inside;
    for_each_label(site.locked, site.locked_labels, [&](grid::CutLabel, const Planes& of_label) {
      const Fixed fixed = fixed_directions(of_label, site.inside, threshold_, same);
      for (int k = 0; k < fixed.n; ++k)
        along.remove(fixed.of.vectors.col(k), same);
    });
    return along;
  }

  /// Later cuts: to the open planes along the locked ones; where that ends at a side of the site, on along the side.
  Vec3 slide(const Site& site, const Vec3& p) {
    const Directions along = along_locked(site);
    const Moves moves = moves_to_planes(p, site.open, along, threshold_);
    if (const auto inside = first_inside(site, p, moves))
      return *inside;
    const Vec3 q = p + part_inside(site, p, moves.back()) * moves.back();
    const Planes sides = sides_at(site, q);
    if (sides.empty() || along.n < 2)
      return held(site, p, q - p);
    const Vec3 move = moves_to_planes(q, site.open, free_directions(sides, along, threshold_), threshold_).back();
    return held(site, p, q + part_inside(site, q, move) * move - p);
  }

  /// As far along a move that a side holds as leaves some room there: with one of the side's own vertices in the same
  /// place, a triangle would have no area.
  Vec3 held(const Site& site, const Vec3& p, const Vec3& move) const {
    constexpr double room = 1e-3; // of h
    return p + part_inside(site, p, move, room * solid_.grid.h()) * move;
  }

  /// First cuts: the quadric's minimum nearest the middle of the cut, or nearest the centre where a front ends. Cuts of
  /// several labels are no bent one: where they do not meet in the site, the vertex lies on one of them.
  Vec3 meet(const Site& site, const Vec3& centre) {
    const Vec3 start = inside(site, site.splits ? mean_point(site.open) : centre);
    if (!site.has_several_labels()) {
      const Moves moves = moves_to_planes(start, site.open, site.inside, threshold_);
      const auto p = first_inside(site, start, moves);
      if (!p && site.open.size() == 1 && !site.at_skin)
        return on_planes(site, site.open, start + moves[0]);
      return p ? *p : Vec3(start + part_inside(site, start, moves.back()) * moves.back());
    }
    constexpr double same = 1e-3; // tangent of half the angle below which cuts of two labels are one
    Planes sheets;
    Vec3 best = start; // on most cuts, then nearest
    std::pair<int, double> cuts_and_way;
    for_each_label(site.open, site.open_labels, [&](grid::CutLabel, const Planes& of_label) {
      const Vec3 foot = start + moves_to_planes(start, of_label, site.inside, threshold_)[0];
      const Fixed fixed = fixed_directions(of_label, site.inside, threshold_);
      for (int k = 0; k < fixed.n; ++k)
        sheets.push_back({foot, fixed.of.vectors.col(k)});
      const Vec3 p = part_inside(site, start, foot - start) == 1 ? foot : on_planes(site, of_label, foot);
      if (const std::pair found(of_label.size(), -(p - start).norm()); found > cuts_and_way) {
        cuts_and_way = found;
        best = p;
      }
    });
    ++counts_.n_placed;
    const Vec3 move = moves_to_planes(start, sheets, site.inside, same)[0];
    const bool is_met = part_inside(site, start, move) == 1 && std::ranges::all_of(sheets, [&](const Plane& sheet) {
                          return std::abs(sheet.normal.dot(start + move - sheet.point)) < 1e-9 * solid_.grid.h();
                        });
    is_held_ |= !is_met;
    return is_met ? start + move : best;
  }

  /// A point of the site on the planes of cuts whose foot is outside: from their middle halfway to the site's side, the
  /// way to the foot or, where that leads out at once, the other way.
  Vec3 on_planes(const Site& site, const Planes& planes, const Vec3& foot) const {
    const double h = solid_.grid.h();
    const Vec3 p = inside(site, mean_point(planes)), to_foot = site.inside.projection * (foot - p);
    if (to_foot.norm() < 1e-6 * h)
      return p;
    const Vec3 way = 2 * h * to_foot.normalized();
    const double there = part_inside(site, p, way), back = part_inside(site, p, -way);
    return p + 0.5 * (there > back ? there : -back) * way;
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

  /// p and the first of the moves that stays in the site; none where all lead out of it.
  std::optional<Vec3> first_inside(const Site& site, const Vec3& p, const Moves& moves) {
    ++counts_.n_placed;
    for (const Vec3& move : moves) {
      if (part_inside(site, p, move) == 1)
        return p + move;
      is_held_ = true;
    }
    return {};
  }

  /// How much of a move from p stays in the site, no closer to its sides than `room`, or than p is; in [0, 1].
  double part_inside(const Site& site, const Vec3& p, const Vec3& move) const {
    return part_inside(site, p, move, margin());
  }
  double part_inside(const Site& site, const Vec3& p, const Vec3& move, const double room) const {
    const Vec3& lower = site.view.lower;
    const double slack = 0.01 * margin(); // round-off of a vertex that is at a side and moves along it
    double part = 1;
    for (int axis = 0; axis < 3; ++axis) {
      if (!site.reaches(axis))
        continue;
      const double low = std::min(p[axis], lower[axis] + room),
                   high = std::max(p[axis], lower[axis] + solid_.grid.h() - room);
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

PlacementCounts place(Solid& solid, grid::CutChange& change, const Placement& placement) {
  const std::size_t n = change.cells.size();
  const PlacementCounts counts = Placer(solid, placement).run(change.cells);
  if (change.cells.size() > n) {
    for (const CellId cell : change.cells)
      for (const grid::CopyId c : solid.complex.copies_of(cell))
        change.reshaped.push_back(c);
    sort_unique(change.reshaped);
  }
  return counts;
}

} // namespace kerf::surface
