// Every way to sweep a plane, to fit a picture and to take components: exact on the exemplars' planes, continuous, the
// same bits in any order and with any number of threads.

#include "base/parallel.h"
#include "tests/texture/probes.h"
#include "tests/texture/refused.h"
#include "texture/detail.h"

#include <gtest/gtest.h>

#include <numeric>

namespace kerf::texture::sweeps_test {
namespace {

/// What an interior is made from.
struct Input {
  std::vector<Exemplar> exemplars;
  geometry::TriangleMesh body = ball(3);
  InteriorOptions options = {};
};

Input swept(const Sweep& sweep, const int first = 0) {
  Input input{axis_exemplars(onion, 3, 70)};
  for (std::size_t i = first; i < input.exemplars.size(); ++i)
    input.exemplars[i].sweep = sweep;
  return input;
}

/// Three planes through z turn about it, whose pictures have n columns: an odd number has one on the axis.
Input about_axis(const int n = 70) {
  Input input;
  for (int i = 0; i < 3; ++i) {
    const double angle = M_PI * i / 3 + 0.02;
    const Vec3 out(std::cos(angle), std::sin(angle), 0);
    input.exemplars.push_back(exemplar_of("e" + std::to_string(i), onion, Vec3::Zero(), out, Vec3::UnitZ(), n));
    input.exemplars.back().sweep = {Sweep::Path::axis, Vec3::Zero(), Vec3::UnitZ()};
  }
  return input;
}

/// Pictures that show an ellipse of their section, off its middle.
Input partial(const Fit fit) {
  Input input{axis_exemplars(onion, 3, 70)};
  for (Exemplar& exemplar : input.exemplars) {
    exemplar.picture.alpha = image::Grey(70, 70, 0);
    for (int r = 0; r < 70; ++r)
      for (int c = 0; c < 70; ++c)
        exemplar.picture.alpha(c, r) = std::hypot((c - 33) / 30.0, (r - 37) / 26.0) < 1 ? 1.0f : 0.0f;
    exemplar.background = Background::alpha;
    exemplar.fit = fit;
  }
  return input;
}

/// An arch: a plane across its legs has two components.
geometry::TriangleMesh arch() {
  geometry::TriangleMesh mesh = geometry::sphere_mesh(1, Vec3::Zero(), 3);
  for (Vec3& v : mesh.vertices)
    v = Vec3(0.045 * v[0], 0.014 * v[1], 0.014 * v[2] - 22 * std::pow(0.045 * v[0], 2) + 0.016);
  return mesh;
}
void append(geometry::TriangleMesh& mesh, const geometry::TriangleMesh& more) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), more.vertices.begin(), more.vertices.end());
  for (const Triangle& t : more.triangles)
    mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

Input legs(const Components components) {
  Input input{{exemplar_of("legs", onion, Vec3(0, 0, -0.008), Vec3::UnitX(), Vec3::UnitY(), 120)}, arch()};
  input.options.components = components;
  return input;
}

struct Way {
  const char* name;
  Input (*input)();
};
void PrintTo(const Way& way, std::ostream* out) { *out << way.name; }

class Ways : public testing::TestWithParam<Way> {};

TEST_P(Ways, AreExactAndContinuous) {
  const Input input = GetParam().input();
  const Interior inside(input.exemplars, input.body, input.options);
  for (const auto morph : {Morph::first_order, Morph::blend}) {
    const Blending how = {morph, Weights::shepard, 1};
    const double jump = largest_jump([&](const Vec3& p) { return inside.colour(p, how); }, input.body, 60, 120);
    const double error = largest_error_on_exemplars(inside, how);
    std::printf("%s: largest jump %.1e, largest error on the planes %.1e\n", GetParam().name, jump, error);
    EXPECT_LT(jump, 1e-4);
    EXPECT_LT(error, 2e-3);
  }
}

TEST_P(Ways, GiveTheSameBitsInAnyOrderAndWithAnyNumberOfThreads) {
  const Input input = GetParam().input();
  const Points points = points_inside(200, 5);
  std::vector<std::vector<Colour>> found;
  for (const int n_threads : {1, 2}) {
    set_n_threads(n_threads);
    const Interior inside(input.exemplars, input.body, input.options);
    std::vector<Colour> colours(points.size());
    for (std::size_t i = points.size(); i-- > 0;)
      colours[n_threads == 1 ? i : points.size() - 1 - i] =
        inside.colour(points[n_threads == 1 ? i : points.size() - 1 - i]);
    found.push_back(colours);
  }
  set_n_threads(2);
  for (std::size_t i = 0; i < points.size(); ++i)
    ASSERT_TRUE((found[0][i] == found[1][i]).all()) << i;
}

/// What points get when up to eight are asked for at once, in the order of `numbers`.
std::vector<Blend> together(const Interior& inside, const Points& points, const Blending& how,
                            const std::vector<int>& numbers) {
  std::vector<Blend> blends(points.size());
  for (std::size_t first = 0; first < numbers.size(); first += 8) {
    Points some;
    std::vector<Blend*> places;
    for (std::size_t i = first; i < std::min(first + 8, numbers.size()); ++i) {
      some.push_back(points[numbers[i]]);
      places.push_back(&blends[numbers[i]]);
    }
    inside.blend(some, how, places);
  }
  return blends;
}

