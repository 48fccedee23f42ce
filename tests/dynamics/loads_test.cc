/// Loads: forces against energies and tangents against forces by differences, resultants and moments in closed form,
/// and what is refused.

#include "dynamics/loads.h"

#include "base/error.h"
#include "dynamics/floor.h"
#include "dynamics/handle.h"
#include "dynamics/surface_load.h"
#include "tests/support/spectrum.h"

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <array>
#include <random>

namespace kerf::dynamics::loads_test {
namespace {

Vec3 random_vector(std::mt19937& random, const double size) {
  Vec3 v;
  for (int k = 0; k < 3; ++k)
    v[k] = size * (2.0 * static_cast<double>(random()) / std::mt19937::max() - 1);
  return v;
}

Points random_points(const std::size_t n, const unsigned seed, const double size) {
  std::mt19937 random(seed);
  Points points;
  for (std::size_t i = 0; i < n; ++i)
    points.push_back(random_vector(random, size));
  return points;
}

/// A tetrahedron's surface whose four vertices follow eight corners by weights of sum 1.
SurfacePatch tetrahedron() {
  SurfacePatch patch;
  patch.rest = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  patch.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  for (std::uint32_t i = 0; i < 4; ++i) {
    const std::uint32_t corners[] = {2 * i, 2 * i + 1, (2 * i + 3) % 8};
    const double weights[] = {0.5, 0.8, -0.3};
    patch.points.add_row(corners, weights);
  }
  return patch;
}

/// Shape function v of the unit cube's corners, and its gradient.
double shape_of_cube(const std::uint32_t v, const Vec3& X) {
  double product = 1;
  for (int k = 0; k < 3; ++k)
    product *= v >> k & 1 ? X[k] : 1 - X[k];
  return product;
}
Vec3 shape_gradient_of_cube(const std::uint32_t v, const Vec3& X) {
  Vec3 gradient = Vec3::Ones();
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      gradient[i] *= k == i ? (v >> k & 1 ? 1 : -1) : v >> k & 1 ? X[k] : 1 - X[k];
  return gradient;
}

/// The tetrahedron in a cube that carries it by its eight corners.
SurfacePatch tetrahedron_in_a_cube() {
  SurfacePatch patch = tetrahedron();
  patch.points = {};
  for (const Vec3& X : patch.rest) {
    std::array<std::uint32_t, 8> corners{};
    std::array<double, 8> weights{};
    for (std::uint32_t v = 0; v < 8; ++v) {
      corners[v] = v;
      weights[v] = shape_of_cube(v, X);
    }
    patch.points.add_row(corners, weights);
  }
  patch.carriers.corners = corners_themselves(8);
  for (const auto& [a, b, c] : patch.triangles) {
    patch.carriers.of_triangle.push_back({0, 1, 2, 3, 4, 5, 6, 7});
    auto& shapes = patch.carriers.shape_at_nodes.emplace_back();
    for (int i = 0; i < n_triangle_nodes; ++i) {
      const Vec3 L = triangle_node(i);
      for (std::uint32_t v = 0; v < 8; ++v)
        shapes(i, v) = shape_of_cube(v, L[0] * patch.rest[a] + L[1] * patch.rest[b] + L[2] * patch.rest[c]);
    }
  }
  return patch;
}

Interpolation point_of_three() {
  Interpolation point;
  const std::uint32_t corners[] = {1, 4, 6};
  const double weights[] = {0.2, 0.5, 0.3};
  point.add_row(corners, weights);
  return point;
}

Vec3 field(const Vec3& X, const double t) { return {1 + X[0] * t, X[1] * X[2] - 2, std::sin(t) + X[2]}; }
Vec3 path(const double t) { return {0.3 * t, -0.1, 0.2 + t * t}; }

/// Eight corners, half of them below the floor.
const FloorParameters slanted{
  .point = Vec3(0, 0, 0.05), .normal = Vec3(0.2, -0.3, 2), .stiffness = 900, .friction = 0.6, .creep = 0.4};
ContactPoints eight_points() { return {corners_themselves(8), {1, 2, 3, 4, 5, 6, 7, 8}}; }

struct Case {
  std::string name;
  std::function<std::vector<std::unique_ptr<Load>>()> make;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

template <class T, class... Args>
std::vector<std::unique_ptr<Load>> alone(Args&&... args) {
  std::vector<std::unique_ptr<Load>> loads;
  loads.push_back(std::make_unique<T>(std::forward<Args>(args)...));
  return loads;
}

std::vector<std::unique_ptr<Load>> floor_and_friction() {
  auto loads = alone<Floor>(eight_points(), slanted);
  loads.push_back(std::make_unique<FloorFriction>(dynamic_cast<const Floor&>(*loads[0])));
  return loads;
}

const std::vector<Case> cases = {
  {"body_force",
   [] {
     return alone<BodyForce>(std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8}, random_points(8, 1, 1), field);
   }},
  {"traction", [] { return alone<Traction>(tetrahedron(), field); }},
  {"pressure",
   [] { return alone<Pressure>(tetrahedron(), [](const Vec3& X, const double t) { return 3 + t + X[0]; }); }},
  {"traction_on_a_bent_surface", [] { return alone<Traction>(tetrahedron_in_a_cube(), field); }},
  {"pressure_on_a_bent_surface",
   [] { return alone<Pressure>(tetrahedron_in_a_cube(), [](const Vec3& X, const double t) { return 3 + t + X[0]; }); }},
  {"handle_spring", [] { return alone<HandleSpring>(point_of_three(), 70, path); }},
  {"handle_damper", [] { return alone<HandleDamper>(point_of_three(), 7, path); }},
  {"floor", [] { return alone<Floor>(eight_points(), slanted); }},
  {"floor_and_friction", floor_and_friction},
};

class EachLoad : public testing::TestWithParam<Case> {
 protected:
  void SetUp() override { loads_ = GetParam().make(); }

