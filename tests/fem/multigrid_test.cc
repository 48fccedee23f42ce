/// Multigrid on copies: symmetric, positive, and as good for large bodies as for small ones, however they are cut.

#include "fem/multigrid.h"

#include "base/parallel.h"
#include "cut/cutter.h"
#include "dynamics/conjugate_gradients.h"
#include "dynamics/state.h"
#include "grid/shape.h"
#include "tests/fem/models.h"
#include "tests/support/spectrum.h"

#include <gtest/gtest.h>

namespace kerf::fem::multigrid_test {
namespace {

using dynamics::Constraints;
using dynamics::flat;
using Matrix = Eigen::MatrixXd;

material::Elastic rubber(const double nu) { return {.density = 1000, .youngs_modulus = 1e5, .poissons_ratio = nu}; }

/// Supports that hold corners along directions, where they are.
dynamics::Loads holding(const Body& body, const std::function<bool(const Vec3&)>& is_held, const Mat3& held) {
  dynamics::Loads loads;
  dynamics::Support support;
  support.displacement = [](double) { return Vec3(Vec3::Zero()); };
  support.held = held;
  const Points rest = body.rest();
  for (std::uint32_t c = 0; c < rest.size(); ++c)
    if (is_held(rest[c])) {
      support.corners.push_back(c);
      support.rest.push_back(rest[c]);
    }
  loads.supports.push_back(support);
  return loads;
}
dynamics::Loads clamped_below(const Body& body, const double z) {
  return holding(
    body, [z](const Vec3& X) { return X[2] < z; }, Mat3::Identity());
}

/// Springs at points that follow corners.
struct Springs {
  Interpolation points;
  dynamics::LoadTangent tangent;

  Springs() = default;
  /// [N/m] each.
  Springs(Interpolation of, const double stiffness) : points(std::move(of)) {
    for (std::size_t i = 0; i < points.n_points(); ++i)
      tangent.add(points, i, i, stiffness * Mat3::Identity());
  }
  Springs(const Springs&) = delete;
};

/// Points in the middle of the edges along z of the lowest cells.
Interpolation middles_below(const Body& body) {
  const double lowest = std::ranges::min(body.rest(), {}, [](const Vec3& X) { return X[2]; })[2];
  const Points rest = body.rest();
  constexpr std::array<double, 2> halves = {0.5, 0.5};
  Interpolation points;
  for (const grid::Copy& copy : body.complex.copies)
    for (int v = 0; v < 4; ++v)
      if (const std::array<std::uint32_t, 2> ends = {copy.corners[v].value, copy.corners[v + 4].value};
          rest[ends[0]][2] < lowest + 1e-9)
        points.add_row(ends, halves);
  return points;
}

/// Points anywhere in copies.
Interpolation points_anywhere(const Body& body, const int n, Draw& draw) {
  Interpolation points;
  for (int i = 0; i < n; ++i) {
    const auto& copies = body.complex.copies;
    const grid::Copy& copy = copies[grid::CopyId{static_cast<std::uint32_t>(draw(0, 0.999) * double(copies.size()))}];
    const Vec3 xi(draw(0, 1), draw(0, 1), draw(0, 1));
    std::array<std::uint32_t, 8> corners;
    std::array<double, 8> weights;
    for (int v = 0; v < 8; ++v) {
      corners[v] = copy.corners[v].value;
      weights[v] = grid::shape(v, xi);
    }
    points.add_row(corners, weights);
  }
  return points;
}

/// The equation of a model at x, with what it needs beside it.
struct Equation {
  Hexahedra& model;
  const Constraints constraints;
  double mass_factor;
  Springs springs;
  std::vector<Mat3> blocks;

