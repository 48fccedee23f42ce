#include "cut/cut_surface.h"

#include "base/error.h"
#include "cut/may_meet.h"
#include "cut/target.h"
#include "geometry/box_tree.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace kerf::cut {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

[[noreturn]] void refuse(const std::string& key, const std::string& rule) {
  throw ParameterError(Complaint{.path = key, .rule = rule});
}

void require_place(const Vec3& p) {
  if (!p.allFinite())
    refuse("Point [m]", "must be three finite numbers");
}

void require_direction(const Vec3& d, const std::string& key) {
  if (!(std::abs(d.norm() - 1) < 1e-9))
    refuse(key, "must be a direction: finite and not zero");
}

void require_length(const double length, const std::string& key) {
  if (!(length > 0 && length < infinity))
    refuse(key, "must be > 0");
}

void check_shape(const Plane& plane) {
  require_place(plane.point);
  require_direction(plane.normal, "Normal [1]");
}

void check_shape(const Sphere& sphere) {
  require_place(sphere.centre);
  require_length(sphere.radius, "Radius [m]");
}

void check_shape(const Cylinder& cylinder) {
  require_place(cylinder.centre);
  require_direction(cylinder.axis, "Axis [1]");
  require_length(cylinder.radius, "Radius [m]");
  require_length(cylinder.height, "Height [m]");
}

void check_shape(const Disc& disc) {
  require_place(disc.centre);
  require_direction(disc.normal, "Normal [1]");
  require_length(disc.radius, "Radius [m]");
}

void check_shape(const Rectangle& rectangle) {
  constexpr double right = 1e-4; // cosine: sides are written with some digits
  const Vec3 &a = rectangle.first_side, &b = rectangle.second_side;
  require_place(rectangle.centre);
  require_length(a.stableNorm(), "First side [m]");
  require_length(b.stableNorm(), "Second side [m]");
  if (!(std::abs(a.stableNormalized().dot(b.stableNormalized())) < right))
    refuse("Second side [m]", "must be at right angles to First side [m]");
}

void check_shape(const geometry::TriangleMesh& mesh) {
  if (mesh.triangles.empty())
    refuse("Mesh", "must have a triangle");
}

/// Where a line p + t d enters a convex body and where it leaves it, with the body's normals there.
struct Chord {
  double enter = -infinity, leave = infinity;
  Vec3 normal_at_enter = Vec3::Zero(), normal_at_leave = Vec3::Zero();
};

/// The chord of |e + t d| < r, e and d being vectors in space or at right angles to a cylinder's axis. A line that only
/// grazes gets the point next to the middle twice: rounding may have put an end of it inside all the same.
Chord ball_chord(const Vec3& e, const Vec3& d, const double radius) {
  const double a = d.squaredNorm(), b = e.dot(d), c = e.squaredNorm() - radius * radius;
  if (a == 0)
    return c < 0 ? Chord() : Chord{infinity, -infinity};
  const double root = std::sqrt(std::max(0.0, b * b - a * c));
  const double far = b > 0 ? -b - root : -b + root; // no cancellation
  const double first = far / a, second = root == 0 || far == 0 ? first : c / far;
  Chord chord{std::min(first, second), std::max(first, second)};
  chord.normal_at_enter = e + chord.enter * d;
  chord.normal_at_leave = e + chord.leave * d;
  return chord;
}

/// The chord of |e + t d| < half, along one direction.
Chord slab_chord(const double e, const double d, const double half, const Vec3& normal) {
  if (d == 0)
    return std::abs(e) < half ? Chord() : Chord{infinity, -infinity};
  const double t0 = (-half - e) / d, t1 = (half - e) / d;
  return {std::min(t0, t1), std::max(t0, t1), normal, normal};
}

Chord common(const Chord& a, const Chord& b) {
  const Chord &later = a.enter > b.enter ? a : b, &earlier = a.leave < b.leave ? a : b;
  return {later.enter, earlier.leave, later.normal_at_enter, earlier.normal_at_leave};
}

enum class Side { inside, outside };

Verdict judge(const Chord& chord, const Side p, const Side q) {
  if (p != q) // the sides decide; the chord only says where
    return p == Side::inside ? Verdict{1, std::clamp(chord.leave, 0.0, 1.0), chord.normal_at_leave}
                             : Verdict{1, std::clamp(chord.enter, 0.0, 1.0), chord.normal_at_enter};
  const bool passes = p == Side::outside && chord.enter < chord.leave && chord.enter > 0 && chord.leave < 1;
  return passes ? Verdict{2, chord.enter, chord.normal_at_enter} : Verdict();
}

Verdict meet(const Plane& plane, const Segment& segment) {
  const double at_p = height_above(plane, segment[0]), at_q = height_above(plane, segment[1]);
  if ((at_p < 0) == (at_q < 0))
    return {};
  return {1, at_p / (at_p - at_q), plane.normal};
}

Verdict meet(const Disc& disc, const Segment& segment) {
  const Verdict verdict = meet(Plane{disc.centre, disc.normal}, segment);
  const auto& [p, q] = segment;
  const Vec3 from_centre = p + verdict.t * (q - p) - disc.centre;
  return verdict.n_crossings > 0 && from_centre.squaredNorm() < disc.radius * disc.radius ? verdict : Verdict();
}

Vec3 normal_of(const Rectangle& rectangle) {
  return rectangle.first_side.stableNormalized().cross(rectangle.second_side.stableNormalized()).normalized();
}

