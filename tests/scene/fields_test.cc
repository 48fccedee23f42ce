// Fields in a run's files: of known states, at corners and vertices, before and after a cut.

#include "scene/fields.h"
#include "base/error.h"
#include "output/h5_array.h"
#include "tests/scene/trials.h"

namespace kerf::scene::fields_test {
namespace {

constexpr double E = 1e5, nu = 0.3, strain = 100 / E; // a bar drawn by 100 Pa along x

std::string drawn_bar(const std::string& more) {
  return steps(1, 2) +
         section("Body bar", bar_keys(5) + statics(),
                 material(E, nu, "small strain") + sliding_end() +
                   section("Traction pull", box("0.99, -1, -1", "1.1, 1, 1") + Keys{"Traction [N/m^2] = 100; 0; 0"})) +
         section("Output", {"Frames every [1] = 1", "Fields = displacement, strain, stress, von Mises stress"}) + more;
}

const output::Field& field(const std::vector<output::Field>& fields, const std::string& name) {
  for (const output::Field& f : fields)
    if (f.name == name)
      return f;
  throw std::runtime_error("no field " + name);
}

/// Values of a tensor field far from the ends: at 0.2 m the clamp still disturbs the stress by 0.051 %.
void expect_uniaxial(const std::vector<output::Field>& fields, const Points& rest) {
  const double T[] = {100, 0, 0, 0, 0, 0}, S[] = {strain, -nu * strain, -nu * strain, 0, 0, 0};
  std::size_t n = 0;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    if (rest[i][0] < 0.2 || rest[i][0] > 0.8)
      continue;
    ++n;
    for (int k = 0; k < 6; ++k) {
      EXPECT_NEAR(field(fields, "stress").values[6 * i + k], T[k], 0.06);
      EXPECT_NEAR(field(fields, "strain").values[6 * i + k], S[k], 1e-6);
    }
    EXPECT_NEAR(field(fields, "von_mises_stress").values[i], 100, 0.1);
    EXPECT_NEAR(field(fields, "displacement").values[3 * i], strain * (rest[i][0] - 0.00004), 2e-6);
    EXPECT_NEAR(field(fields, "displacement").values[3 * i + 1], -nu * strain * (rest[i][1] - 0.1), 1e-6);
  }
  EXPECT_GT(n, 100u);
}

TEST(Fields, OfABarInUniaxialStressAreInItsFrames) {
  const Trial bar(drawn_bar(""));
  const output::Frame frame = bar.reader().frame("bar", 1);
  ASSERT_EQ(frame.fields.size(), 4u);
  expect_uniaxial(frame.fields, bar.reader().complex("bar", 0).rest_positions);
  EXPECT_EQ(field(frame.fields, "stress").unit, "Pa");
  for (const double value : bar.reader().frame("bar", 0).fields[2].values)
    EXPECT_NEAR(value, 0, 1e-8) << "at rest";
}

TEST(Fields, OfVerticesAreThoseOfCornersWeighted) {
  const Trial bar(drawn_bar(""));
  const auto names = bar.world.fields;
  const auto fields = at_vertices(bar.body().surface, fields_at_corners(bar.body(), names));
  expect_uniaxial(fields, bar.body().surface.rest);
  const auto& u = field(fields, "displacement").values;
  for (std::size_t i = 0; i < positions(bar.body()).size(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(u[3 * i + axis], positions(bar.body())[i][axis] - bar.body().surface.rest[i][axis], 1e-14);
}

/// All six components, each another number: a linear motion by hand.
TEST(Fields, OfALinearMotionHaveTheirOrder) {
  World world = world_of(drawn_bar(""));
  Body& body = world.bodies[0];
  Mat3 G;
  G << 0.01, 0.03, 0.05, 0.01, -0.02, 0.02, -0.01, 0.04, 0.005;
  for (std::size_t c = 0; c < body.state.x.size(); ++c)
    body.state.x[c] += G * body.physics->rest()[c];
  follow(body);
  const double expected[] = {0.01, -0.02, 0.005, 0.02, 0.03, 0.02}; // xx, yy, zz, xy, yz, xz
  const double lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), mu = E / (2 * (1 + nu)), trace = -0.005;
  for (const auto& fields :
       {fields_at_corners(body, world.fields), at_vertices(body.surface, fields_at_corners(body, world.fields))})
    for (std::size_t i = 0; 6 * i < fields[1].values.size(); ++i)
      for (std::size_t k = 0; k < 6; ++k) {
        EXPECT_NEAR(field(fields, "strain").values[6 * i + k], expected[k], 1e-10);
        EXPECT_NEAR(field(fields, "stress").values[6 * i + k], 2 * mu * expected[k] + (k < 3 ? lambda * trace : 0),
                    1e-5);
      }
}

/// Notched after the first step: the fields have a row for each of the new corners, and know of the free faces.
TEST(Fields, FollowACut) {
  const Trial bar(drawn_bar(section("Surface file", {"Every [1] = 1"}) +
                            section("Cut surface knife", {"Time [s] = 1", "Shape = disc", "Point [m] = 0.5, 0.1, 0.2",
                                                          "Normal [1] = 1, 0, 0", "Radius [m] = 0.1"})));
  const output::Frame before = bar.reader().frame("bar", 1), after = bar.reader().frame("bar", 2);
  const auto complex = bar.reader().complex("bar", after.complex);
  EXPECT_GT(after.positions.size(), before.positions.size());
  const auto& stress = field(after.fields, "stress").values;
  ASSERT_EQ(stress.size(), 6 * after.positions.size());
  double most = 0, least = 1e9; // along x: beside the notch, and at its mouth
  for (std::size_t i = 0; i < after.positions.size(); ++i) {
    const Vec3& X = complex.rest_positions[i];
    if (std::abs(X[0] - 0.5) < 0.05 && X[2] < 0.2 && X[2] > 0 && X[1] > 0 && X[1] < 0.2) {
      most = std::max(most, stress[6 * i]);
      least = std::min(least, stress[6 * i]);
    }
  }
  EXPECT_GT(most, 115) << "what is left carries all";
  EXPECT_LT(least, 40) << "free faces carry nothing along x";
  EXPECT_TRUE(std::filesystem::exists(bar.path("surface_bar.vtkhdf")));
}

/// As the format wants it: a row a vertex for each step, found by the offsets of its name.
TEST(Fields, OfTheSurfaceFileAreFoundByTheirOffsets) {
  const Trial bar(drawn_bar(section("Surface file", {"Every [1] = 1"})));
  const auto root = output::h5::open_read_only(bar.path("surface_bar.vtkhdf"));
  const auto offsets = output::h5::read_vector<std::int64_t>(root, "/VTKHDF/Steps/PointDataOffsets/stress");
  const std::size_t n = bar.body().surface.rest.size();
  EXPECT_EQ(offsets, (std::vector<std::int64_t>{0, std::int64_t(n), std::int64_t(2 * n)}));
  const auto values = output::h5::read_vector<float>(root, "/VTKHDF/PointData/stress");
  ASSERT_EQ(values.size(), 3 * 6 * n);
  const auto expected = at_vertices(bar.body().surface, fields_at_corners(bar.body(), {"stress"}));
  for (std::size_t k = 0; k < 6 * n; ++k) {
    EXPECT_NEAR(values[k], 0, 1e-8) << "at rest";
    EXPECT_FLOAT_EQ(values[2 * 6 * n + k], static_cast<float>(expected[0].values[k]));
  }
  EXPECT_EQ(output::h5::text_attribute(output::h5::open_dataset(root, "/VTKHDF/PointData/stress"), "unit"), "Pa");
}

TEST(Fields, OfOtherBackendsAreDisplacementsOnly) {
  for (const std::string backend : {"pba", "lattice", "mass-spring"}) {
    const std::string body = section("Body cube", cube_keys() + Keys{"Backend = " + backend}, material(1e4, 0.25));
    const Trial cube(steps(0.01, 2) + body + section("Gravity", {}) + section("Output", {"Fields = displacement"}));
    const auto frame = cube.reader().frame("cube", 1);
    ASSERT_EQ(frame.fields.size(), 1u);
    for (std::size_t c = 0; c < frame.positions.size(); ++c)
      EXPECT_NEAR(frame.fields[0].values[3 * c + 2], -9.81 * 0.01 * 0.03, 1e-6) << "free fall, both Euler methods";
    EXPECT_THROW(world_of(steps(0.01, 2) + body + section("Output", {"Fields = stress"})), ParameterError);
  }
}

} // namespace
} // namespace kerf::scene::fields_test