  Equation(Hexahedra& of, const dynamics::Loads& loads, const Points& x, const double mass,
           const Interpolation& points = {}, const double stiffness = 0)
    : model(of), constraints(loads, x.size()), mass_factor(mass), springs(points, stiffness) {
    model.linearise(x);
    blocks = dynamics::stiffness_blocks(model);
    springs.tangent.add_diagonal(blocks);
    for (std::size_t i = 0; i < blocks.size(); ++i)
      blocks[i] += mass_factor * model.lumped_mass()[i] * Mat3::Identity();
  }
  dynamics::Preconditioner& multigrid() {
    dynamics::Preconditioner* const found =
      model.preconditioner({mass_factor, 1, model.lumped_mass(), trace(), springs.tangent, constraints});
    if (!found)
      throw std::logic_error("no multigrid");
    return *found;
  }
  double trace() const {
    double sum = 0;
    for (const Mat3& block : blocks)
      sum += block.trace();
    return sum;
  }
  void project(const std::span<double> y) const {
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      Eigen::Map<Vec3> v(y.data() + 3 * i);
      v = (constraints.freedom(i).project * v).eval();
    }
  }
  void apply(const std::span<const double> p, const std::span<double> y) const {
    model.apply_stiffness(p, y);
    springs.tangent.add_product(p, y);
    for (std::size_t i = 0; i < y.size(); ++i)
      y[i] += mass_factor * model.lumped_mass()[i / 3] * p[i];
    project(y);
  }
  void apply_inverse_blocks(const std::span<const double> r, const std::span<double> z) const {
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      const Mat3 S = dynamics::inverse_factor(blocks[i], constraints.freedom(i));
      Eigen::Map<Vec3>(z.data() + 3 * i) = S.transpose() * (S * Eigen::Map<const Vec3>(r.data() + 3 * i));
    }
  }
  /// For conjugate gradients, as long as this stands.
  dynamics::CgEquation by_multigrid() {
    return {[this](const auto p, const auto y) { apply(p, y); },
            [&own = multigrid()](const auto r, const auto y) { own.apply(r, y); },
            [this](const auto r, const auto y) { apply_inverse_blocks(r, y); }};
  }
  /// Accelerations drawn at random, which have every wavelength, times the masses.
  Points load(Draw& draw) const {
    Points b(blocks.size());
    for (std::size_t i = 0; i < b.size(); ++i)
      b[i] = model.lumped_mass()[i] * draw.vector();
    project(flat(b));
    return b;
  }
};

/// To 1e-6 of a right-hand side drawn at random.
dynamics::CgReport solve(Equation& equation, const unsigned seed) {
  Draw draw(seed);
  const Points b = equation.load(draw);
  Points x(b.size(), Vec3::Zero()), z(b.size());
  equation.apply_inverse_blocks(flat(b), flat(z));
  return dynamics::conjugate_gradients(equation.by_multigrid(), flat(b),
                                       {.residual = 1e-6 * std::sqrt(dynamics::dot(flat(b), flat(z)))}, 400, flat(x));
}

Points disturbed(const Body& body, const double size, Draw& draw) {
  const Mat3 R = draw.rotation();
  Points x = body.rest();
  for (Vec3& p : x)
    p = R * p + size * draw.vector();
  return x;
}

/// B among the free directions, column by column, with each corner measured by its block of A.
Matrix scaled_inverse(Equation& equation) {
  const auto n = static_cast<Eigen::Index>(3 * equation.blocks.size());
  auto& own = equation.multigrid();
  std::vector<Mat3> L;
  for (std::size_t i = 0; i < equation.blocks.size(); ++i)
    L.push_back(equation.blocks[i].llt().matrixL());
  Matrix B(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    Eigen::VectorXd r = Eigen::VectorXd::Zero(n), z(n);
    r.segment<3>(3 * (j / 3)) = L[j / 3].col(j % 3);
    own.apply({r.data(), r.data() + n}, {z.data(), z.data() + n});
    for (Eigen::Index i = 0; i < n / 3; ++i)
      B.block<3, 1>(3 * i, j) = L[i].transpose() * z.segment<3>(3 * i);
  }
  return B;
}