  Points force(const Points& x, const Points& v) const {
    Points forces(8, Vec3::Zero());
    for (const auto& load : loads_)
      load->add_force({time, x, v}, forces);
    return forces;
  }
  double energy(const Points& x) const {
    double sum = 0;
    for (const auto& load : loads_)
      sum += load->energy(time, x);
    return sum;
  }
  LoadTangent tangent(const Tangent kind, const Points& x, const Points& v, const double velocity_factor) const {
    LoadTangent tangent;
    for (const auto& load : loads_)
      load->add_tangent(kind, {time, x, v}, velocity_factor, tangent);
    return tangent;
  }
  static Eigen::MatrixXd dense(const LoadTangent& tangent) {
    std::vector<Eigen::Triplet<double>> entries;
    tangent.add_entries(entries);
    Eigen::SparseMatrix<double> K(24, 24);
    K.setFromTriplets(entries.begin(), entries.end());
    return K;
  }

  static constexpr double time = 0.7;
  const Points x_ = random_points(8, 2, 0.5), v_ = random_points(8, 3, 0.6);
  std::vector<std::unique_ptr<Load>> loads_;
};

TEST_P(EachLoad, ForceIsMinusTheDerivativeOfEnergy) {
  if (loads_.size() > 1 || loads_[0]->nature() != Nature::conservative) {
    EXPECT_EQ(loads_.back()->energy(time, x_), 0);
    return;
  }
  const Points f = force(x_, v_);
  for (std::size_t i = 0; i < 8; ++i)
    for (int k = 0; k < 3; ++k) {
      constexpr double d = 1e-6;
      Points forward = x_, back = x_;
      forward[i][k] += d;
      back[i][k] -= d;
      EXPECT_NEAR((energy(forward) - energy(back)) / (2 * d), -f[i][k], 1e-5) << i << " " << k;
    }
}

TEST_P(EachLoad, ExactTangentIsMinusTheDerivativeOfForce) {
  const double omega = 3;
  const Eigen::MatrixXd K = dense(tangent(Tangent::exact, x_, v_, omega));
  for (std::size_t j = 0; j < 8; ++j)
    for (int b = 0; b < 3; ++b) {
      constexpr double d = 1e-6;
      Points x_1 = x_, x_0 = x_, v_1 = v_, v_0 = v_; // velocities go with positions, as an integrator has it
      x_1[j][b] += d;
      x_0[j][b] -= d;
      v_1[j][b] += omega * d;
      v_0[j][b] -= omega * d;
      const Points f_1 = force(x_1, v_1), f_0 = force(x_0, v_0);
      for (std::size_t i = 0; i < 8; ++i)
        for (int a = 0; a < 3; ++a)
          EXPECT_NEAR(-(f_1[i][a] - f_0[i][a]) / (2 * d), K(3 * i + a, 3 * j + b), 2e-4 * (1 + K.cwiseAbs().maxCoeff()))
            << i << a << " " << j << b;
    }
}

TEST_P(EachLoad, PositiveTangentIsSymmetricAndPositive) {
  const Eigen::MatrixXd K = dense(tangent(Tangent::positive, x_, v_, 3));
  EXPECT_LE((K - K.transpose()).cwiseAbs().maxCoeff(), 1e-12 * (1 + K.cwiseAbs().maxCoeff()));
  EXPECT_GE(support::spectrum(K).minCoeff(), -1e-10 * (1 + K.cwiseAbs().maxCoeff()));
}

TEST_P(EachLoad, ProductAndDiagonalAreThoseOfTheEntries) {
  const LoadTangent t = tangent(Tangent::exact, x_, v_, 3);
  const Eigen::MatrixXd K = dense(t);
  const Points p = random_points(8, 4, 1);
  Eigen::VectorXd y = Eigen::VectorXd::Zero(24);
  t.add_product({p[0].data(), 24}, {y.data(), 24});
  EXPECT_LE((y - K * Eigen::Map<const Eigen::VectorXd>(p[0].data(), 24)).norm(), 1e-11 * (1 + K.norm()));
  std::vector<Mat3> blocks(8, Mat3::Zero());
  t.add_diagonal(blocks);
  for (int i = 0; i < 8; ++i) {
    const Mat3 block = K.block<3, 3>(3 * i, 3 * i);
    EXPECT_LE((blocks[i] - 0.5 * (block + block.transpose())).norm(), 1e-11 * (1 + K.norm()));
  }
}

INSTANTIATE_TEST_SUITE_P(All, EachLoad, testing::ValuesIn(cases), [](const auto& info) { return info.param.name; });

Vec3 sum(const Points& forces) {
  Vec3 total = Vec3::Zero();
  for (const Vec3& f : forces)
    total += f;
  return total;
}

SurfacePatch on_its_own_corners(const SurfacePatch& patch) {
  return {corners_themselves(patch.rest.size()), patch.rest, patch.triangles};
}

/// A linear traction's resultant is the integral over the area: A/3 of the sum at the vertices.
TEST(Traction, HasTheResultantOfItsIntegral) {
  const SurfacePatch patch = on_its_own_corners(tetrahedron());
  const auto linear = [](const Vec3& X, double) { return Vec3(1 + X[0], X[1] - 2 * X[2], 3); };
  Vec3 expected = Vec3::Zero();
  for (const auto& [a, b, c] : patch.triangles) {
    const double area = 0.5 * (patch.rest[b] - patch.rest[a]).cross(patch.rest[c] - patch.rest[a]).norm();
    expected += area * linear((patch.rest[a] + patch.rest[b] + patch.rest[c]) / 3, 0);
  }
  Points forces(4, Vec3::Zero()), moved = random_points(4, 5, 1); // dead: wherever the body is
  Traction(patch, linear).add_force({0, moved, moved}, forces);
  EXPECT_LT((sum(forces) - expected).norm(), 1e-14);
  EXPECT_NEAR(rest_area(patch), 1.5 + std::sqrt(3) / 2, 1e-14);
}

void expect_neither_force_nor_moment(const Points& x, const Points& forces) {
  EXPECT_LT(sum(forces).norm(), 1e-14);
  Vec3 moment = Vec3::Zero();
  for (std::size_t i = 0; i < x.size(); ++i)
    moment += x[i].cross(forces[i]);
  EXPECT_LT(moment.norm(), 1e-14);
}

/// A closed surface under uniform pressure: no force, no moment, and p dV is its work.
TEST(Pressure, OfAClosedSurfaceOnlyChangesItsVolume) {
  const SurfacePatch patch = on_its_own_corners(tetrahedron());
  const Pressure load(patch, [](const Vec3&, double) { return 5.0; });
  const Points x = random_points(4, 6, 1);
  const auto volume = [&](const Points& at) {
    double v = 0;
    for (const auto& [a, b, c] : patch.triangles)
      v += at[a].dot(at[b].cross(at[c])) / 6;
    return v;
  };
  Points forces(4, Vec3::Zero());
  load.add_force({0, x, x}, forces);
  expect_neither_force_nor_moment(x, forces);
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k) {
      Points forward = x, back = x;
      forward[i][k] += 1e-6;
      back[i][k] -= 1e-6;
      EXPECT_NEAR(forces[i][k], -5 * (volume(forward) - volume(back)) / 2e-6, 1e-8);
    }
}

/// The volume of the tetrahedron's image, the integral of the map's determinant, by five points a direction.
double volume_of_image(const Points& x) {
  constexpr std::array places = {-0.906179845938664, -0.538469310105683, 0.0, 0.538469310105683, 0.906179845938664};
  constexpr std::array weights = {0.236926885056189, 0.478628670499366, 0.568888888888889, 0.478628670499366,
                                  0.236926885056189};
  double sum = 0;
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 5; ++j)
      for (int k = 0; k < 5; ++k) {
        const double u = (1 + places[i]) / 2, v = (1 + places[j]) / 2, w = (1 + places[k]) / 2;
        const Vec3 X(u, (1 - u) * v, (1 - u) * (1 - v) * w);
        Mat3 F = Mat3::Zero();
        for (std::uint32_t c = 0; c < 8; ++c)
          F += x[c] * shape_gradient_of_cube(c, X).transpose();
        sum += weights[i] * weights[j] * weights[k] / 8 * (1 - u) * (1 - u) * (1 - v) * F.determinant();
      }
  return sum;
}

