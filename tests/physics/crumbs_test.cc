// Crumbs as rigid bodies: their mass and inertia, what they keep when they become one, flight, loads and supports.

#include "physics/crumbs.h"

#include "dynamics/forces.h"
#include "dynamics/handle.h"
#include "dynamics/symplectic_euler.h"
#include "grid/material.h"
#include "physics/on_corners.h"
#include "physics/phyxels.h"
#include "tests/physics/cut_bodies.h"

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

namespace kerf::physics::crumbs_test {
namespace {

constexpr double h = 0.1, density = 1000;

/// A block of 4 x 4 x 4 nodes whose last layer along x is cut off, and into pieces of one node each.
struct Dust {
  GrowingCut block{support::block({4, 4, 4}, h)};

  grid::CutChange cut() { return cut(layer()); }
  grid::CutChange cut(const std::vector<grid::EdgeCut>& cuts) {
    return followed(block.cutter.cut(block.body, support::with_skin(block.body, cuts)));
  }
  grid::CutChange followed(grid::CutChange change) {
    surface::place(block.body, change, {});
    surface::update_surface(block.body, change, block.surface, block.index);
    grid::update_crumbs(block.body, change);
    return change;
  }
  /// All copies of the cells around the nodes of one or two inner rows of the layer are joined.
  grid::CutChange join(const int n_rows) {
    std::vector<grid::CellId> cells;
    for (const auto c : ids<grid::CellId>(block.body.grid.n_cells()))
      for (const grid::NodeId node : block.body.grid.nodes(c))
        if (const Index3& at = block.body.grid.index(node); at[0] == 4 && at[1] >= 2 && at[1] < 2 + n_rows &&
                                                            at[2] >= 2 && at[2] <= 3 &&
                                                            (cells.empty() || cells.back() != c)) {
          block.body.cuts.set_joined(c, {{~grid::Items(0), 0}});
          cells.push_back(c);
        }
    return followed(grid::update_complex(block.body, {}, {}, cells));
  }
  std::vector<grid::EdgeCut> layer() const {
    std::vector<grid::EdgeCut> cuts;
    const grid::Grid& grid = block.body.grid;
    for (const auto e : ids<grid::EdgeId>(grid.n_edges())) {
      const auto& [lower, upper] = grid.ends(e);
      const bool is_last = grid.index(upper)[0] == 4;
      const int axis = grid.axis(e);
      const auto plane = static_cast<grid::CutLabel>(1 + 3 * axis + grid.index(lower)[axis] % 3); // a cut of its own
      if (support::is_inner(block.body, e) && is_last)
        cuts.push_back({e, 0.5, Vec3::Unit(axis), plane});
    }
    return cuts;
  }
};

std::unique_ptr<Physics> make(const std::string& backend, const CutBody& body) {
  const auto verlet = [](auto& model, const PiecesOfParticles&) {
    return std::make_unique<dynamics::SymplecticEuler>(model, dynamics::ExplicitOptions{});
  };
  if (backend == "lattice")
    return std::make_unique<ShapeMatching>(
      body, [](const CutBody& b) { return std::make_unique<lattice::Matching>(b.solid, lattice::MatchingOptions{}); },
      [](lattice::Matching& model, const PiecesOfParticles&) {
        return std::make_unique<lattice::ShapeMatching>(model, 0);
      });
  if (backend == "springs")
    return std::make_unique<Springs>(
      body, [](const CutBody& b) { return std::make_unique<spring::MassSpring>(b.solid, spring::MassSpringOptions{}); },
      verlet);
  if (backend == "points")
    return std::make_unique<Phyxels>(body, PhyxelsOptions{}, verlet);
  return std::make_unique<Elements>(
    body,
    [](const CutBody& b) {
      return std::make_unique<fem::Hexahedra>(b.solid,
                                              fem::HexahedraOptions{.material = {}, .inertia = fem::Inertia::extended});
    },
    verlet);
}

const std::vector<std::string> backends = {"elements", "lattice", "springs", "points"};

double sum(const std::span<const double> values) {
  double all = 0;
  for (const double value : values)
    all += value;
  return all;
}

/// A body of one node is a cube.
TEST(Crumbs, HaveTheMassAndInertiaOfACube) {
  GrowingCut block{support::block({1, 1, 1}, h)};
  grid::find_crumbs(block.body);
  ASSERT_EQ(block.body.crumbs.all.size(), 1u);
  const CrumbBody made = measure(block.body, block.body.crumbs.all[0], density);
  const double m = density * h * h * h;
  EXPECT_NEAR(made.body.mass, m, 1e-12);
  EXPECT_LT((made.body.centre - Vec3::Constant(h)).norm(), 1e-12);
  EXPECT_LT((made.body.inertia - m * h * h / 6 * Mat3::Identity()).norm(), 1e-12 * m * h * h);
  EXPECT_NEAR(sum(made.mass_of_corners), m, 1e-9 * m);
}

/// Of any shape: what the surface of the piece encloses, by the divergence theorem.
TEST(Crumbs, HaveTheMassAndInertiaThatTheirSurfaceEncloses) {
  support::Random random(3);
  Dust dust;
  auto cuts = support::random_cuts(random, dust.block.body, 0.7);
  for (grid::EdgeCut& cut : cuts)
    cut.label = static_cast<grid::CutLabel>(1 + random() % 9); // what one blade cuts on two sides stays (cut/shreds.h)
  dust.cut(cuts);
  const auto& body = dust.block.body;
  const auto pieces = grid::pieces(body.complex);
  int n = 0;
  for (const grid::Crumb& crumb : body.crumbs.all) {
    double volume = 0;
    Vec3 first = Vec3::Zero();
    Mat3 second = Mat3::Zero();
    const auto& surface = dust.block.surface;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
      if (pieces.piece[surface.copies[t]] != pieces.piece[crumb.copies[0]])
        continue;
      const auto& [a, b, c] = surface.triangles[t];
      const Vec3 &p = surface.rest[a], &q = surface.rest[b], &r = surface.rest[c], sum = p + q + r;
      const double v = p.dot(q.cross(r)) / 6;
      volume += v;
      first += v / 4 * sum;
      second += v / 20 * (p * p.transpose() + q * q.transpose() + r * r.transpose() + sum * sum.transpose());
    }
    if (volume < 0.05 * h * h * h)
      continue;
    ++n;
    const CrumbBody made = measure(body, crumb, density);
    const Mat3 around = second - first * first.transpose() / volume;
    const Mat3 inertia = density * (around.trace() * Mat3::Identity() - around);
    EXPECT_NEAR(made.body.mass, density * volume, 1e-11);
    EXPECT_LT((made.body.centre - first / volume).norm(), 1e-11);
    EXPECT_LT((made.body.inertia - inertia).norm(), 1e-9 * inertia.norm());
  }
  EXPECT_GT(n, 10);
}

/// Whatever the backend: to its model their material is not there, no more and no less.
TEST(Crumbs, TakeTheirMassOutOfTheModel) {
  for (const auto& backend : backends) {
    Dust dust;
    const auto physics = make(backend, dust.block.seen());
    auto state = state_at_rest(*physics);
    const double before = sum(physics->model().lumped_mass());
    const auto change = dust.cut();
    physics->follow_cut(dust.block.seen(), change, state);
    ASSERT_EQ(physics->crumbs().size(), 16u);
    const double after = sum(physics->model().lumped_mass());
    EXPECT_NEAR(after + physics->crumbs().mass(), before, backend == "points" ? 0.03 * before : 1e-9 * before)
      << backend;
    for (std::size_t i = 0; i < state.x.size(); ++i)
      if (physics->crumbs().carries(i)) {
        EXPECT_EQ(physics->model().lumped_mass()[i], 0) << backend;
      }
    EXPECT_EQ(state.crumbs.size(), 16u);
  }
}

/// A body that turns and flies is cut: crumbs take position, velocity and rotation of what they were, and all corners
/// stay where they were, as nothing was deformed.
TEST(Crumbs, GoOnAsTheyMoved) {
  const Vec3 omega(1, -2, 3), v(0.3, 0.1, -0.2);
  const Mat3 R = Eigen::AngleAxisd(0.8, Vec3(1, 1, 0).normalized()).toRotationMatrix();
  for (const auto& backend : backends) {
    Dust dust;
    const auto physics = make(backend, dust.block.seen());
    auto state = state_at_rest(*physics);
    for (std::size_t i = 0; i < state.x.size(); ++i) {
      state.x[i] = R * state.x[i] + Vec3(1, 2, 3);
      state.v[i] = v + omega.cross(state.x[i]);
    }
    physics->follow(state);
    const auto change = dust.cut();
    physics->follow_cut(dust.block.seen(), change, state);
    physics->follow(state);
    ASSERT_EQ(physics->crumbs().size(), 16u);
    const Points rest = grid::rest_positions(dust.block.body);
    const Points& corners = physics->corners(state);
    for (std::size_t c = 0; c < rest.size(); ++c)
      EXPECT_LT((corners[c] - (R * rest[c] + Vec3(1, 2, 3))).norm(), 1e-9) << backend << ", corner " << c;
    for (std::size_t b = 0; b < 16; ++b) {
      EXPECT_LT((state.crumbs[b].R - R).norm(), 1e-9) << backend;
      EXPECT_LT((state.crumbs[b].v - v - omega.cross(state.crumbs[b].x)).norm(), 1e-8) << backend;
      EXPECT_LT((dynamics::angular_velocity(physics->crumbs().body(b), state.crumbs[b]) - omega).norm(), 1e-8)
        << backend;
    }
  }
}

/// A cut that meets a crumb gives it another name. It goes on as it did, whatever moves beside it.
TEST(Crumbs, GoOnUnderAnotherName) {
  for (const auto& backend : backends) {
    Dust dust;
    const auto physics = make(backend, dust.block.seen());
    auto state = state_at_rest(*physics);
    physics->follow_cut(dust.block.seen(), dust.cut(), state);
    for (std::size_t b = 0; b < state.crumbs.size(); ++b) {
      state.crumbs[b].v = Vec3(0.2, 0.1 * double(b % 3), -0.3);
      state.crumbs[b].spin = physics->crumbs().body(b).inertia * Vec3(1, 0.5, double(b % 2));
    }
    physics->step(state, {}, 0.01);
    physics->follow(state);
    const auto before = state.crumbs;
    grid::Crumbs& named = dust.block.body.crumbs;
    for (grid::Crumb& crumb : named.all)
      for (const grid::CopyId c : crumb.copies)
        named.of_copy[c.value] = crumb.name + named.n_named;
    for (grid::Crumb& crumb : named.all)
      crumb.name += named.n_named;
    named.n_named *= 2;
    grid::CutChange nothing;
    nothing.n_copies_before = dust.block.body.complex.n_copies();
    nothing.n_corners_before = dust.block.body.complex.n_corners();
    physics->follow_cut(dust.block.seen(), nothing, state);
    ASSERT_EQ(state.crumbs.size(), before.size());
    for (std::size_t b = 0; b < before.size(); ++b) {
      EXPECT_LT((state.crumbs[b].x - before[b].x).norm(), 1e-9) << backend << ", crumb " << b;
      EXPECT_LT((state.crumbs[b].v - before[b].v).norm(), 1e-9) << backend << ", crumb " << b;
      EXPECT_LT((state.crumbs[b].spin - before[b].spin).norm(), 1e-6 * before[b].spin.norm()) << backend;
    }
  }
}

Vec3 momentum(const Physics& physics, const std::span<const double> mass, const dynamics::State& state) {
  Vec3 sum = physics.crumbs().momentum(state);
  for (std::size_t i = 0; i < state.v.size(); ++i)
    sum += mass[i] * state.v[i];
  return sum;
}

/// Crumbs fly on their own for a while, and are joined to the body: they are material again, which bears stress, with
/// the mass and the momentum of all. What is not joined flies on.
TEST(Crumbs, BecomeMaterialAgain) {
  for (const auto& backend : backends) {
    Dust dust;
    const auto physics = make(backend, dust.block.seen());
    auto state = state_at_rest(*physics);
    const double whole = sum(physics->model().lumped_mass());
    physics->follow_cut(dust.block.seen(), dust.cut(), state);
    dynamics::Loads loads;
    loads.gravity = Vec3(0, 0, -9.81);
    for (std::size_t b = 0; b < state.crumbs.size(); ++b) {
      state.crumbs[b].v = Vec3(0.2, 0.1 * double(b % 3), 0);
      state.crumbs[b].spin = physics->crumbs().body(b).inertia * Vec3(0, 0.5, double(b % 2));
    }
    const double dt = 1e-4;
    const auto step = [&](const int n) {
      loads.carried = physics->crumbs().carried();
      for (int i = 0; i < n; ++i)
        physics->step(state, loads, dt);
      physics->follow(state);
    };
    step(200);
    ASSERT_EQ(physics->crumbs().size(), 16u);
    const auto before = state;
    const Vec3 had = momentum(*physics, physics->model().lumped_mass(), state);
    const auto turns = [&] { // of masses at corners, as long as a crumb's are there
      Vec3 L = Vec3::Zero();
      for (std::size_t i = 0; i < state.x.size(); ++i) {
        const double m = physics->model().lumped_mass()[i] + physics->crumbs().carried_mass()[i];
        L += m * state.x[i].cross(state.v[i]);
      }
      return L;
    };
    const Vec3 turned = turns();
    const auto change = dust.join(1);
    physics->follow_cut(dust.block.seen(), change, state);
    physics->follow(state);
    EXPECT_EQ(physics->crumbs().size(), 4u) << backend << ": those that no joined cell has met";
    EXPECT_EQ(grid::n_pieces(dust.block.body.complex), 5u);
    const double material = sum(physics->model().lumped_mass());
    EXPECT_NEAR(material + physics->crumbs().mass(), whole, backend == "points" ? 0.03 * whole : 1e-9 * whole);
    EXPECT_LT((momentum(*physics, physics->model().lumped_mass(), state) - had).norm(), 1e-9 * had.norm()) << backend;
    if (backend == "lattice") { // the others weigh corners otherwise when they are of other copies
      EXPECT_LT((turns() - turned).norm(), 1e-9 * turned.norm()) << backend;
    }
    const auto& lapsed = dust.block.body.complex.lapsed;
    for (std::size_t i = 0; i < state.x.size(); ++i) {
      const bool is_joined =
        physics->particles_are_corners() && std::ranges::any_of(lapsed, [&](const grid::Lapse& lapse) {
          return lapse.corner.value == i || lapse.heir.value == i;
        });
      if (is_joined)
        continue;
      EXPECT_EQ(state.x[i], before.x[i]) << backend << ", " << i;
      EXPECT_LT((state.v[i] - before.v[i]).norm(), 0.03 * had.norm() / whole) << backend << ", " << i;
    }
    step(500);
    for (const Vec3& x : physics->corners(state))
      EXPECT_LT((x - Vec3::Constant(2.5 * h)).norm(), 5 * h) << backend;
  }
}

/// A body that flies as a whole, and turns where the backend's masses are those of the material's shape functions, is
/// ground and put together: nothing has happened to it.
TEST(Crumbs, GiveBackWhatBecomingOneTook) {
  const Vec3 v(0.3, 0.1, -0.2);
  for (const auto& backend : backends) {
    const Vec3 omega = backend == "springs" || backend == "points" ? Vec3(0, 0, 0) : Vec3(1, -2, 3);
    Dust dust;
    const auto physics = make(backend, dust.block.seen());
    auto state = state_at_rest(*physics);
    for (std::size_t i = 0; i < state.x.size(); ++i)
      state.v[i] = v + omega.cross(state.x[i]);
    const auto turns = [&] {
      const std::span<const double> mass = physics->model().lumped_mass();
      Vec3 L = physics->crumbs().angular_momentum(state, Vec3::Zero());
      for (std::size_t i = 0; i < state.x.size(); ++i)
        L += mass[i] * state.x[i].cross(state.v[i]);
      return L;
    };
    physics->follow(state);
    const Vec3 had = momentum(*physics, physics->model().lumped_mass(), state), turned = turns();
    physics->follow_cut(dust.block.seen(), dust.cut(), state);
    physics->follow(state);
    ASSERT_EQ(physics->crumbs().size(), 16u);
    physics->follow_cut(dust.block.seen(), dust.join(2), state);
    EXPECT_EQ(physics->crumbs().size(), 0u);
    for (std::size_t i = 0; i < state.x.size(); ++i)
      EXPECT_LT((state.v[i] - v - omega.cross(state.x[i])).norm(), 1e-9) << backend << ", " << i;
    EXPECT_LT((momentum(*physics, physics->model().lumped_mass(), state) - had).norm(), 1e-9 * had.norm()) << backend;
    if (backend != "elements") { // whose mass is extended where copies hold little, as some at the skin still do
      EXPECT_LT((turns() - turned).norm(), 1e-9 * turned.norm()) << backend;
    }
  }
}

/// Free flight beside a body that is held: exact, for each of them.
TEST(Crumbs, FallBesideABodyThatIsHeld) {
  for (const auto& backend : backends) {
    Dust dust;
    const auto physics = make(backend, dust.block.seen());
    auto state = state_at_rest(*physics);
    const auto change = dust.cut();
    physics->follow_cut(dust.block.seen(), change, state);
    dynamics::Loads loads;
    loads.gravity = Vec3(0, 0, -9.81);
    loads.carried = physics->crumbs().carried();
    const auto start = state.crumbs;
    const double dt = 1e-3;
    for (int i = 0; i < 100; ++i)
      physics->step(state, loads, dt);
    physics->follow(state);
    const double t = 0.1;
    for (std::size_t b = 0; b < start.size(); ++b) {
      EXPECT_NEAR(state.crumbs[b].x[2], start[b].x[2] - 0.5 * 9.81 * t * t, 1e-12) << backend;
      EXPECT_NEAR(state.crumbs[b].v[2], -9.81 * t, 1e-12) << backend;
    }
    for (const Vec3& x : physics->corners(state))
      EXPECT_TRUE(x.allFinite());
  }
}

/// A support that turns and moves takes a crumb along, whose corners it holds; one that holds a direction alone lets it
/// fall along the others.
TEST(Crumbs, GoWithSupports) {
  Dust dust;
  const auto physics = make("elements", dust.block.seen());
  auto state = state_at_rest(*physics);
  const auto change = dust.cut();
  physics->follow_cut(dust.block.seen(), change, state);
  const auto& crumbs = dust.block.body.crumbs.all;
  dynamics::Loads loads;
  loads.gravity = Vec3(0, 0, -9.81);
  loads.carried = physics->crumbs().carried();
  const auto hold = [&](const std::size_t b, const Mat3& held, const auto& displacement, const auto& rotation) {
    dynamics::Support support{{}, {}, displacement, rotation, held};
    const CrumbBody made = measure(dust.block.body, crumbs[b], density);
    support.corners = made.corners;
    support.rest = made.rest_of_corners;
    loads.supports.push_back(support);
  };
  hold(
    0, Mat3::Identity(), [](const double t) { return Vec3(t * t, 0, 0); },
    [](const double t) { return Eigen::AngleAxisd(t, Vec3::UnitZ()).toRotationMatrix(); });
  hold(
    1, dynamics::held_axes("z"), [](double) { return Vec3(Vec3::Zero()); }, std::function<Mat3(double)>());
  state.crumbs[1].v = Vec3(0.5, 0, 0);
  const auto start = state.crumbs;
  const double dt = 1e-3;
  for (int i = 0; i < 200; ++i)
    physics->step(state, loads, dt);
  const double t = state.time;
  const Mat3 R = Eigen::AngleAxisd(t, Vec3::UnitZ()).toRotationMatrix();
  EXPECT_LT((state.crumbs[0].x - (R * start[0].x + Vec3(t * t, 0, 0))).norm(), 1e-10);
  EXPECT_LT((state.crumbs[0].R - R).norm(), 1e-10);
  EXPECT_NEAR(state.crumbs[1].x[2], start[1].x[2], 1e-12);
  EXPECT_NEAR(state.crumbs[1].x[0], start[1].x[0] + 0.5 * t, 1e-9);
  EXPECT_NEAR(physics->crumbs().reactions()[1].force[2], 9.81 * physics->crumbs().body(1).mass, 1e-9)
    << "the second one's weight";
  EXPECT_LT(state.crumbs[2].x[2], start[2].x[2] - 0.19) << "nothing holds the third";
}

/// A handle pulls a crumb: it comes to rest where spring and weight balance, whatever the stiffness; all of the energy
/// that it had goes into the integrator's damping.
TEST(Crumbs, SettleWhereLoadsBalanceTheirWeight) {
  for (const double stiffness : {1e2, 1e6}) {
    Dust dust;
    const auto physics = make("elements", dust.block.seen());
    auto state = state_at_rest(*physics);
    const auto change = dust.cut();
    physics->follow_cut(dust.block.seen(), change, state);
    dynamics::Loads loads;
    loads.gravity = Vec3(0, 0, -9.81);
    loads.mass_damping = 5;
    loads.carried = physics->crumbs().carried();
    const dynamics::RigidBody& body = physics->crumbs().body(3);
    const auto& copy = dust.block.body.complex.copies[dust.block.body.crumbs.all[3].copies[0]];
    std::array<std::uint32_t, 8> corners;
    std::array<double, 8> weights;
    const Vec3 origin = dust.block.body.grid.origin(copy.cell);
    for (int a = 0; a < 8; ++a) {
      corners[a] = copy.corners[a].value;
      const Vec3 xi = (body.centre - origin) / h;
      weights[a] = (a & 1 ? xi[0] : 1 - xi[0]) * (a >> 1 & 1 ? xi[1] : 1 - xi[1]) * (a >> 2 & 1 ? xi[2] : 1 - xi[2]);
    }
    Interpolation at_centre;
    at_centre.add_row(corners, weights);
    const Vec3 place = body.centre + Vec3(0.01, 0, 0.02);
    loads.acting.push_back(
      std::make_unique<dynamics::HandleSpring>(at_centre, stiffness, [=](double) { return place; }));
    for (int i = 0; i < 4000; ++i)
      physics->step(state, loads, 1e-3);
    const Vec3 sag = Vec3(0, 0, -9.81) * body.mass / stiffness;
    EXPECT_LT((state.crumbs[3].x - place - sag).norm(), 1e-3 * sag.norm() + 1e-9) << stiffness;
    EXPECT_LT(state.crumbs[3].v.norm(), 1e-4);
  }
}

} // namespace
} // namespace kerf::physics::crumbs_test