TEST(Multigrid, IsSymmetricAndPositiveForAnyCut) {
  double least = 1e300;
  for (int n = 0; n < 6; ++n) {
    Draw draw(300 + n);
    const double near = n % 3 == 0 ? 1e-9 : 0.1;
    Body body = make_block({5, 5, 4}, 0.1, draw, {near, 1 - near});
    cut_at_random(body, 0.03 * n, draw, {near, 1 - near});
    Hexahedra model(
      body, {.material = rubber(n % 2 == 0 ? 0.3 : 0.49), .strain = n % 4 == 0 ? Strain::enhanced : Strain::trilinear});
    const Mat3 held = n % 2 == 0 ? Mat3(Mat3::Identity()) : Mat3(Vec3(1, 2, 3) * Vec3(1, 2, 3).transpose() / 14);
    const dynamics::Loads loads = holding(
      body, [](const Vec3& X) { return X[2] < 0.15 || (X - Vec3(0.5, 0, 0.4)).norm() < 0.15; }, held);
    const Points x = disturbed(body, 0.01, draw);
    Equation equation(model, loads, x, n % 4 == 3 ? 0 : 20, points_anywhere(body, n % 2 == 0 ? 0 : 30, draw), 1e6);
    const Matrix B = scaled_inverse(equation);
    EXPECT_LT((B - B.transpose()).norm(), 2e-4 * B.norm()) << n;
    const Eigen::VectorXd values = support::spectrum(0.5 * (B + B.transpose()));
    Eigen::Index n_held = 0;
    for (std::size_t i = 0; i < equation.blocks.size(); ++i)
      n_held += 3 - equation.constraints.freedom(i).n_free;
    EXPECT_GT(n_held, 0);
    EXPECT_LT(values.head(n_held).cwiseAbs().maxCoeff(), 1e-5 * values[values.size() - 1]) << n;
    // Block Jacobi alone has 1. Blocks bound springs that couple corners by the sum of these.
    EXPECT_GT(values[n_held], n % 2 == 0 ? 0.05 : 0.01) << n;
    least = std::min(least, values[n_held]);
  }
  RecordProperty("least_of_block_jacobi", std::to_string(least));
}

/// Cubes of up to 30,000 elements, in statics, and with the inertia of a step in which sound crosses the body.
TEST(Multigrid, TakesAsManyIterationsForLargeBodies) {
  for (const double mass_factor : {0.0, 10.0})
    for (const double nu : {0.3, 0.45}) {
      std::vector<int> counts;
      for (const int n : {7, 15, 30}) {
        Draw draw(320);
        const double h = 1.0 / n;
        Body body = make_block({n, n, n}, h, draw, {0.3, 0.7});
        Hexahedra model(body, {.material = rubber(nu)});
        Equation equation(model, clamped_below(body, 0.1 + 0.1), body.rest(), mass_factor);
        const auto report = solve(equation, 321);
        EXPECT_TRUE(report.converged);
        counts.push_back(report.n_iterations);
      }
      RecordProperty("iterations_nu_" + std::to_string(nu) + "_mass_" + std::to_string(mass_factor),
                     std::to_string(counts[0]) + " " + std::to_string(counts[1]) + " " + std::to_string(counts[2]));
      EXPECT_LE(counts[2], 1.2 * counts[0] + 4) << nu << ' ' << mass_factor << ": " << counts[0] << ' ' << counts[1];
      EXPECT_LE(counts[2], nu < 0.4 ? 20 : 40);
    }
}

/// Cubes whose lower skin, halfway between nodes, is held by springs of ten times the stiffness of a cube each.
TEST(Multigrid, KnowsSkinsThatAreHeld) {
  std::vector<int> counts;
  for (const int n : {7, 15, 30}) {
    Draw draw(325);
    const double h = 1.0 / n;
    Body body = make_block({n, n, n}, h, draw, {0.3, 0.7});
    const material::Elastic material = rubber(0.3);
    Hexahedra model(body, {.material = material});
    Equation equation(model, {}, body.rest(), 0, middles_below(body), 10 * material.youngs_modulus * h);
    const auto report = solve(equation, 326);
    EXPECT_TRUE(report.converged);
    counts.push_back(report.n_iterations);
  }
  RecordProperty("iterations",
                 std::to_string(counts[0]) + " " + std::to_string(counts[1]) + " " + std::to_string(counts[2]));
  EXPECT_LE(counts[2], 1.2 * counts[0] + 4) << counts[0] << ' ' << counts[1];
  EXPECT_LE(counts[2], 12);
}

