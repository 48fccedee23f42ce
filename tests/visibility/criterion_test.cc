#include "visibility/criterion.h"

#include "base/error.h"
#include "base/parallel.h"
#include "geometry/predicates.h"
#include "tests/visibility/cases.h"
#include "visibility/extended.h"
#include "visibility/field.h"
#include "visibility/pair_sights.h"
#include "visibility/paths.h"

#include <gtest/gtest.h>

#include <limits>

namespace kerf::visibility::criterion_test {
namespace {

CriterionChoice choice(const std::string& name) {
  CriterionChoice c;
  c.criterion = name;
  return c;
}

pba::Sight sight(const CriterionChoice& c, const Pair& pair, const std::vector<Face>& faces,
                 const std::vector<Face>& skin = {}) {
  PairSights sights(make_criterion(c, skin));
  sights.watch(PairId(0), {&pair, 1});
  sights.add_faces(faces);
  sights.update(1);
  return sights.sights()[PairId(0)];
}

/// A pair above and below a half plane z = 0, x <= 0 (long along y): a at (-p, 0, s), b at (-q, 0, -t).
Pair across(const double p, const double s, const double q, const double t, const double support) {
  return {Vec3(-p, 0, s), Vec3(-q, 0, -t), support};
}
const std::vector<Face> half_plane = strip(-9, 0, 9, 0);

TEST(Criterion, NamesAreFour) {
  EXPECT_EQ(criteria().size(), 4u);
  for (const std::string& name : criteria())
    EXPECT_NE(make_criterion(choice(name)), nullptr);
}

TEST(Criterion, RefusesWhatItDoesNotKnow) {
  try {
    make_criterion(choice("diffusion"));
    ADD_FAILURE();
  } catch (const ParameterError& e) {
    EXPECT_EQ(e.complaint().path, "Criterion");
    EXPECT_EQ(e.complaint().value, "diffusion");
    for (const std::string& name : criteria())
      EXPECT_NE(e.complaint().rule.find(name), std::string::npos);
  }
  CriterionChoice c = choice("extended visibility");
  c.masks_by = "GPU";
  EXPECT_THROW(make_criterion(c), ParameterError);
  c = choice("extended visibility");
  c.mask_resolution = 64;
  EXPECT_THROW(make_criterion(c), ParameterError);
  c = choice("extended visibility");
  c.disk_radius = 0;
  EXPECT_THROW(make_criterion(c), ParameterError);
  c = choice("diffraction");
  c.diffraction_exponent = 0.9;
  EXPECT_THROW(make_criterion(c), ParameterError);
  c = choice("transparency");
  c.transparency_exponent = 1.9;
  EXPECT_THROW(make_criterion(c), ParameterError);
}

TEST(Criterion, DescribesItsParameters) {
  CriterionChoice c;
  Parameters p;
  c.describe(p);
  ASSERT_EQ(p.list().size(), 6u);
  for (const Parameter& parameter : p.list())
    EXPECT_EQ(parameter.check(parameter.fallback), "") << parameter.name;
  EXPECT_NE(p.list()[0].check("diffusion"), "");
}

TEST(LineOfSight, IsCutByWhatCrossesIt) {
  Random random(1);
  int n_crossed = 0;
  for (int i = 0; i < 300; ++i) {
    const Pair pair{random.vector(), random.vector(), 1};
    const Face face{random.vector(), random.vector(), random.vector()};
    const bool crossed = geometry::crosses(pair.a, pair.b, face);
    EXPECT_EQ(sight(choice("visibility"), pair, {face}), (pba::Sight{(pair.b - pair.a).norm(), crossed ? 0. : 1.}));
    n_crossed += crossed;
  }
  EXPECT_GT(n_crossed, 10);
}

TEST(Bend, IsTheShortestWayAroundAnEdge) {
  Random random(2);
  for (int i = 0; i < 300; ++i) {
    const Vec3 a = random.vector(), b = random.vector(), from = random.vector(), to = random.vector();
    const auto length = [&](const Vec3& x) { return (x - a).norm() + (x - b).norm(); };
    const Vec3 x = bend(a, b, from, to);
    double shortest = 1e9;
    for (int k = 0; k <= 1000; ++k)
      shortest = std::min(shortest, length(from + k / 1000. * (to - from)));
    EXPECT_LE(length(x), shortest + 1e-14);
    EXPECT_NEAR(length(x), shortest, 1e-4);
    EXPECT_NEAR((x - from).norm() + (to - x).norm(), (to - from).norm(), 1e-14);
  }
  EXPECT_EQ(bend({1, 0, 0}, {3, 0, 0}, {0, 0, 0}, {2, 0, 0}), Vec3(1, 0, 0));
}

TEST(Diffraction, GoesAroundTheFront) {
  for (const double gamma : {1., 2.}) {
    CriterionChoice c = choice("diffraction");
    c.diffraction_exponent = gamma;
    const Pair pair = across(0.3, 0.4, 0.05, 0.12, 5);
    const double s0 = std::hypot(0.25, 0.52), around = 0.5 + 0.13;
    EXPECT_NEAR(sight(c, pair, half_plane).distance, std::pow(around / s0, gamma) * s0, 1e-12);
    EXPECT_EQ(sight(c, pair, half_plane).factor, 1);
    // In front of the front the way is straight.
    const Pair free = across(-0.3, 0.4, -0.05, 0.12, 5);
    EXPECT_EQ(sight(c, free, half_plane), (pba::Sight{s0, 1}));
  }
}

TEST(Diffraction, CutsOffWhereNoWayIsShortEnough) {
  EXPECT_EQ(sight(choice("diffraction"), across(0.3, 0.4, 0.3, 0.4, 1.01), half_plane).factor, 1);
  EXPECT_EQ(sight(choice("diffraction"), across(0.3, 0.4, 0.3, 0.4, 0.99), half_plane).factor, 0);
  // The box around the ways that are short enough holds the front, the ways do not.
  EXPECT_EQ(sight(choice("diffraction"), across(0.5, 0.3, 0.1, 0.3, 0.90), half_plane).factor, 1);
  EXPECT_EQ(sight(choice("diffraction"), across(0.5, 0.3, 0.1, 0.3, 0.89), half_plane).factor, 0);
}

TEST(Diffraction, GoesTheSecondWayWhenTheFirstIsBlocked) {
  const Pair pair = across(1, 0.5, 1, 0.5, 9);
  const std::vector<Face> cut = strip(-3, 0, 9, 0);
  EXPECT_NEAR(sight(choice("diffraction"), pair, cut).distance, 2 * std::hypot(1, 0.5), 1e-12);
  // The way around x = 0 is shut by a wall on the front itself, or before it; the way around x = -3 is open.
  for (const double x : {0., -0.5})
    for (const double side : {-1., 1.}) {
      std::vector<Face> faces = cut;
      const double from = x == 0 ? -9 : 0.05;
      faces.push_back({Vec3(x, -9, side * from), Vec3(x, 9, side * from), Vec3(x, 0, side * 9)});
      EXPECT_NEAR(sight(choice("diffraction"), pair, faces).distance, 2 * std::hypot(2, 0.5), 1e-12);
    }
}

TEST(Transparency, LengthensByTheDepthBehindTheFront) {
  for (const double gamma : {2., 3.}) {
    CriterionChoice c = choice("transparency");
    c.transparency_exponent = gamma;
    // The segment meets the plane at x = -0.1; s_0 = 0.5.
    const Pair pair = across(0.1, 0.2, 0.1, 0.3, 0.8);
    EXPECT_NEAR(sight(c, pair, half_plane).distance, 0.5 + 0.8 * std::pow(0.1 / 0.5, gamma), 1e-12);
    EXPECT_EQ(sight(c, pair, half_plane).factor, 1);
    EXPECT_EQ(sight(c, across(0.51, 0.2, 0.51, 0.3, 0.8), half_plane).factor, 0);
    EXPECT_EQ(sight(c, across(-0.1, 0.2, -0.1, 0.3, 0.8), half_plane), (pba::Sight{0.5, 1}));
  }
}

TEST(Transparency, FrontsOfOtherSheetsDoNotCount) {
  std::vector<Face> faces = half_plane;
  // A crack of its own, that ends beside where the segment meets the half plane.
  const std::vector<Face> other = strip(-0.29, -0.2, 9, 0.01);
  faces.insert(faces.end(), other.begin(), other.end());
  const Pair pair = across(0.3, 0.2, 0.3, 0.3, 0.8);
  const double behind_half_plane = 0.5 + 0.8 * 0.36;
  EXPECT_NEAR(sight(choice("transparency"), pair, faces).distance, behind_half_plane, 1e-12);
}

TEST(Extended, KeepsOneMaskOf128BytesAPair) {
  const MaskShape shape(32, 0.5);
  ExtendedVisibility extended(shape, nullptr);
  const std::vector<Pair> pairs(7, Pair{Vec3::Zero(), Vec3::Ones(), 1});
  extended.watch(PairId(0), pairs);
  EXPECT_EQ(extended.mask(PairId(3)).size_bytes(), 128u);
  EXPECT_EQ(extended.mask(PairId(3)).data() - extended.mask(PairId(2)).data(), 32);
}

/// (2.39): what is open of the disk, here a circular segment; (2.38) to the size of a texel.
TEST(Extended, IsTheOpenShareOfTheDisk) {
  // The disk of radius 0.2 stands in z = 0.1; from a the plane's border appears at x = 0.05 * 2 in it.
  const Pair pair{Vec3(0, 0, -0.1), Vec3(0, 0, 0.3), 1};
  const double chord = 0.5, expected = 1 - (std::acos(-chord) + chord * std::sqrt(1 - chord * chord)) / M_PI;
  EXPECT_NEAR(sight(choice("extended visibility"), pair, strip(-9, 0.05, 9, 0)).factor, expected, 0.015);
}

TEST(Extended, OpenGlGivesAboutTheSame) {
  CriterionChoice by_gl = choice("extended visibility");
  by_gl.masks_by = "OpenGL";
  const Pair pair{Vec3(0.02, 0.01, -0.1), Vec3(0, 0, 0.3), 1};
  const pba::Sight cpu = sight(choice("extended visibility"), pair, strip(-9, 0.05, 9, 0)),
                   gl = sight(by_gl, pair, strip(-9, 0.05, 9, 0));
  EXPECT_NEAR(cpu.factor, gl.factor, 2e-3);
  EXPECT_LT(cpu.factor, 0.9);
}

/// The way the two points are named does not matter, up to the texels that the turned raster samples otherwise.
TEST(Extended, IsSymmetric) {
  Random random(5);
  for (int i = 0; i < 100; ++i) {
    const Pair pair{random.vector(), random.vector(), 5}, reversed{pair.b, pair.a, 5};
    std::vector<Face> faces;
    for (int k = 0; k < 3; ++k)
      faces.push_back({random.vector(), random.vector(), random.vector()});
    EXPECT_NEAR(sight(choice("extended visibility"), pair, faces).factor,
                sight(choice("extended visibility"), reversed, faces).factor, 0.03);
  }
}

/// The six sides of a box.
std::vector<Face> skin_of(const Box& box) {
  std::vector<Face> faces;
  for (int axis = 0; axis < 3; ++axis)
    for (const Vec3& from : {box.lower, box.upper}) {
      const Vec3 sides = box.upper - box.lower;
      Vec3 u = Vec3::Zero(), v = Vec3::Zero();
      const double sign = from == box.lower ? 1 : -1;
      u[(axis + 1) % 3] = sign * sides[(axis + 1) % 3];
      v[(axis + 2) % 3] = sign * sides[(axis + 2) % 3];
      faces.push_back({from, from + u, from + u + v});
      faces.push_back({from, from + u + v, from + v});
    }
  return faces;
}

/// The texels of a disk inside of a box, and those of them that faces occlude, by their definitions.
std::pair<int, int> inside_and_occluded(const Pair& pair, const Box& box, const std::vector<Face>& faces) {
  const MaskShape shape(32, 0.5);
  std::vector<std::uint32_t> occluded = ray_tested(pair, shape, faces);
  const Disk disk = make_disk(pair, shape);
  int n = 0;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x)
      if (shape.disk()[y] >> x & 1 && box.contains(texel_middle(disk, shape, x, y)))
        ++n;
      else
        occluded[y] &= ~(1u << x);
  return {n, count(occluded)};
}

/// A cut that ends inside of a thin plate, random pairs: the share of what is inside.
TEST(Extended, CountsOnlyTexelsInTheBody) {
  const Box plate{Vec3(-1, 0, -1), Vec3(1, 0.2, 1)};
  const std::vector<Face> skin = skin_of(plate), cut = strip(-1, 0.02, 0.3, 0);
  Random random(6);
  int n_out = 0, n_changed = 0;
  for (int i = 0; i < 300; ++i) {
    Pair pair{Vec3::Zero(), Vec3::Zero(), 1};
    for (Vec3* const p : {&pair.a, &pair.b})
      *p = Vec3(0.2 * random.number() - 0.1, 0.2 * random.number(), 0.4 * random.number() - 0.2);
    const auto [n_inside, n_occluded] = inside_and_occluded(pair, plate, cut);
    const double factor = sight(choice("extended visibility"), pair, cut, skin).factor;
    EXPECT_NEAR(factor, 1 - n_occluded / double(n_inside), 4. / n_inside);
    n_out += n_inside < MaskShape(32, 0.5).n_texels();
    n_changed += factor < 0.99;
  }
  EXPECT_GT(n_out, 100);
  EXPECT_GT(n_changed, 100);
}

/// However near the skin: what the cut parts wherever there is a body has no bond, which the whole disk would keep.
TEST(Extended, ACutUpToTheSkinLeavesNothing) {
  const Box plate{Vec3(-1, 0, -1), Vec3(1, 0.2, 1)};
  const std::vector<Face> skin = skin_of(plate);
  std::vector<Face> cut = strip(-1, 1, 0.1, 0);
  for (Face& face : cut)
    for (Vec3& corner : face)
      corner[1] += 0.1;
  for (const double y : {0.001, 0.03, 0.1, 0.17})
    for (const std::string by : {"CPU", "OpenGL"}) {
      const Pair pair{Vec3(-0.95, y, 0.11), Vec3(-0.9, y + 0.02, -0.12), 1};
      CriterionChoice c = choice("extended visibility");
      c.masks_by = by;
      EXPECT_EQ(sight(c, pair, cut, skin).factor, 0) << y << ' ' << by;
      EXPECT_GT(sight(c, pair, cut).factor, 0) << y << ' ' << by;
    }
}

/// Two points that see each other across a gap alone: the whole disk, as without a body.
TEST(Extended, PairsAcrossAGapKeepTheirDisk) {
  std::vector<Face> skin = skin_of({Vec3(-1, -1, 0.1), Vec3(1, 1, 1)});
  for (const Face& face : skin_of({Vec3(-1, -1, -1), Vec3(1, 1, -0.1)}))
    skin.push_back(face);
  const Pair pair{Vec3(0, 0, 0.2), Vec3(0.01, 0.02, -0.2), 1};
  const std::vector<Face> cut = strip(-1, 0.05, 1, 0.15);
  const pba::Sight without = sight(choice("extended visibility"), pair, cut);
  EXPECT_EQ(sight(choice("extended visibility"), pair, cut, skin), without);
  EXPECT_GT(without.factor, 0);
  EXPECT_LT(without.factor, 0.5);
}

TEST(AllCriteria, SeparateWhatIsCutThrough) {
  for (const std::string& name : criteria()) {
    EXPECT_EQ(sight(choice(name), across(0.1, 0.2, 0.3, 0.1, 2), strip(-9, 9, 9, 0)).factor, 0) << name;
    // In the plane of the disk: nothing may slip through between the two projections.
    EXPECT_EQ(sight(choice(name), across(0.1, 0.2, 0.3, 0.2, 2), strip(-9, 9, 9, 0)).factor, 0) << name;
  }
}

TEST(AllCriteria, PointsInOnePlaceSeeEachOther) {
  for (const std::string& name : criteria()) {
    const Vec3 p(0.1, 0.2, 0);
    EXPECT_EQ(sight(choice(name), {p, p, 1}, strip(-9, 9, 9, 0)), (pba::Sight{0, 1})) << name;
  }
}

TEST(AllCriteria, RefusePairsThatAreNowhere) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const std::string& name : criteria()) {
    PairSights sights(make_criterion(choice(name)));
    for (const Pair& pair : {Pair{Vec3(nan, 0, 0), Vec3::Zero(), 1}, Pair{Vec3::Zero(), Vec3::Ones(), 0},
                             Pair{Vec3::Zero(), Vec3::Ones(), nan}})
      EXPECT_THROW(sights.watch(PairId(0), {&pair, 1}), NumericalError);
    EXPECT_EQ(sights.pairs().size(), 0u);
  }
}

} // namespace
} // namespace kerf::visibility::criterion_test