/// The same where the cube bends it: what matters is the volume of the bent one.
TEST(Pressure, OfABentClosedSurfaceOnlyChangesItsVolume) {
  const Pressure load(tetrahedron_in_a_cube(), [](const Vec3&, double) { return 5.0; });
  const Points x = random_points(8, 6, 1);
  Points forces(8, Vec3::Zero());
  load.add_force({0, x, x}, forces);
  expect_neither_force_nor_moment(x, forces);
  for (int i = 0; i < 8; ++i)
    for (int k = 0; k < 3; ++k) {
      Points forward = x, back = x;
      forward[i][k] += 1e-4;
      back[i][k] -= 1e-4;
      EXPECT_NEAR(forces[i][k], -5 * (volume_of_image(forward) - volume_of_image(back)) / 2e-4, 1e-10);
    }
  EXPECT_NEAR(volume_of_image({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}}),
              1.0 / 6, 1e-14);
}

/// One triangle pushed against its outward normal, which turns with it.
TEST(Pressure, FollowsTheCurrentNormal) {
  SurfacePatch patch{corners_themselves(3), {Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(0, 3, 0)}, {{0, 1, 2}}};
  const Pressure load(patch, [](const Vec3&, double) { return 7.0; });
  Points forces(3, Vec3::Zero()), x = patch.rest;
  load.add_force({0, x, x}, forces);
  EXPECT_LT((sum(forces) - Vec3(0, 0, -21)).norm(), 1e-14);
  for (Vec3& p : x)
    p = Vec3(p[2], p[0], p[1]); // a rotation: z becomes x
  forces.assign(3, Vec3::Zero());
  load.add_force({0, x, x}, forces);
  EXPECT_LT((sum(forces) - Vec3(-21, 0, 0)).norm(), 1e-14);
}