/// How far two blends are from each other, in pixels and in weights.
double gap(const Blend& a, const Blend& b) {
  double most = a.n == b.n && a.cell == b.cell ? 0 : 1e300;
  for (int i = 0; i < a.n && most < 1; ++i)
    most = std::max<double>({most, std::abs(a.weights[i] - b.weights[i]), std::abs(a.x[i] - b.x[i]),
                             std::abs(a.y[i] - b.y[i]), a.exemplars[i] == b.exemplars[i] ? 0.0 : 1e300});
  return most;
}

TEST_P(Ways, GiveEightPointsAtOnceWhatTheyGiveEach) {
  Input input = GetParam().input();
  input.options.warps.pixels = 16; // any warps will do
  input.options.warps.match.n_levels = 1;
  input.options.warps.match.n_iterations = 2;
  const Interior inside(input.exemplars, input.body, input.options);
  Points points = points_inside(203, 6, 0.06); // some outside, where source points stay at the border
  for (int i = 0; i < 50; ++i)
    points[i] -= inside.charts()[0].plane.height(points[i]) * inside.charts()[0].plane.normal(); // of weight 1
  std::vector<int> forward(points.size()), mixed;
  std::iota(forward.begin(), forward.end(), 0);
  mixed = forward;
  std::shuffle(mixed.begin(), mixed.end(), std::mt19937(3));
  for (const Blending& how : {Blending{Morph::first_order, Weights::shepard, 1}, Blending{Morph::blend, {}, 2},
                              Blending{Morph::blend, {}, 2.5}, Blending{Morph::blend, Weights::mean_value, 1}}) {
    const auto a = together(inside, points, how, forward), b = together(inside, points, how, mixed);
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_EQ(gap(a[i], b[i]), 0) << i; // whatever the others are
      EXPECT_LT(gap(a[i], inside.blend(points[i], how)), 1e-3) << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
  All, Ways,
  testing::Values(Way{"normal", [] { return swept({}); }}, Way{"middles", [] { return swept({Sweep::Path::middles}); }},
                  Way{"arc",
                      [] {
                        return swept({Sweep::Path::arc, Vec3::Zero()}, 1);
                      }},
                  Way{"axis", [] { return about_axis(); }}, Way{"axis_on_pixels", [] { return about_axis(71); }},
                  Way{"partial", [] { return partial(Fit::none); }}, Way{"rigid", [] { return partial(Fit::rigid); }},
                  Way{"harmonic", [] { return partial(Fit::harmonic); }},
                  Way{"each", [] { return legs(Components::each); }},
                  Way{"together", [] { return legs(Components::together); }}),
  [](const auto& info) { return std::string(info.param.name); });

TEST(Sweeps, AboutAnAxisFindWhatIsRoundAboutIt) {
  for (const int n : {70, 71}) {
    const Input input = about_axis(n);
    const Interior inside(input.exemplars, input.body, {});
    EXPECT_EQ(inside.partition().cells().size(), 6u);
    for (const Cell& cell : inside.partition().cells())
      EXPECT_EQ(cell.faces.size(), 2u) << n; // nothing of the third plane but the axis
  }
  const Input input = about_axis();
  const Interior inside(input.exemplars, input.body, {});
  const auto error = [&](const Interior& of) {
    double sum = 0;
    const Points points = points_inside(500, 3);
    for (const Vec3& p : points)
      sum += (of.colour(p, {Morph::blend, Weights::shepard, 1}).head<3>() - onion(p)).abs().mean() / 500;
    return sum;
  };
  auto along_normals = input.exemplars;
  for (Exemplar& exemplar : along_normals)
    exemplar.sweep = {};
  EXPECT_LT(error(inside), 0.03);
  EXPECT_GT(error(Interior(along_normals, input.body, {})), 2 * error(inside));
}

TEST(Sweeps, ThatCannotTurnAreRefused) {
  auto exemplars = axis_exemplars(onion, 1, 60);
  const Vec3 x = exemplars[0].plane.x(), n = exemplars[0].plane.normal(), middle = 0.0005 * n;
  exemplars[0].sweep = {Sweep::Path::axis, middle, x};
  expect_refused(exemplars, "Axis [1]", "passes through the barycentre");
  exemplars[0].sweep = {Sweep::Path::axis, middle + 0.02 * exemplars[0].plane.y(), x};
  expect_refused(exemplars, "Axis [1]", "crosses a face");
  exemplars[0].sweep = {Sweep::Path::axis, middle, Vec3(x + n)};
  expect_refused(exemplars, "Axis [1]", "must lie in the plane");
  exemplars[0].sweep = {Sweep::Path::arc, middle};
  expect_refused(exemplars, "Centre [m]", "barycentre of a face lies at the centre");
  exemplars[0].sweep = {Sweep::Path::arc, middle + 0.02 * x};
  expect_refused(exemplars, "Centre [m]", "crosses a face");
}

/// An arch along its plane: rays from its middle leave it, and those to its ends meet it again. Where the swept
/// section's arms end in other directions, neighbours must stay neighbours.
/// How far two points of the arch, a thousandth of a pixel apart, are drawn apart at most on the first face, as a
/// multiple of that; of points inside of it.
double furthest_apart(const Interior& inside) {
  const geometry::Inside within(arch());
  const double pixel = inside.pixel(), step = 1e-3 * pixel;
  double furthest = 0;
  for (const double height : {0.004, 0.008, 0.011})
    for (double x = -0.044; x < 0.044; x += 0.5 * pixel)
      for (double z = -0.04; z < 0.03; z += 0.5 * pixel) {
        const Vec3 p(x, height, z), q = p + step * Vec3(1, 0, 1).normalized();
        if (!within.contains(p) || !within.contains(q))
          continue;
        const Blend a = inside.blend(p, {Morph::blend}), b = inside.blend(q, {Morph::blend});
        furthest = std::max(furthest, std::hypot(a.x[0] - b.x[0], a.y[0] - b.y[0]) / (step / pixel));
      }
  return furthest;
}

TEST(Sweeps, ThroughArmsAndBaysDrawNeighboursApartNoFurtherThanSpiralsDo) {
  const auto along = exemplar_of("along", onion, Vec3(0, 1e-5, 0), Vec3::UnitZ(), Vec3::UnitX(), 200);
  const double furthest = furthest_apart(Interior({along}, arch(), {}));
  std::printf("neighbours are drawn apart %.1f times at most\n", furthest);
  EXPECT_LT(furthest, 4.13 * 1.62); // so much thicker is the arch than at these heights
}

/// The same where the arch is one of two components, taken one by one.
TEST(Components, WithArmsAndBaysDrawNeighboursApartNoFurtherThanSpiralsDo) {
  auto body = arch();
  append(body, geometry::sphere_mesh(0.006, Vec3(0, 0, -0.03), 2));
  const auto along = exemplar_of("along", onion, Vec3(0, 1e-5, 0), Vec3::UnitZ(), Vec3::UnitX(), 200);
  InteriorOptions options;
  options.components = Components::each;
  const Interior inside({along}, body, options);
  ASSERT_EQ(inside.partition().cells()[0].faces.size(), 2u);
  const double furthest = furthest_apart(inside);
  std::printf("neighbours are drawn apart %.1f times at most\n", furthest);
  EXPECT_LT(furthest, 4.13 * 1.62);
}

TEST(Components, SeveralAreRefusedUntilOneMoreExemplarPartsThem) {
  const Input input = legs(Components::one);
  expect_refused(input.exemplars, "Components", "2 components", {}, input.body);
  auto more = input.exemplars;
  more.insert(more.begin(), exemplar_of("middle", onion, Vec3::Zero(), Vec3::UnitY(), Vec3::UnitZ(), 120));
  const Interior inside(more, input.body, {});
  EXPECT_EQ(inside.partition().cells().size(), 4u);
  EXPECT_LT(largest_error_on_exemplars(inside, inside.options().blending), 2e-3);
}

/// Balls side by side, cut by one plane: as many components as there are balls.
Input balls(const int n_columns, const int n_rows, const Components components) {
  Input input{{exemplar_of("all", onion, Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), 120)}, {}};
  for (int i = 0; i < n_columns * n_rows; ++i) {
    const Vec3 middle(0.014 * (i % n_columns - 2.5), 0.014 * (i / n_columns - 2.5), 0);
    append(input.body, geometry::sphere_mesh(0.006, middle, 2));
  }
  input.options.components = components;
  input.options.warps.pixels = 16;
  input.options.warps.match.n_levels = 1;
  input.options.warps.match.n_iterations = 2;
  return input;
}