/// A block of which more and more edges are cut, three tenths of them after two rounds, until it is dust: random cuts
/// leave a sponge, which coarse cubes know less of than of a body that a blade has cut.
TEST(Multigrid, SeesCutsOnEveryLevel) {
  std::vector<int> counts;
  Draw draw(330);
  Body body = make_block({16, 16, 16}, 0.05, draw, {0.3, 0.7});
  for (int n = 0; n < 6; ++n) {
    Hexahedra model(body, {.material = rubber(0.3)});
    Equation equation(model, clamped_below(body, 0.3), body.rest(), 36);
    const auto report = solve(equation, 331);
    EXPECT_TRUE(report.converged);
    counts.push_back(report.n_iterations);
    cut_at_random(body, 0.15, draw, {0.1, 0.9});
  }
  std::string all;
  for (const int count : counts)
    all += std::to_string(count) + ' ';
  RecordProperty("iterations", all);
  EXPECT_LE(counts[1], 12) << all;
  EXPECT_LE(counts[2], 30) << all;
  EXPECT_LE(*std::max_element(counts.begin(), counts.end()), 100) << all;
}

/// Where the error over the way is to end an iteration, it ends by what is left, at most two iterations late.
TEST(Multigrid, TellsWhatErrorIsLeft) {
  constexpr int most = 24;
  int n_late = 0, n_all = 0;
  for (int n = 0; n < 3; ++n) {
    Draw draw(335 + n);
    Body body = make_block({8, 7, 7}, 0.1, draw, {0.2, 0.8});
    cut_at_random(body, 0.05 * n, draw, {0.2, 0.8});
    Hexahedra model(body, {.material = rubber(n == 0 ? 0.45 : 0.3)});
    Equation equation(model, clamped_below(body, 0.3), body.rest(), 36);
    const Points b = equation.load(draw);
    const dynamics::CgEquation cg = equation.by_multigrid();
    const auto solved = [&](const dynamics::CgStop& stop, const int n_most, dynamics::CgReport& report) {
      Points x(b.size(), Vec3::Zero());
      report = dynamics::conjugate_gradients(cg, flat(b), stop, n_most, flat(x));
      return x;
    };
    const auto size = [&](const Points& e) {
      Points Ae(e.size());
      equation.apply(flat(e), flat(Ae));
      return std::sqrt(dynamics::dot(flat(e), flat(Ae)));
    };
    dynamics::CgReport report;
    const Points exact = solved({.residual = 1e-13}, 60, report);
    std::vector<double> left; // after so many iterations
    for (int k = 0; k < most; ++k) {
      Points e = solved({}, k, report);
      for (std::size_t i = 0; i < e.size(); ++i)
        e[i] -= exact[i];
      left.push_back(size(e));
    }
    for (const double part : {1e-1, 1e-2, 1e-3, 1e-4}) {
      solved({.of_way = part}, 60, report);
      ASSERT_TRUE(report.converged);
      ASSERT_LT(report.n_iterations, most);
      EXPECT_LE(left[report.n_iterations], part * left[0]) << n;
      const auto enough = std::ranges::find_if(left, [&](const double e) { return e <= part * left[0]; });
      const auto late = report.n_iterations - std::max(2, static_cast<int>(enough - left.begin()));
      EXPECT_LE(late, 2) << n << ' ' << part;
      n_late += late;
      ++n_all;
    }
  }
  RecordProperty("late_by", std::to_string(double(n_late) / n_all));
  EXPECT_LT(n_late, n_all);
}

