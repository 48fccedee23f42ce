/// What nearly incompressible elements have against changes of volume, apart from the rest.

#include "fem/dilatation.h"

#include "dynamics/minimal_residuals.h"
#include "dynamics/state.h"
#include "fem/turned.h"
#include "tests/fem/models.h"

#include <gtest/gtest.h>

namespace kerf::fem::dilatation_test {
namespace {

using dynamics::flat;

material::Elastic tissue(const double nu, const std::string& law) {
  return {.density = 1000, .youngs_modulus = 1e5, .poissons_ratio = nu, .law = law};
}

/// Clamped below, cut at random, with skin anywhere.
struct Scene {
  Draw draw;
  Body body;
  Hexahedra model;
  dynamics::Loads loads;
  dynamics::LoadTangent tangent;
  Points x;
  std::unique_ptr<dynamics::Constraints> constraints;

  Scene(const unsigned seed, const Index3& n, const double nu, const std::string& law, const double cuts,
        const Strain strain = Strain::enhanced)
    : draw(seed), body(make(n, cuts)), model(body, {.material = tissue(nu, law), .strain = strain}) {
    dynamics::Support support;
    support.displacement = [](double) { return Vec3(Vec3::Zero()); };
    x = body.rest();
    for (std::uint32_t c = 0; c < x.size(); ++c)
      if (x[c][2] < 0.25) {
        support.corners.push_back(c);
        support.rest.push_back(x[c]);
      }
    loads.supports.push_back(support);
    constraints = std::make_unique<dynamics::Constraints>(loads, x.size());
    const Mat3 R = draw.rotation();
    for (Vec3& p : x)
      p = R * p + 0.01 * draw.vector();
    model.linearise(x);
  }
  Body make(const Index3& n, const double cuts) {
    Body made = make_block(n, 0.1, draw, {0.05, 0.95});
    cut_at_random(made, cuts, draw, {0.05, 0.95});
    return made;
  }
  dynamics::Preconditioner* preconditioner(const double mass_factor = 0) {
    double trace = 0;
    for (const Mat3& block : dynamics::stiffness_blocks(model))
      trace += block.trace();
    return model.preconditioner({mass_factor, 1, model.lumped_mass(), trace, tangent, *constraints});
  }
  Points drawn() {
    Points p(x.size());
    for (Vec3& v : p)
      v = draw.vector();
    return p;
  }
};

/// K = A + C^T C, with the A of elements that have the mean stiffness of the other material.
TEST(Dilatation, IsWhatMultigridLeavesOut) {
  for (const std::string law : {"small strain", "corotational"})
    for (int n = 0; n < 3; ++n) {
      const double nu = n == 2 ? 0.4999 : 0.495;
      Scene scene(40 + n, {5, 5, 6}, nu, law, 0.05 * n);
      dynamics::Preconditioner* const own = scene.preconditioner();
      ASSERT_NE(own, nullptr);
      const dynamics::StiffPart* const stiff = own->stiff_part();
      ASSERT_NE(stiff, nullptr);
      const Points p = scene.drawn();
      std::vector<double> Kp(3 * p.size()), Cp(stiff->n_rows()), CCp(3 * p.size(), 0), q(stiff->n_rows());
      scene.model.apply_stiffness(flat(p), Kp);
      stiff->product(flat(p), Cp);
      stiff->add_transposed(Cp, CCp);
      const material::Elastic rest = without_excess(scene.model.material(), Strain::enhanced).value();
      EXPECT_DOUBLE_EQ(rest.mu(), scene.model.material().mu());
      EXPECT_LT(rest.lambda(), 0.3 * scene.model.material().lambda());
      double square = 0, of_changes = 0;
      std::vector<double> Ap(3 * p.size(), 0);
      for (std::size_t c = 0; c < scene.model.n_elements(); ++c) {
        if (!scene.model.incidence().is_used(c))
          continue;
        const Element& element = scene.model.element(c);
        const std::uint32_t* const corners = scene.model.incidence().corners(c);
        std::array<Vec3, 8> at;
        Vector24 u;
        Mat3 G = Mat3::Zero();
        for (int a = 0; a < 8; ++a) {
          at[a] = scene.x[corners[a]];
          u.segment<3>(3 * a) = p[corners[a]];
          G += p[corners[a]] * element.gradient(a).transpose();
        }
        const Mat3 R = turned(element, scene.model.h(), at, scene.model.frame()).R.cast<float>().cast<double>();
        const Vector24 f = turned_stiffness(stiffness(element, rest), R) * u;
        for (int a = 0; a < 8; ++a)
          Eigen::Map<Vec3>(Ap.data() + 3 * corners[a]) += f.segment<3>(3 * a);
        const double change = R.cwiseProduct(G).sum();
        square += (scene.model.material().lambda() - rest.lambda()) * element.volume * change * change;
        of_changes += u.dot(f);
      }
      scene.model.ghost_penalty().add_product(flat(p), Ap);
      EXPECT_GT(square, of_changes) << "it is most of the stiffness";
      EXPECT_NEAR(dynamics::dot(Cp, Cp), square, 1e-9 * square) << law << ", " << n;
      const double size = std::sqrt(dynamics::dot(Kp, Kp));
      for (std::size_t i = 0; i < Kp.size(); ++i)
        ASSERT_NEAR(Kp[i] - CCp[i], Ap[i], 1e-9 * size) << law << ", " << n << ": " << i;
      for (double& value : q)
        value = scene.draw.normal();
      std::vector<double> Cq(3 * p.size(), 0);
      stiff->add_transposed(q, Cq);
      EXPECT_NEAR(dynamics::dot(Cq, flat(p)), dynamics::dot(q, Cp), 1e-9 * std::sqrt(square * dynamics::dot(q, q)));
    }
}

/// Only where that pays: in statics of enhanced elements by Hooke's law, nu above .49.
TEST(Dilatation, StaysWhereItHelpsNothing) {
  const auto is_left_out = [](const double nu, const std::string& law, const Strain strain, const double mass_factor) {
    Scene scene(50, {5, 5, 6}, nu, law, 0, strain);
    dynamics::Preconditioner* const own = scene.preconditioner(mass_factor);
    EXPECT_NE(own, nullptr) << nu << ", " << law;
    return own && own->stiff_part();
  };
  EXPECT_TRUE(is_left_out(0.499, "corotational", Strain::enhanced, 0));
  EXPECT_FALSE(is_left_out(0.49, "corotational", Strain::enhanced, 0));
  EXPECT_FALSE(is_left_out(0.499, "corotational", Strain::trilinear, 0));
  EXPECT_FALSE(is_left_out(0.499, "neo-Hookean", Strain::enhanced, 0));
  EXPECT_FALSE(is_left_out(0.499, "corotational", Strain::enhanced, 1));
}

std::vector<double> applied(dynamics::Preconditioner& own, const Points& r) {
  std::vector<double> z(3 * r.size());
  own.apply(flat(r), z);
  return z;
}

/// A model that is asked for statics and for steps by turns has the multigrid of each, linearised anew or not.
TEST(Dilatation, FollowsWhatIsAsked) {
  const auto make = [] { return std::make_unique<Scene>(60, Index3{5, 5, 6}, 0.499, "corotational", 0.05); };
  const auto steps = make(), statics = make(), by_turns = make();
  const Points r = steps->drawn();
  const std::vector<double> of_steps = applied(*steps->preconditioner(1), r),
                            of_statics = applied(*statics->preconditioner(0), r);
  EXPECT_NE(of_steps, of_statics);
  for (const bool anew : {false, true})
    for (const double mass_factor : {0., 1., 1., 0., 0.}) {
      if (anew)
        by_turns->model.linearise(by_turns->x);
      dynamics::Preconditioner* const own = by_turns->preconditioner(mass_factor);
      ASSERT_NE(own, nullptr);
      EXPECT_EQ(own->stiff_part() != nullptr, mass_factor == 0);
      EXPECT_EQ(applied(*own, r), mass_factor == 0 ? of_statics : of_steps) << anew << ", " << mass_factor;
    }
}

/// Multigrid and what it leaves out, after each of several cuts in places.
TEST(Dilatation, FollowsCutsBitByBit) {
  Draw draw(80);
  Body body = make_block({6, 6, 6}, 0.1, draw, {0.1, 0.9});
  const HexahedraOptions options{.material = tissue(0.4999, "corotational"), .strain = Strain::enhanced};
  Hexahedra model(body, options);
  const auto answers = [](Hexahedra& of, const Points& x, const Points& r) {
    const dynamics::Constraints free({}, x.size());
    of.linearise(x);
    const auto blocks = dynamics::stiffness_blocks(of);
    dynamics::Preconditioner* const own = of.preconditioner({0, 1, of.lumped_mass(), 1, {}, free});
    if (!own || !own->stiff_part())
      throw std::logic_error("nothing is left out");
    std::vector<double> all = applied(*own, r), q(own->stiff_part()->n_rows());
    own->stiff_part()->product(flat(r), q);
    own->stiff_part()->add_transposed(q, all);
    return all;
  };
  for (int step = 0; step < 5; ++step) {
    std::vector<grid::EdgeId> edges;
    for (const grid::EdgeId e : inner_edges(body))
      if (draw(0, 1) < (step == 0 ? 0 : 0.02)) {
        body.cuts.add(body.grid, {e, draw(0.1, 0.9), draw.vector().normalized(), 1});
        edges.push_back(e);
      }
    surface::place(body, {});
    model.update(body, grid::update_complex(body, edges).reshaped);
    Points x = body.rest(), r(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
      x[i] += 0.01 * draw.vector();
      r[i] = draw.vector();
    }
    Hexahedra anew(body, options);
    ASSERT_EQ(answers(model, x, r), answers(anew, x, r)) << step;
  }
  EXPECT_GT(body.complex.n_copies(), 343u);
}

/// A solution, in far fewer iterations than by conjugate gradients that know nothing of pressures.
TEST(Dilatation, LeavesAnEquationThatIsSolvedForPressures) {
  for (const double nu : {0.499, 0.4999}) {
    Scene scene(70, {9, 9, 9}, nu, "corotational", 0.02);
    dynamics::Preconditioner* const own = scene.preconditioner();
    const auto project = [&](const std::span<double> y) {
      for (std::size_t i = 0; i < scene.x.size(); ++i) {
        Eigen::Map<Vec3> v(y.data() + 3 * i);
        v = (scene.constraints->freedom(i).project * v).eval();
      }
    };
    const auto blocks = dynamics::stiffness_blocks(scene.model);
    const dynamics::CgEquation equation = {[&](const auto p, const auto y) {
                                             scene.model.apply_stiffness(p, y);
                                             project(y);
                                           },
                                           [own](const auto r, const auto z) { own->apply(r, z); },
                                           [&](const auto r, const auto z) {
                                             for (std::size_t i = 0; i < blocks.size(); ++i) {
                                               const Mat3 S = dynamics::inverse_factor(
                                                 blocks[i], scene.constraints->freedom(i));
                                               Eigen::Map<Vec3>(z.data() + 3 * i) =
                                                 S.transpose() * (S * Eigen::Map<const Vec3>(r.data() + 3 * i));
                                             }
                                           }};
    Points b(scene.x.size());
    for (std::size_t i = 0; i < b.size(); ++i)
      b[i] = scene.model.lumped_mass()[i] * Vec3(1, 0, -9.81);
    project(flat(b));
    std::vector<double> measured(3 * b.size()), left(3 * b.size()), x(3 * b.size(), 0), y(3 * b.size(), 0);
    equation.J(flat(b), measured);
    const double residual = 1e-6 * std::sqrt(dynamics::dot(flat(b), measured));
    const auto report =
      dynamics::minimal_residuals(equation, *own->stiff_part(), flat(b), residual, 1000, x, left);
    EXPECT_TRUE(report.converged) << nu;
    const auto by_blocks = dynamics::conjugate_gradients({equation.A, equation.J, {}}, flat(b),
                                                         {.residual = 1e-2 * residual}, 20000, y);
    EXPECT_TRUE(by_blocks.converged);
    const double largest = std::ranges::max(y);
    for (std::size_t i = 0; i < x.size(); ++i)
      ASSERT_NEAR(x[i], y[i], 1e-4 * largest) << nu;
    RecordProperty("iterations_" + std::to_string(nu), report.n_iterations);
    EXPECT_LT(report.n_iterations, 120) << nu;
    EXPECT_LT(10 * report.n_iterations, by_blocks.n_iterations) << nu;
  }
}

} // namespace
} // namespace kerf::fem::dilatation_test