TEST(Components, AsManyAsACellMayHave) {
  const Input many = balls(6, 5, Components::each), too_many = balls(6, 6, Components::each),
              as_one = balls(6, 6, Components::together);
  const Interior inside(many.exemplars, many.body, many.options);
  EXPECT_EQ(inside.blend(Vec3(0, 0, 0.001), {}).n, 30);
  EXPECT_LT(largest_error_on_exemplars(inside, inside.options().blending), 2e-3);
  expect_refused(too_many.exemplars, "Components", "36 faces bound one cell", too_many.options, too_many.body);
  EXPECT_EQ(Interior(as_one.exemplars, as_one.body, as_one.options).blend(Vec3(0, 0, 0.001), {}).n, 1);
}

TEST(Components, EachOrTogether) {
  const Vec3 in_a_leg(0.035, 0, -0.01), in_the_arch(0, 0, 0.016);
  const auto n_sources = [&](const Components components, const Vec3& p) {
    const Input input = legs(components);
    return Interior(input.exemplars, input.body, input.options).blend(p, {}).n;
  };
  EXPECT_EQ(n_sources(Components::each, in_a_leg), 2);
  EXPECT_EQ(n_sources(Components::each, in_the_arch), 2);
  EXPECT_EQ(n_sources(Components::together, in_a_leg), 1);
}

} // namespace
} // namespace kerf::texture::sweeps_test