Verdict meet(const Rectangle& rectangle, const Segment& segment) {
  const Verdict verdict = meet(Plane{rectangle.centre, normal_of(rectangle)}, segment);
  const auto& [p, q] = segment;
  const Vec3 from_centre = p + verdict.t * (q - p) - rectangle.centre;
  const auto lies_between = [&](const Vec3& side) {
    return std::abs(from_centre.dot(side.stableNormalized())) < 0.5 * side.stableNorm();
  };
  const bool is_met =
    verdict.n_crossings > 0 && lies_between(rectangle.first_side) && lies_between(rectangle.second_side);
  return is_met ? verdict : Verdict();
}

Verdict meet(const Sphere& sphere, const Segment& segment) {
  const Vec3 p = segment[0] - sphere.centre, q = segment[1] - sphere.centre;
  const double r = sphere.radius;
  const auto side = [r](const Vec3& e) { return e.squaredNorm() < r * r ? Side::inside : Side::outside; };
  return judge(ball_chord(p, q - p, r), side(p), side(q));
}

Verdict meet(const Cylinder& cylinder, const Segment& segment) {
  const Vec3 &axis = cylinder.axis, p = segment[0] - cylinder.centre, q = segment[1] - cylinder.centre;
  const double r = cylinder.radius, half = 0.5 * cylinder.height, up_p = axis.dot(p), up_q = axis.dot(q);
  const Vec3 out_p = p - up_p * axis, out_q = q - up_q * axis;
  const auto side = [&](const Vec3& out, const double up) {
    return out.squaredNorm() < r * r && std::abs(up) < half ? Side::inside : Side::outside;
  };
  const Chord chord = common(ball_chord(out_p, out_q - out_p, r), slab_chord(up_p, up_q - up_p, half, axis));
  return judge(chord, side(out_p, up_p), side(out_q, up_q));
}

/// Whether the surface of a convex body, with its centre and half the size of its box, may meet a box. Inside of the
/// body nothing meets it; `depth` is how far in a corner of the box is, beyond round-off.
template <class Depth>
bool may_meet_convex(const Vec3& centre, const Vec3& half, const Box& box, const Depth& depth) {
  const Vec3 margin = Vec3::Constant(1e-9 * (half.sum() + centre.cwiseAbs().sum()));
  if (!geometry::overlap({centre - half - margin, centre + half + margin}, box))
    return false;
  const auto corners = corners_of(box);
  return !std::all_of(corners.begin(), corners.end(), [&](const Vec3& p) { return depth(p) > margin[0]; });
}

bool near(const Plane& plane, const Box& box) { return may_meet(plane.point, plane.normal, box); }

bool near(const Disc& disc, const Box& box) {
  const Vec3 reach = Vec3::Constant(disc.radius * (1 + 1e-9) + 1e-9 * disc.centre.cwiseAbs().sum());
  return geometry::overlap({disc.centre - reach, disc.centre + reach}, box) && may_meet(disc.centre, disc.normal, box);
}

bool near(const Rectangle& rectangle, const Box& box) {
  const Vec3 half = 0.5 * (rectangle.first_side.cwiseAbs() + rectangle.second_side.cwiseAbs());
  const Vec3 reach = half + Vec3::Constant(1e-9 * (half.sum() + rectangle.centre.cwiseAbs().sum()));
  return geometry::overlap({rectangle.centre - reach, rectangle.centre + reach}, box) &&
         may_meet(rectangle.centre, normal_of(rectangle), box);
}

bool near(const Sphere& sphere, const Box& box) {
  return may_meet_convex(sphere.centre, Vec3::Constant(sphere.radius), box,
                         [&](const Vec3& p) { return sphere.radius - (p - sphere.centre).norm(); });
}

bool near(const Cylinder& cylinder, const Box& box) {
  const double half = 0.5 * cylinder.height;
  const Vec3 reach = Vec3::Constant(half + cylinder.radius);
  return may_meet_convex(cylinder.centre, reach, box, [&](const Vec3& p) {
    const double up = cylinder.axis.dot(p - cylinder.centre);
    return std::min(half - std::abs(up), cylinder.radius - (p - cylinder.centre - up * cylinder.axis).norm());
  });
}

std::vector<std::array<Vec3, 3>> triangles_of(const geometry::TriangleMesh& mesh) {
  std::vector<std::array<Vec3, 3>> triangles(mesh.triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i)
    triangles[i] = geometry::corners(mesh, i);
  return triangles;
}

} // namespace

double height_above(const Plane& plane, const Vec3& p) {
  constexpr double roundoff = 4e-14; // less than boxes leave room for (may_meet.cc)
  const double height = plane.normal.dot(p - plane.point);
  return std::abs(height) < roundoff * (p.norm() + plane.point.norm()) ? 0 : height;
}

void check(const CutSurface& surface) {
  std::visit([](const auto& shape) { check_shape(shape); }, surface.shape);
}

SweepCuts cut_edges(const CutSurface& surface, const grid::Solid& solid, const Points& x,
                    const EdgeBoxes* const boxes) {
  const auto cut_by = [&](const auto& shape) {
    if constexpr (std::is_same_v<decltype(shape), const geometry::TriangleMesh&>) {
      return cut_edges(triangles_of(shape), solid, x, surface.label, boxes);
    } else {
      const Target target(solid, x, x, boxes);
      return target.cut(surface.label, {Box(), [&](const Box& box) { return near(shape, box); }},
                        [&](const Segment&, const Segment& now) { return meet(shape, now); });
    }
  };
  return std::visit(cut_by, surface.shape);
}

} // namespace kerf::cut