/// The way may count from elsewhere than from the guess: from where nothing would be, as here from zero.
TEST(Multigrid, CountsTheWayFromWhereItIsTold) {
  Draw draw(347);
  Body body = make_block({7, 7, 7}, 0.1, draw, {0.3, 0.7});
  Hexahedra model(body, {.material = rubber(0.3)});
  Equation equation(model, clamped_below(body, 0.3), body.rest(), 36);
  const Points b = equation.load(draw);
  const dynamics::CgEquation cg = equation.by_multigrid();
  Points exact(b.size(), Vec3::Zero());
  const auto full = dynamics::conjugate_gradients(cg, flat(b), {.residual = 1e-12}, 60, flat(exact));
  Points near = exact; // a hundredth of the way is left
  for (Vec3& x : near)
    x *= 0.99;
  Points x = near;
  int n_asked = 0;
  const auto from_zero = [&](const double least) {
    return dynamics::WayFrom{[&](std::span<double>) { return ++n_asked, 0.0; }, [=] { return least; }};
  };
  const auto of_all =
    dynamics::conjugate_gradients(cg, flat(b), {.of_way = 1e-3, .from = from_zero(0)}, 60, flat(x));
  EXPECT_NEAR(of_all.way, full.way, 1e-3 * full.way);
  EXPECT_EQ(n_asked, 1);
  x = near; // where it is known that the way is long enough, no potential is asked for
  const auto of_least =
    dynamics::conjugate_gradients(cg, flat(b), {.of_way = 1e-3, .from = from_zero(10 * full.way)}, 60, flat(x));
  EXPECT_LE(of_least.n_iterations, of_all.n_iterations);
  EXPECT_EQ(of_least.way, 10 * full.way);
  EXPECT_EQ(n_asked, 1);
  x = near;
  const auto of_rest = dynamics::conjugate_gradients(cg, flat(b), {.of_way = 1e-3}, 60, flat(x));
  EXPECT_NEAR(of_rest.way, 0.01 * full.way, 1e-5 * full.way);
  EXPECT_LT(of_all.n_iterations, of_rest.n_iterations);
}

/// What is left of the right side is told, however many iterations there were.
TEST(Multigrid, TellsWhatIsLeftOfTheRightSide) {
  Draw draw(349);
  Body body = make_block({7, 7, 7}, 0.1, draw, {0.3, 0.7});
  Hexahedra model(body, {.material = rubber(0.3)});
  Equation equation(model, clamped_below(body, 0.3), body.rest(), 36);
  const Points b = equation.load(draw);
  for (const int n_most : {0, 1, 5}) {
    Points x(b.size(), Vec3::Zero()), left(b.size()), Ax(b.size());
    dynamics::conjugate_gradients(equation.by_multigrid(), flat(b), {}, n_most, flat(x), flat(left));
    equation.apply(flat(x), flat(Ax));
    double most = 0;
    for (std::size_t i = 0; i < b.size(); ++i)
      most = std::max(most, (b[i] - Ax[i] - left[i]).norm());
    EXPECT_LE(most, 1e-12 * std::sqrt(dynamics::dot(flat(b), flat(b)))) << n_most;
  }
}

/// A plane that parts a body parts its coarse copies: two halves know nothing of each other, at any level.
TEST(Multigrid, HalvesKnowNothingOfEachOther) {
  Draw draw(340);
  Body body = make_block({9, 9, 9}, 0.1, draw, {0.5, 0.5});
  cut_plane(body, 0, 5, 0.5);
  Hexahedra model(body, {.material = rubber(0.3)});
  Equation equation(model, clamped_below(body, 0.1), body.rest(), 36);
  const auto pieces = grid::pieces(body.complex);
  std::vector<std::uint32_t> piece(body.complex.n_corners());
  for (const auto c : ids<grid::CopyId>(body.complex.n_copies()))
    for (const auto corner : body.complex.copies[c].corners)
      piece[corner.value] = pieces.piece[c];
  ASSERT_EQ(pieces.n_pieces, 2u);
  Points r(piece.size()), z(piece.size());
  for (std::size_t i = 0; i < r.size(); ++i)
    r[i] = piece[i] == 0 ? draw.vector() : Vec3(Vec3::Zero());
  equation.multigrid().apply(flat(r), flat(z));
  double here = 0;
  for (std::size_t i = 0; i < r.size(); ++i)
    if (piece[i] == 0)
      here += z[i].norm();
    else
      EXPECT_EQ(z[i], Vec3(Vec3::Zero()));
  EXPECT_GT(here, 0);
}