TEST(BodyForce, HasTheResultantOfItsIntegral) {
  Points forces(2, Vec3::Zero()), x(2, Vec3::Zero());
  BodyForce({2, 3}, {Vec3(1, 0, 0), Vec3(0, 1, 0)}, field).add_force({0.5, x, x}, forces);
  EXPECT_LT((sum(forces) - 2 * field(Vec3(1, 0, 0), 0.5) - 3 * field(Vec3(0, 1, 0), 0.5)).norm(), 1e-14);
}

/// Friction opposes sliding by mu N, and is continuous where it starts.
TEST(FloorFriction, IsCoulombsLawBeyondTheCreepVelocity) {
  const FloorParameters parameters{.stiffness = 100, .friction = 0.4, .creep = 0.01};
  const Floor floor({corners_themselves(1), {2}}, parameters);
  const FloorFriction friction(floor);
  const Points x = {Vec3(0.3, 0.2, -0.05)};
  const double normal_force = 100 * 2 * 0.05;
  for (const double s : {0.0, 1e-4, 5e-3, 0.01, 0.011, 3.0}) {
    const Points v = {Vec3(0.6 * s, 0.8 * s, 0.7)};
    Points f(1, Vec3::Zero());
    friction.add_force({0, x, v}, f);
    const double g = s < 0.01 ? s / 0.01 * (2 - s / 0.01) : 1;
    EXPECT_LT((f[0] - Vec3(-0.6, -0.8, 0) * 0.4 * normal_force * g).norm(), 1e-12) << s;
    EXPECT_LE(f[0].dot(v[0]), 0);
  }
}

