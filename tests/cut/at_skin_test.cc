/// Blades that reach the skin of a body: what comes free, and how large it is.

#include "tests/cut/patient.h"
#include "tests/support/clipped_box.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <iostream>
#include <limits>

namespace kerf::cut::at_skin_test {
namespace {

struct Study {
  int n = 0, n_exact = 0, n_other_count = 0;
  double worst_exact = 0, worst_other = 0, worst_total = 0; ///< of the whole body
};

std::ostream& operator<<(std::ostream& out, const Study& s) {
  return out << s.n << " blades, " << s.n_exact << " of them where the plane is exact: error of a piece there "
             << s.worst_exact << ", elsewhere from the plane's " << s.worst_other
             << " of the body; other number of pieces " << s.n_other_count << " times; total within " << s.worst_total;
}

Mat3 random_gradient(Random& random) {
  Mat3 F = Mat3::Identity();
  do {
    F = Mat3::Identity();
    for (int axis = 0; axis < 3; ++axis)
      F.col(axis) += 0.3 * support::random_vector(random);
  } while (F.determinant() < 0.2);
  return F;
}

struct Slice {
  Body body;
  Vec3 through, normal;

  support::Plane plane() const { return {normal, normal.dot(through)}; }
  /// As a plane without an end cuts it.
  Patient cut_at_once() const {
    Patient patient{body};
    patient.cut_through(Plane{through, normal});
    return patient;
  }
};

/// A box and a plane near its middle; the first nine along the axes.
Slice random_slice(Random& random, const int i) {
  Slice slice{box_body(random), {}, i < 9 ? Vec3(Vec3::Unit(i % 3)) : random_direction(random)};
  slice.through = 0.5 * (box.lower + box.upper) + 0.08 * support::random_vector(random);
  return slice;
}

/// Compares a body that a blade has passed right through with the plane at once, and where that is exact, with the
/// truth.
void compare(Study& study, const Patient& passed, const Slice& slice) {
  const auto expected = slice.cut_at_once().volumes(), found = passed.volumes();
  const double below = support::volume_below(box, slice.plane()), exact = std::min(below, box_volume - below);
  EXPECT_TRUE(passed.is_as_built());
  ++study.n;
  study.n_other_count += found.size() != expected.size();
  study.worst_total = std::max(study.worst_total, std::abs(total(found) / box_volume - 1));
  study.worst_other = std::max(study.worst_other, largest_difference(found, expected) / box_volume);
  if (expected.size() == 2 && std::abs(expected[0] - exact) < 1e-12 * box_volume) {
    ++study.n_exact;
    study.worst_exact = std::max(study.worst_exact, std::abs(found[0] - exact) / box_volume);
  }
}

void expect_the_plane(const Study& study) {
  std::cout << study << '\n';
  EXPECT_EQ(study.n_other_count, 0);
  EXPECT_EQ(study.n_exact, study.n);
  EXPECT_LT(study.worst_exact, 1e-12);
  EXPECT_LT(study.worst_other, 1e-12);
  EXPECT_LT(study.worst_total, 1e-12);
}

class Passes : public testing::TestWithParam<Release> {};

/// In 1 to 150 steps, at every tilt: what the plane at once gives, exact where that is.
TEST_P(Passes, OfAFlatBladeAreThePlane) {
  Random random(101);
  Study study;
  for (int i = 0; i < 160; ++i) {
    const Slice slice = random_slice(random, i);
    const Frame frame = across(slice.normal, uniform(random, 0, 6.3));
    Patient patient{slice.body};
    patient.pass(straight(slice.through, frame.u, frame.v, 2, 2), steps(i), GetParam());
    compare(study, patient, slice);
  }
  expect_the_plane(study);
}

/// An affine map takes the plane to a plane.
TEST_P(Passes, AreTheSameInABodyThatIsStretchedAndSheared) {
  Random random(102);
  Study study;
  for (int i = 0; i < 160; ++i) {
    const Slice slice = random_slice(random, i);
    const Mat3 F = random_gradient(random);
    const Vec3 shift = support::random_vector(random);
    const Map map = [&](const Vec3& p) -> Vec3 { return F * p + shift; };
    const Frame frame = across((F.transpose().inverse() * slice.normal).normalized(), uniform(random, 0, 6.3));
    Patient patient{slice.body};
    patient.deform(map);
    patient.pass(straight(map(slice.through), frame.u, frame.v, 4, 4), steps(i), GetParam());
    compare(study, patient, slice);
  }
  expect_the_plane(study);
}

constexpr double radius = 0.41;

Body ball_body(Random& random) {
  return support::embedded(geometry::sphere_mesh(radius, Vec3::Zero(), 4), h, random_offset(random));
}

/// On skins that are not flat.
TEST_P(Passes, OfBallAndLiverAreThePlane) {
  Random random(103);
  const Body liver = support::embedded(support::liver_mesh(), 0.014, Vec3::Constant(0.4));
  double worst = 0;
  for (int i = 0; i < 60; ++i) {
    const bool is_ball = i % 3 != 0;
    Slice slice{is_ball ? ball_body(random) : liver, 0.1 * support::random_vector(random), random_direction(random)};
    if (!is_ball)
      slice.through = slice.body.grid.position(
        grid::NodeId(std::uniform_int_distribution<std::size_t>(0, slice.body.grid.n_nodes() - 1)(random)));
    const Frame frame = across(slice.normal, uniform(random, 0, 6.3));
    Patient patient{slice.body};
    patient.pass(straight(slice.through, frame.u, frame.v, 2, 2), steps(i / 3), GetParam());
    const auto expected = slice.cut_at_once().volumes(), found = patient.volumes();
    EXPECT_EQ(found.size(), expected.size()) << i;
    worst = std::max(worst, largest_difference(expected, found) / std::pow(slice.body.grid.h(), 3));
    EXPECT_NEAR(total(found) / total(expected), 1, 1e-12);
  }
  std::cout << "from the plane's " << worst << " h^3\n";
  EXPECT_LT(worst, 1e-9);
}

/// Around each side of a cell's material, of skin or between cells, what goes right through is met an even number of
/// times: nothing leaks, and no end has to be guessed.
TEST_P(Passes, MeetEachSideEvenly) {
  Random random(104);
  const Body liver = support::embedded(support::liver_mesh(), 0.014, Vec3::Constant(0.4));
  std::size_t n_met = 0, n_of_skin = 0, n_odd = 0;
  for (int i = 0; i < 45; ++i) {
    Slice slice = random_slice(random, i);
    if (i % 3 != 0)
      slice = {i % 3 == 1 ? ball_body(random) : liver, 0.1 * support::random_vector(random), random_direction(random)};
    const Frame frame = across(slice.normal, uniform(random, 0, 6.3));
    Patient patient{slice.body};
    patient.pass(straight(slice.through, frame.u, frame.v, 2, 2), steps(i / 3), GetParam());
    for (const auto c : ids<grid::CellId>(patient.body.grid.n_cells())) {
      const grid::Segments met = grid::cut_by(patient.body, c, 1);
      const grid::Skeleton& skeleton = grid::cuts_of(patient.body, c).skeleton();
      for (grid::Sides left = met != 0 ? skeleton.sides : 0; left != 0; left &= left - 1) {
        const int side = std::countr_zero(left);
        int n = 0;
        for (int k = 0; k < skeleton.side[side].n; ++k)
          n += static_cast<int>(met >> skeleton.side[side].segments[k] & 1);
        n_met += n > 0;
        n_of_skin += n > 0 && side >= grid::skeleton::first_triangle;
        n_odd += n % 2;
      }
    }
  }
  std::cout << n_met << " sides are met, " << n_of_skin << " of them of skin\n";
  EXPECT_GT(n_of_skin, 1000u);
  EXPECT_EQ(n_odd, 0u);
}

/// Bent about the y axis, after a twist about x [1/m, rad/m].
struct Bend {
  double curvature, twist;
  Vec3 operator()(const Vec3& p) const {
    const Vec3 q = p - 0.5 * (box.lower + box.upper);
    const double a = twist * q[0], y = std::cos(a) * q[1] - std::sin(a) * q[2];
    const double r = 1 / curvature + std::sin(a) * q[1] + std::cos(a) * q[2], angle = curvature * q[0];
    return {r * std::sin(angle), y, r * std::cos(angle) - 1 / curvature};
  }
};

/// Volume at rest of what is below a plane in a body that is deformed now, by midpoints [m^3].
double volume_below(const Map& map, const Vec3& through, const Vec3& normal) {
  constexpr int n = 48;
  const Vec3 size = (box.upper - box.lower) / n;
  const auto height = [&](const Vec3& p) { return normal.dot(map(p) - through); };
  double sum = 0;
  for (int k = 0; k < n * n * n; ++k) {
    const Vec3 p = box.lower + size.cwiseProduct(Vec3(k % n + 0.5, k / n % n + 0.5, k / n / n + 0.5));
    double reach = 0; // of heights in the small box
    for (int axis = 0; axis < 3; ++axis)
      reach +=
        std::abs(height(p + 0.5 * size[axis] * Vec3::Unit(axis)) - height(p - 0.5 * size[axis] * Vec3::Unit(axis)));
    sum += std::clamp(0.5 - height(p) / reach, 0.0, 1.0);
  }
  return sum * size.prod();
}

/// The flat blade is bent in the body at rest, and yet parts it in two; the pieces are right to a part of a cell.
TEST_P(Passes, PartABodyThatIsBentAndTwistedInTwo) {
  Random random(104);
  double worst = 0, sum = 0, from_truth = 0;
  constexpr int n = 200;
  for (int i = 0; i < n; ++i) {
    const Slice slice = random_slice(random, i);
    const Bend map{uniform(random, 0.2, 2), uniform(random, -2, 2)};
    const Frame frame = across(slice.normal, uniform(random, 0, 6.3));
    const Vec3 through = map(slice.through);
    Patient patient{slice.body}, known{slice.body};
    patient.deform(map);
    known.deform(map);
    known.cut_through(Plane{through, slice.normal});
    patient.pass(straight(through, frame.u, frame.v, 2, 2), steps(i), GetParam());
    const auto expected = known.volumes(), found = patient.volumes();
    EXPECT_EQ(found.size(), 2u) << i;
    EXPECT_EQ(expected.size(), 2u) << i;
    EXPECT_NEAR(total(found), box_volume, 1e-12 * box_volume);
    const double difference = largest_difference(found, expected);
    worst = std::max(worst, difference / cube);
    sum += difference / cube / n;
    if (i < 40) {
      const double below = volume_below(map, through, slice.normal);
      from_truth = std::max(from_truth, std::abs(found[0] - std::min(below, box_volume - below)) / cube);
    }
  }
  std::cout << "from the plane at once: mean " << sum << " h^3, at most " << worst << "; from the truth at most "
            << from_truth << " h^3\n";
  EXPECT_LT(sum, 0.08);
  EXPECT_LT(worst, 0.6);
  EXPECT_LT(from_truth, 0.7);
}

INSTANTIATE_TEST_SUITE_P(AtSkin, Passes, testing::Values(Release::at_once, Release::queued),
                         [](const auto& info) { return info.param == Release::at_once ? "AtOnce" : "Queued"; });

/// How far the plane's section of the box reaches along v.
double far_end(const support::Plane& plane, const Vec3& v) {
  double far = -std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis)
    for (int k = 0; k < 4; ++k) {
      Vec3 p = box.lower;
      for (int i = 0; i < 2; ++i)
        if (const int other = (axis + 1 + i) % 3; k >> i & 1)
          p[other] = box.upper[other];
      Vec3 q = p;
      q[axis] = box.upper[axis];
      const double a = plane.height(p), b = plane.height(q);
      if ((a < 0) != (b < 0))
        far = std::max(far, v.dot(p + a / (a - b) * (q - p)));
    }
  return far;
}

/// A blade that stops outside, however near the skin, has parted what it passed.
TEST(AtSkin, ABladeThatStopsJustOutsideParts) {
  Random random(105);
  for (const double beyond : {1e-6, 0.01, 0.1, 0.5, 1.0})
    for (int i = 0; i < 60; ++i) {
      const Slice slice = random_slice(random, i);
      const Frame frame = across(slice.normal, uniform(random, 0, 6.3));
      const double stop = far_end(slice.plane(), frame.v) + beyond * h - frame.v.dot(slice.through);
      Patient patient{slice.body};
      patient.pass(straight(slice.through, frame.u, frame.v, 2, stop), steps(i),
                   i % 3 == 0 ? Release::queued : Release::at_once);
      const auto found = patient.volumes(), expected = slice.cut_at_once().volumes();
      EXPECT_EQ(found.size(), expected.size()) << beyond << ' ' << i;
      EXPECT_LT(largest_difference(found, expected), 1e-12 * box_volume);
    }
}

/// A blade that ends below the skin, however little, never parts it.
TEST(AtSkin, ABladeThatStopsInsideDoesNotPart) {
  Random random(106);
  for (const double depth : {1e-6, 1e-3, 0.25, 0.5, 0.75, 1.001, 1.5, 2.5}) {
    int n_parted = 0;
    constexpr int n = 90;
    for (int i = 0; i < n; ++i) {
      const Body body = box_body(random);
      const int axis = i % 3;
      const double angle = uniform(random, 0, 6.3);
      const Vec3 v = Vec3::Unit(axis),
                 normal = std::cos(angle) * Vec3::Unit((axis + 1) % 3) + std::sin(angle) * Vec3::Unit((axis + 2) % 3);
      const Vec3 through = 0.5 * (box.lower + box.upper) + 0.04 * support::random_vector(random);
      Patient patient{body};
      patient.pass(straight(through, normal.cross(v), v, 2, box.upper[axis] - depth * h - through[axis]), steps(i),
                   i % 2 == 0 ? Release::queued : Release::at_once);
      n_parted += patient.volumes().size() > 1;
    }
    EXPECT_EQ(n_parted, 0) << "of " << n << " that end " << depth << " h below the skin";
  }
}

/// How far a plane's section of the skin reaches along v [m].
double far_end(const Body& body, const support::Plane& plane, const Vec3& v) {
  const surface::Surface skin = surface::build_surface(body);
  double far = -std::numeric_limits<double>::infinity();
  for (const auto& triangle : skin.triangles)
    for (int k = 0; k < 3; ++k) {
      const Vec3 &p = skin.rest[triangle[k]], &q = skin.rest[triangle[(k + 1) % 3]];
      const double a = plane.height(p), b = plane.height(q);
      if ((a < 0) != (b < 0))
        far = std::max(far, v.dot(p + a / (a - b) * (q - p)));
    }
  return far;
}

/// Nor where the skin is round, or is met askew.
TEST(AtSkin, ABladeThatStopsInsideAskewDoesNotPart) {
  Random random(108);
  for (const double depth : {0.05, 0.3, 0.6, 1.1}) {
    int n_parted = 0;
    constexpr int n = 60;
    for (int i = 0; i < n; ++i) {
      Patient patient{i % 2 == 0 ? ball_body(random) : box_body(random)};
      const Body& body = patient.body;
      grid::NodeId node(random() % body.grid.n_nodes());
      while (!body.grid.is_material(node))
        node = grid::NodeId(random() % body.grid.n_nodes());
      const Vec3 normal = random_direction(random), through = body.grid.position(node);
      const Frame frame = across(normal, uniform(random, 0, 6.3));
      const double stop = far_end(body, {normal, normal.dot(through)}, frame.v) - depth * h - frame.v.dot(through);
      patient.pass(straight(through, frame.u, frame.v, 2, stop), steps(i), Release::queued);
      n_parted += patient.volumes().size() > 1;
    }
    EXPECT_EQ(n_parted, 0) << "of " << n << " that end " << depth << " h below the skin";
  }
}

/// Area of what a label has cut open, by one of its two lips [m^2].
double lip_area(const Patient& patient, const grid::CutLabel label) {
  const auto surface = surface::build_surface(patient.body);
  double area = 0;
  for (std::size_t i = 0; i < surface.triangles.size(); ++i)
    if (const auto& [a, b, c] = surface.triangles[i]; surface.labels[i] == label)
      area += 0.25 * (surface.rest[b] - surface.rest[a]).cross(surface.rest[c] - surface.rest[a]).norm();
  return area;
}

/// Under the skin, at less than a cell: attached at the front, free when the blade goes on.
TEST(AtSkin, AShallowFlapIsAttachedAtTheFrontOfItsCut) {
  Random random(107);
  const Vec3 size = box.upper - box.lower;
  for (int i = 0; i < 60; ++i) {
    const double depth = h * uniform(random, 0.05, 0.95), at = uniform(random, 0.2, 0.5);
    const Vec3 on_plane{0, 0.5 * size[1], size[2] - depth};
    Patient patient{box_body(random)};
    const Release release = i % 2 == 0 ? Release::queued : Release::at_once;
    patient.pass(straight(on_plane, Vec3::UnitY(), Vec3::UnitX(), 1, at), steps(i), release);
    ASSERT_EQ(patient.volumes().size(), 1u) << depth / h << ' ' << i;
    EXPECT_NEAR(lip_area(patient, 1), at * size[1], 1.001 * h * size[1]) << depth / h << ' ' << i;
    patient.pass(straight(on_plane + at * Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitX(), 1, 1), steps(i), release);
    const auto volumes = patient.volumes();
    ASSERT_EQ(volumes.size(), 2u) << depth / h << ' ' << i;
    EXPECT_NEAR(volumes[0], depth * size[0] * size[1], 1e-12 * box_volume);
  }
}

} // namespace
} // namespace kerf::cut::at_skin_test
