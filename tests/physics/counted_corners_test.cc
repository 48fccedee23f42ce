// Models that count the corners that deform, and not those of crumbs: what they say of them, and how they step.

#include "dynamics/handle.h"
#include "dynamics/implicit_euler.h"
#include "dynamics/sound_steps.h"
#include "grid/crumbs.h"
#include "physics/on_corners.h"
#include "tests/physics/cut_bodies.h"

#include <gtest/gtest.h>

namespace kerf::physics::counted_corners_test {
namespace {

using grid::Counted;

constexpr double h = 0.1;
constexpr int n_x = 9, n_across = 5;

/// A bar of 9 x 5 x 5 nodes whose last layers are cut off, and into pieces of one node each; the next layer hangs on by
/// every other row.
struct Bar {
  GrowingCut cut{support::block({n_x, n_across, n_across}, h)};

  explicit Bar(const int n_layers = 0) { grind(n_layers); }

  grid::CutChange grind(const int n_layers) {
    const grid::Grid& grid = cut.body.grid;
    std::vector<grid::EdgeCut> cuts;
    for (const auto e : ids<grid::EdgeId>(grid.n_edges())) {
      const auto& [lower, upper] = grid.ends(e);
      const int layer = n_x - grid.index(upper)[0], axis = grid.axis(e);
      const bool is_dust = layer < n_layers, is_slit = layer == n_layers && axis == 1 && grid.index(upper)[2] % 2 == 0;
      if (n_layers > 0 && support::is_inner(cut.body, e) && (is_dust || is_slit))
        cuts.push_back({e, 0.3 + 0.1 * axis, Vec3::Unit(axis),
                        static_cast<grid::CutLabel>(1 + 3 * axis + grid.index(lower)[axis] % 3)});
    }
    grid::CutChange change = cut.cutter.cut(cut.body, support::with_skin(cut.body, cuts));
    surface::place(cut.body, change, {});
    surface::update_surface(cut.body, change, cut.surface, cut.index);
    grid::update_crumbs(cut.body, change);
    return change;
  }
  std::size_t n_crumbs() const { return cut.body.crumbs.all.size(); }
  std::size_t n_deforming() const {
    std::size_t n = 0;
    for (const auto c : ids<grid::CornerId>(cut.body.complex.n_corners()))
      n += cut.body.crumbs.holds(c) ? 0 : 1;
    return n;
  }
};

fem::HexahedraOptions elements(const Counted counted, const fem::Inertia inertia = fem::Inertia::lumped,
                               const fem::MassMatrix mass = fem::MassMatrix::lumped) {
  return {.material = {.density = 1000, .youngs_modulus = 1e5, .poissons_ratio = 0.4},
          .inertia = inertia,
          .mass = mass,
          .counted = counted};
}

std::unique_ptr<Physics> make(const std::string& backend, const CutBody& body, const Counted counted) {
  const auto implicit = [](auto& model, const PiecesOfParticles& pieces) {
    return std::make_unique<dynamics::ImplicitEuler>(
      model, dynamics::ImplicitEulerOptions{
               .n_newton = 2, .cg_tolerance = 1e-10, .trust = dynamics::Trust::tested, .piece = pieces()});
  };
  if (backend == "lattice")
    return std::make_unique<ShapeMatching>(
      body,
      [=](const CutBody& b) {
        return std::make_unique<lattice::Matching>(b.solid, lattice::MatchingOptions{.counted = counted});
      },
      [](lattice::Matching& model, const PiecesOfParticles&) {
        return std::make_unique<lattice::ShapeMatching>(model, 1);
      });
  if (backend == "springs")
    return std::make_unique<Springs>(
      body,
      [=](const CutBody& b) {
        return std::make_unique<spring::MassSpring>(b.solid, spring::MassSpringOptions{.counted = counted});
      },
      implicit);
  return std::make_unique<Elements>(
    body, [=](const CutBody& b) { return std::make_unique<fem::Hexahedra>(b.solid, elements(counted)); }, implicit);
}

const std::vector<std::string> backends = {"elements", "springs", "lattice"};

/// How many corners the integrator sees.
std::size_t n_seen(const Physics& physics) {
  if (const auto* const own = dynamic_cast<const Elements*>(&physics))
    return own->own_model().lumped_mass().size();
  if (const auto* const own = dynamic_cast<const Springs*>(&physics))
    return own->own_model().lumped_mass().size();
  return dynamic_cast<const ShapeMatching&>(physics).own_model().lumped_mass().size();
}

/// The solver sees as many corners as deform, however many crumbs there are; to all else the model has every corner.
TEST(CountedCorners, AreThoseThatDeform) {
  for (const auto& backend : backends) {
    Bar bar;
    const auto physics = make(backend, bar.cut.seen(), Counted::deforming);
    auto state = state_at_rest(*physics);
    EXPECT_EQ(n_seen(*physics), bar.cut.body.complex.n_corners()) << "without crumbs all";
    const auto change = bar.grind(3);
    physics->follow_cut(bar.cut.seen(), change, state);
    ASSERT_EQ(bar.n_crumbs(), 3u * n_across * n_across);
    EXPECT_EQ(n_seen(*physics), bar.n_deforming()) << backend;
    EXPECT_LT(4 * n_seen(*physics), bar.cut.body.complex.n_corners()) << backend;
    EXPECT_EQ(physics->model().lumped_mass().size(), state.x.size()) << backend;
  }
}

template <class Base, class Model, class Options>
void expect_same(const Bar& bar, Options options) {
  support::Random random(7);
  options.counted = Counted::all;
  Model all(bar.cut.body, options);
  options.counted = Counted::deforming;
  Model some(bar.cut.body, options);
  const std::size_t n = bar.cut.body.complex.n_corners();
  const Base widened(some, some.numbers(), n);
  ASSERT_FALSE(some.numbers().are_all());
  const Points rest = bar.cut.rest(), shift = random_points(n, random);
  Points x = rest;
  for (std::size_t i = 0; i < n; ++i)
    x[i] += 0.02 * shift[i];
  const auto near = [](const Points& a, const Points& b) {
    double off = 0, size = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      off = std::max(off, (a[i] - b[i]).norm());
      size = std::max(size, a[i].norm());
    }
    return a.size() == b.size() && off <= 1e-11 * size;
  };
  for (std::size_t i = 0; i < n; ++i)
    EXPECT_NEAR(widened.lumped_mass()[i], all.lumped_mass()[i], 1e-12);
  EXPECT_NEAR(widened.energy(x), all.energy(x), 1e-11 * all.energy(x));
  Points f, g;
  all.force(x, f);
  widened.force(x, g);
  EXPECT_TRUE(near(f, g));
  if constexpr (std::is_base_of_v<dynamics::ElasticModel, Model>) {
    Base by_number(some, some.numbers(), n);
    all.linearise(x);
    by_number.linearise(x);
    Points p(n, Vec3::Zero()), q = p;
    all.apply_stiffness(dynamics::flat(shift), dynamics::flat(p));
    by_number.apply_stiffness(dynamics::flat(shift), dynamics::flat(q));
    EXPECT_TRUE(near(p, q));
    const std::vector<Mat3> blocks = dynamics::stiffness_blocks(all), of_some = dynamics::stiffness_blocks(by_number);
    for (std::size_t i = 0; i < n; ++i)
      EXPECT_LT((blocks[i] - of_some[i]).norm(), 1e-9 * (1 + blocks[i].norm()));
    for (const auto kind : {dynamics::Tangent::positive, dynamics::Tangent::exact}) {
      const auto K = all.stiffness_matrix(x, kind);
      Points y;
      some.numbers().gather(x, y);
      const auto of_numbers = some.stiffness_matrix(y, kind);
      ASSERT_EQ(std::size_t(of_numbers.rows()), 3 * some.numbers().size());
      for (int i = 0; i < of_numbers.outerSize(); i += 17)
        for (Eigen::SparseMatrix<double>::InnerIterator it(of_numbers, i); it; ++it)
          EXPECT_NEAR(
            it.value(),
            K.coeff(3 * some.numbers().corner(it.row() / 3) + it.row() % 3, 3 * some.numbers().corner(i / 3) + i % 3),
            1e-9 * (1 + std::abs(it.value())));
    }
  }
  if (all.mass_coupling()) {
    Points p(n, Vec3::Zero()), q = p;
    all.mass_coupling()->add_product(dynamics::flat(shift), dynamics::flat(p));
    widened.mass_coupling()->add_product(dynamics::flat(shift), dynamics::flat(q));
    EXPECT_TRUE(near(p, q));
    std::vector<Eigen::Triplet<double>> entries;
    widened.mass_coupling()->add_entries(1, entries);
    for (Vec3& v : q)
      v.setZero();
    for (const auto& entry : entries)
      q[entry.row() / 3][entry.row() % 3] += entry.value() * shift[entry.col() / 3][entry.col() % 3];
    EXPECT_TRUE(near(p, q));
  }
  ASSERT_EQ(widened.followers().size(), all.followers().size());
  for (std::size_t i = 0; i < all.followers().size(); ++i)
    EXPECT_NEAR((widened.followers()[i].led(shift) - all.followers()[i].led(shift)).norm(), 0, 1e-12);
}

/// What a model says of the corners that it counts is what one says that counts all.
TEST(CountedCorners, HaveTheForcesThatTheyHaveAmongAll) {
  const Bar bar(2);
  expect_same<WidenedElasticModel, fem::Hexahedra>(bar, elements(Counted::all));
  expect_same<WidenedElasticModel, fem::Hexahedra>(
    bar, elements(Counted::all, fem::Inertia::gathered, fem::MassMatrix::consistent));
  expect_same<WidenedElasticModel, fem::Hexahedra>(bar, elements(Counted::all, fem::Inertia::extended));
  expect_same<WidenedElasticModel, spring::MassSpring>(bar, spring::MassSpringOptions{});
  expect_same<WidenedForceModel, lattice::Matching>(bar, lattice::MatchingOptions{});
}

/// Steps are the same too, with supports and loads at both kinds of corners; and crumbs take none of the solver's
/// iterations.
TEST(CountedCorners, StepAsAmongAll) {
  for (const auto& backend : backends) {
    std::vector<Points> ends;
    std::vector<int> n_iterations;
    for (const Counted counted : {Counted::all, Counted::deforming}) {
      Bar bar;
      const auto physics = make(backend, bar.cut.seen(), counted);
      auto state = state_at_rest(*physics);
      for (std::size_t i = 0; i < state.x.size(); ++i)
        state.v[i] = Vec3(0, std::sin(5 * state.x[i][0]), std::sin(7 * state.x[i][1]));
      physics->follow_cut(bar.cut.seen(), bar.grind(2), state);
      dynamics::Loads loads{.gravity = {0, 0, -9.81}, .mass_damping = 0.5, .supports = {}};
      loads.carried = physics->crumbs().carried();
      dynamics::Support wall{{}, {}, [](double) { return Vec3(Vec3::Zero()); }};
      const Points& rest = physics->rest();
      for (std::uint32_t i = 0; i < rest.size(); ++i)
        if (rest[i][0] < 0.15 || (rest[i][0] > 0.95 && rest[i][1] < 0.15)) {
          wall.corners.push_back(i);
          wall.rest.push_back(rest[i]);
        }
      loads.supports.push_back(wall);
      for (const double x : {0.52, 0.9}) // in the body, and in a crumb
        loads.acting.push_back(std::make_unique<dynamics::HandleSpring>(body_point(bar.cut.seen(), Vec3(x, 0.31, 0.31)),
                                                                        500, [](double) { return Vec3(1, 1, 1); }));
      int n = 0;
      for (int step = 0; step < 3; ++step)
        n += physics->step(state, loads, 0.01).n_iterations;
      n_iterations.push_back(n);
      ends.push_back(state.x);
    }
    double off = 0;
    for (std::size_t i = 0; i < ends[0].size(); ++i)
      off = std::max(off, (ends[0][i] - ends[1][i]).norm());
    EXPECT_LT(off, 1e-6 * h) << backend;
    EXPECT_NEAR(n_iterations[0], n_iterations[1], 0.1 * n_iterations[0]) << backend;
  }
}

/// An error of a step names the corner, by which the body is known.
TEST(CountedCorners, ErrorsNameTheCorner) {
  struct Failing : dynamics::Stepper {
    dynamics::StepReport step(dynamics::State& state, const dynamics::Loads&, double) override {
      throw dynamics::StepError("it fails", state.x.size() - 1);
    }
  } failing;
  Bar bar(2);
  const grid::CornerNumbers numbers(bar.cut.body, Counted::deforming);
  dynamics::State state{bar.cut.rest(), Points(bar.cut.body.complex.n_corners(), Vec3::Zero())};
  const Points before = state.x;
  try {
    narrowed_step(failing, numbers, state, {}, 0.1);
    FAIL();
  } catch (const dynamics::StepError& error) {
    EXPECT_EQ(error.particle(), numbers.corner(numbers.size() - 1));
    EXPECT_LT(error.particle(), before.size());
  }
  EXPECT_EQ(state.x, before);
}

} // namespace
} // namespace kerf::physics::counted_corners_test