/// A disc whose front lies inside cells, most of them hardly passed: ties as stiff as the cells that they hold
/// together.
TEST(Multigrid, KnowsTies) {
  std::array<int, 2> counts{};
  for (const cut::Fronts fronts : {cut::Fronts::at_faces, cut::Fronts::of_elements}) {
    Draw draw(345);
    Body body = make_block({16, 16, 16}, 0.05, draw, {0.3, 0.7});
    cut::Cutter cutter(1, cut::Release::queued, fronts);
    cutter.begin(body, body.rest());
    const cut::Disc disc{Vec3(0.72, 0.23, 0.52), Vec3(0.1, 0.2, 1).normalized(), 0.22};
    surface::place(body, cutter.at_once(body, {"cut", disc, 1}, body.rest()), {});
    EXPECT_EQ(fronts == cut::Fronts::of_elements, body.complex.tied.size() > 30);
    Hexahedra model(body, {.material = rubber(0.3)});
    Equation equation(model, clamped_below(body, 0.3), body.rest(), 36);
    const auto report = solve(equation, 346);
    EXPECT_TRUE(report.converged);
    counts[fronts == cut::Fronts::of_elements] = report.n_iterations;
  }
  RecordProperty("iterations", std::to_string(counts[0]) + ' ' + std::to_string(counts[1]));
  EXPECT_LE(counts[1], counts[0] + 3) << counts[0];
}

/// Bits do not depend on threads, nor on whether a cut was followed or the model built anew. So many cells that a second
/// thread has work in products and on the finest levels.
TEST(Multigrid, GivesTheSameBitsByAnyWay) {
  Draw draw(350);
  Body body = make_block({29, 28, 30}, 0.1, draw, {0.3, 0.7});
  Hexahedra followed(body, {.material = rubber(0.3)});
  Points x = body.rest();
  Equation(followed, clamped_below(body, 0.3), x, 36).multigrid();
  std::vector<grid::EdgeId> edges;
  for (const auto e : inner_edges(body))
    if (draw(0, 1) < 0.1) {
      body.cuts.add(body.grid, {e, draw(0.1, 0.9), draw.vector().normalized(), 1});
      edges.push_back(e);
    }
  surface::place(body, {});
  followed.update(body, grid::update_complex(body, edges).reshaped);
  Hexahedra anew(body, {.material = rubber(0.3)});
  x = disturbed(body, 0.01, draw);
  Points r(x.size()), reference;
  for (Vec3& value : r)
    value = draw.vector();
  const int n_before = n_threads();
  for (Hexahedra* const model : {&followed, &anew})
    for (const int n : {1, 2}) {
      set_n_threads(n);
      Points z(x.size());
      Equation(*model, clamped_below(body, 0.3), x, 36).multigrid().apply(flat(r), flat(z));
      if (reference.empty())
        reference = z;
      EXPECT_EQ(z, reference) << n;
    }
  set_n_threads(n_before);
}

/// Cuts that reach little of a body, one after the other, and one that is followed only with the next.
TEST(Multigrid, FollowsSmallCutsBitByBit) {
  Draw draw(352);
  Body body = make_block({11, 10, 11}, 0.1, draw, {0.3, 0.7});
  Hexahedra followed(body, {.material = rubber(0.3)});
  const auto inner = inner_edges(body);
  for (int n = 0; n < 4; ++n) {
    if (n != 2)
      Equation(followed, clamped_below(body, 0.3), body.rest(), 36).multigrid();
    std::vector<grid::EdgeId> edges;
    const std::size_t first = inner.size() * static_cast<std::size_t>(n + 1) / 6;
    for (std::size_t k = first; k < first + 20; ++k) {
      body.cuts.add(body.grid, {inner[k], draw(0.1, 0.9), draw.vector().normalized(), 1});
      edges.push_back(inner[k]);
    }
    surface::place(body, {});
    followed.update(body, grid::update_complex(body, edges).reshaped);
    Hexahedra anew(body, {.material = rubber(0.3)});
    const Points x = disturbed(body, 0.01, draw);
    Points r(x.size()), by_following(x.size()), by_building(x.size());
    for (Vec3& value : r)
      value = draw.vector();
    if (n != 1)
      Equation(followed, clamped_below(body, 0.3), x, 36).multigrid().apply(flat(r), flat(by_following));
    Equation(anew, clamped_below(body, 0.3), x, 36).multigrid().apply(flat(r), flat(by_building));
    EXPECT_EQ(n == 1 ? by_building : by_following, by_building) << n;
  }
}

} // namespace
} // namespace kerf::fem::multigrid_test