TEST(Loads, RefuseWhatCannotBe) {
  SurfacePatch patch = tetrahedron();
  patch.triangles.push_back({0, 1, 4});
  EXPECT_THROW(Traction(patch, field), ParameterError);
  patch = tetrahedron();
  patch.rest.pop_back();
  EXPECT_THROW(Pressure(patch, [](const Vec3&, double) { return 0.0; }), ParameterError);
  EXPECT_NO_THROW(require_triangles(tetrahedron()));
  EXPECT_THROW(require_triangles({}), ParameterError);
  EXPECT_THROW(BodyForce({1, 2}, {Vec3::Zero()}, field), ParameterError);
  EXPECT_THROW(HandleSpring({}, 1, path), ParameterError);
  EXPECT_THROW(HandleSpring(point_of_three(), -1, path), ParameterError);
  EXPECT_THROW(HandleDamper(corners_themselves(2), 1, path), ParameterError);
  EXPECT_THROW(Floor(eight_points(), {.normal = Vec3::Zero()}), ParameterError);
  EXPECT_THROW(Floor({corners_themselves(8), {1}}, {}), ParameterError);
  EXPECT_THROW(held_along(Vec3::Zero()), ParameterError);
}

template <class P>
std::string broken_rule(const std::string& key, const std::string& value) {
  P parameters;
  Parameters list;
  parameters.describe(list);
  for (const Parameter& parameter : list.list())
    if (parameter.name == key)
      return parameter.check(value);
  return "no such key";
}

TEST(Loads, HaveKeysWithRules) {
  EXPECT_EQ(broken_rule<HandleParameters>("Stiffness [N/m]", "0"), "must be > 0");
  EXPECT_EQ(broken_rule<HandleParameters>("Damping [N s/m]", "-1"), "must be >= 0");
  EXPECT_EQ(broken_rule<FloorParameters>("Friction [1]", "-0.1"), "must be >= 0");
  EXPECT_EQ(broken_rule<FloorParameters>("Creep velocity [m/s]", "0"), "must be > 0");
  EXPECT_EQ(broken_rule<TractionParameters>("Faces", "inside"), "must be one of skin, revealed, all");
  EXPECT_EQ(broken_rule<PressureParameters>("Faces", "revealed"), "");
  EXPECT_EQ(broken_rule<BodyForceParameters>("Force density [N/m^3]", "0; 0; x"), "");
}

} // namespace
} // namespace kerf::dynamics::loads_test
