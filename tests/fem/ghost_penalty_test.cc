/// The ghost penalty: nothing for affine motions, and spectra that do not depend on where a cut lies.

#include "fem/ghost_penalty.h"

#include "dynamics/state.h"
#include "surface/placement.h"
#include "tests/fem/models.h"
#include "tests/support/placed.h"
#include "tests/support/spectrum.h"

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include <algorithm>
#include <numeric>

namespace kerf::fem::ghost_penalty_test {
namespace {

using Matrix = Eigen::MatrixXd;

const material::Elastic rubber{.density = 1, .youngs_modulus = 1, .poissons_ratio = 0.4};

Body random_body(const unsigned seed) {
  Draw draw(seed);
  Body body = make_block({3, 3, 3}, 0.2, draw, {1e-6, 1});
  cut_at_random(body, 0.4, draw, {1e-6, 1 - 1e-6});
  return body;
}

Points disturbed(const Body& body, Draw& draw) {
  Points x = body.rest();
  for (Vec3& p : x)
    p += 0.05 * draw.vector();
  return x;
}

TEST(GhostPenalty, IsNothingForAffineMotions) {
  for (const unsigned seed : {1, 2, 3}) {
    const Body body = random_body(seed);
    const Hexahedra model = make_model(body, {.material = rubber});
    ASSERT_GT(model.ghost_penalty().faces().size(), 50u);
    Draw draw(seed);
    const Mat3 F = 3 * draw.matrix();
    Points x, forces(body.complex.n_corners(), Vec3::Zero());
    for (const Vec3& X : body.rest())
      x.push_back(F * X + Vec3(1, 2, 3));
    model.ghost_penalty().add_force(x, forces);
    EXPECT_LT(model.ghost_penalty().energy(x), 1e-28);
    for (const Vec3& f : forces)
      EXPECT_LT(f.norm(), 1e-15);
  }
}

TEST(GhostPenalty, ForcesProductsDiagonalAndMatrixAreThoseOfItsEnergy) {
  const Body body = random_body(4);
  const Hexahedra model = make_model(body, {.material = rubber});
  const GhostPenalty& penalty = model.ghost_penalty();
  Draw draw(5);
  const Points x = disturbed(body, draw);
  const std::size_t n = x.size();
  Points forces(n, Vec3::Zero()), product(n, Vec3::Zero());
  penalty.add_force(x, forces);
  penalty.add_product(dynamics::flat(x), dynamics::flat(product));
  double work = 0;
  for (std::size_t i = 0; i < n; ++i) {
    EXPECT_LT((forces[i] + product[i]).norm(), 1e-14);
    work += 0.5 * x[i].dot(product[i]);
  }
  EXPECT_NEAR(work / penalty.energy(x), 1, 1e-10);

  std::vector<Eigen::Triplet<double>> entries;
  penalty.add_entries(entries);
  Eigen::SparseMatrix<double> K(3 * n, 3 * n);
  K.setFromTriplets(entries.begin(), entries.end());
  const Eigen::VectorXd Kx = K * Eigen::Map<const Eigen::VectorXd>(x[0].data(), 3 * n);
  EXPECT_LT((Kx - Eigen::Map<const Eigen::VectorXd>(product[0].data(), 3 * n)).norm(), 1e-14);
  const auto diagonal = penalty.diagonal(n);
  for (std::size_t i = 0; i < 3 * n; ++i)
    EXPECT_NEAR(K.coeff(i, i), diagonal[i / 3], 1e-15);
}

TEST(GhostPenalty, ExtendedMassKeepsTheTotalAndItsCentre) {
  for (const unsigned seed : {6, 7, 8}) {
    const Body body = random_body(seed);
    const auto lumped = make_model(body, {.material = rubber}),
               extended = make_model(body, {.material = rubber, .inertia = Inertia::extended});
    const Points rest = body.rest();
    double total = 0, shifted = 0;
    Vec3 moment = Vec3::Zero();
    for (std::size_t i = 0; i < rest.size(); ++i) {
      const double m = lumped.lumped_mass()[i], change = extended.lumped_mass()[i] - m;
      EXPECT_GT(extended.lumped_mass()[i], 0) << i;
      total += change;
      moment += change * rest[i];
      shifted += std::abs(change);
    }
    EXPECT_GT(shifted, 1e-4);
    EXPECT_LT(std::abs(total), 1e-15);
    EXPECT_LT(moment.norm(), 1e-15);
  }
}

/// Only what holds hardly any material has a penalty.
TEST(GhostPenalty, WellFilledCopiesHaveNone) {
  const auto model_of_block = [](const double depth) {
    auto body = support::make_body({Vec3::Zero(), 1}, support::block_nodes({4, 4, 4}),
                                   [&](const grid::Grid& grid, const grid::EdgeId e) {
                                     const bool is_upper = grid.is_material(grid.ends(e)[0]);
                                     return grid::EdgeCut{e, is_upper ? depth : 1 - depth, Vec3::Unit(grid.axis(e)),
                                                          grid::skin_label};
                                   });
    surface::place(body, {});
    return Hexahedra(support::with_copies(std::move(body)), {.material = rubber});
  };
  EXPECT_TRUE(model_of_block(0.9).ghost_penalty().faces().empty());
  const Hexahedra shallow = model_of_block(0.1);
  ASSERT_FALSE(shallow.ghost_penalty().faces().empty());
  for (const GhostFace& face : shallow.ghost_penalty().faces())
    EXPECT_LT(std::min(shallow.element(face.lower.value).volume, shallow.element(face.upper.value).volume), 0.25);
}

struct Spectra {
  double condition; ///< of the stiffness, its 3 x 3 diagonal blocks scaled to the identity, rigid modes left out [1]
  double frequency; ///< the largest one, with extended mass, of density 1 and Young's modulus 1 [1/s]
};

Spectra spectra_of(support::Body& body, const double weight) {
  surface::place(body, {});
  body.complex = grid::build_complex(body);
  const Hexahedra model(body, {.material = rubber,
                               .strain = Strain::enhanced,
                               .inertia = Inertia::extended,
                               .ghost_penalty = {.weight = weight}});
  Matrix K = model.stiffness_matrix(grid::rest_positions(body), dynamics::Tangent::positive);
  const Eigen::Index n = K.rows();
  Matrix scaled = K;
  for (Eigen::Index i = 0; i < n; i += 3) {
    const Mat3 L = Mat3(K.block<3, 3>(i, i)).llt().matrixL(), inverse = L.inverse();
    scaled.middleRows<3>(i) = (inverse * scaled.middleRows<3>(i)).eval();
    scaled.middleCols<3>(i) = (scaled.middleCols<3>(i) * inverse.transpose()).eval();
  }
  const auto eigenvalues = [](const Matrix& A) {
    return Eigen::VectorXd(support::spectrum(A));
  };
  const Eigen::VectorXd of_scaled = eigenvalues(scaled);
  for (Eigen::Index i = 0; i < n; ++i) {
    K.row(i) /= std::sqrt(model.lumped_mass()[i / 3]);
    K.col(i) /= std::sqrt(model.lumped_mass()[i / 3]);
  }
  return {of_scaled[n - 1] / of_scaled[6 * grid::n_pieces(body.complex)], std::sqrt(eigenvalues(K)[n - 1])};
}

/// 3 x 3 x 3 nodes whose skin lies `depth` beyond the last nodes along some axes (bits), and 0.5 elsewhere.
support::Body shallow_block(const unsigned axes, const double depth) {
  return support::make_body({Vec3::Zero(), 1}, support::block_nodes({3, 3, 3}),
                            [&](const grid::Grid& grid, const grid::EdgeId e) {
                              const bool is_upper = grid.is_material(grid.ends(e)[0]);
                              const int axis = grid.axis(e);
                              return grid::EdgeCut{e, is_upper && (axes >> axis & 1) ? depth : 0.5, Vec3::Unit(axis),
                                                   grid::skin_label};
                            });
}

/// A block cut by a plane that passes a node at `distance` h.
void cut_by_plane(support::Body& body, const Vec3& direction, const Vec3& node, const double distance,
                  const grid::CutLabel label) {
  const Vec3 normal = direction.normalized();
  const auto [edges, of_skin, n_double, later, later_of_skin] =
    support::cuts_of_plane(body, {normal, normal.dot(node) + distance}, label);
  for (const auto& cut : edges)
    body.cuts.add(body.grid, cut);
  for (const auto& cut : of_skin)
    body.cuts.add(cut);
}

struct Family {
  std::string name;
  support::Body (*body)(double smallest);
  double from = 0.5; ///< the values of `smallest` from which on the spectra shall be flat
};

const std::vector<Family> families = {
  {"slab", [](const double t) { return shallow_block(4, t); }},
  {"edge", [](const double t) { return shallow_block(6, t); }},
  {"corner", [](const double t) { return shallow_block(7, t); }},
  {"cut",
   [](const double t) {
     auto body = support::block({4, 3, 3});
     cut_by_plane(body, {1, 0.3, 0.2}, {2, 2, 2}, 0.5 * t, 1);
     return body;
   }},
  {"diagonal cut",
   [](const double t) {
     auto body = support::block({4, 3, 3});
     cut_by_plane(body, {1, 1, 1}, {2, 2, 2}, 0.5 * t, 1);
     return body;
   }},
  {"crossing cuts",
   [](const double t) {
     auto body = support::block({4, 3, 3});
     cut_by_plane(body, {1, 0.2, -0.1}, {2, 2, 2}, 0.5 * t, 1);
     cut_by_plane(body, {0.1, 1, 0.3}, {2, 2, 2}, -0.5 * t, 2);
     return body;
   },
   0.3}, // at .5 a wedge of skin alone, of .02 cubes, hangs by its edge: 178
  {"rinds",
   [](const double t) { // under the skin a plane leaves a flap of rinds alone, 0.4 t thick, that hangs at one side
     auto body = support::block({4, 3, 3});
     const Vec3 normal = Vec3(0.02, 0.01, 1) / std::sqrt(1.0005);
     const auto [edges, of_skin, n_double, later, later_of_skin] =
       support::cuts_of_plane(body, {normal, normal.dot(Vec3(2, 2, 3.5)) - 0.4 * t - 1e-3});
     for (const auto& cut : edges)
       if (body.grid.position(body.grid.ends(cut.edge)[0])[0] < 2.5)
         body.cuts.add(body.grid, cut);
     for (const auto& cut : of_skin)
       if ((cut.segment.face.valid() ? grid::centre(body.grid, cut.segment.face)
                                     : grid::centre(body.grid, cut.segment.cell))[0] < 2.7)
         body.cuts.add(cut);
     return body;
   },
   0.01}}; // a thicker flap bends as the plate that it is: softer than its stretching, the thinner it is

/// From a cell that is half full down to one with 1e-12 of an edge in it, both numbers stay within a factor of two.
/// Without the penalty they grow without bound. KERF_PRINT_SPECTRA=1 prints them all.
TEST(GhostPenalty, SpectraDoNotDependOnWhereACutLies) {
  const bool prints = std::getenv("KERF_PRINT_SPECTRA") != nullptr;
  for (const Family& family : families) {
    std::vector<double> conditions, frequencies;
    for (const double t : {0.5, 0.3, 0.2, 0.1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12}) {
      support::Body body = family.body(t);
      const Spectra held = spectra_of(body, GhostPenaltyOptions().weight);
      if (t <= family.from) {
        conditions.push_back(held.condition);
        frequencies.push_back(held.frequency);
      }
      if (prints) {
        const Spectra bare = spectra_of(body, 0);
        std::printf("%-14s %6.0e  condition %8.3g (without %8.3g)  frequency %6.3g (without %8.3g)\n",
                    family.name.c_str(), t, held.condition, bare.condition, held.frequency, bare.frequency);
      }
    }
    const auto ratio = [](const std::vector<double>& values) {
      return *std::ranges::max_element(values) / *std::ranges::min_element(values);
    };
    EXPECT_LT(ratio(conditions), 2) << family.name;
    EXPECT_LT(ratio(frequencies), 2) << family.name;
    RecordProperty(family.name, std::to_string(ratio(conditions)) + ", " + std::to_string(ratio(frequencies)));
  }
  auto body = shallow_block(4, 1e-6);
  EXPECT_GT(spectra_of(body, 0).condition, 1e8);
  EXPECT_GT(spectra_of(body, 0).frequency, 1e3);
}

/// The penalty falls by a factor for each copy that lies between it and a well-filled one, and not as the mass there
/// does: a far corner that nothing holds would swing until its copy is inside out.
TEST(GhostPenalty, HoldsCornersFarFromWellFilledCopies) {
  for (const Family& family : families) {
    support::Body body = family.body(1e-12);
    surface::place(body, {});
    body.complex = grid::build_complex(body);
    const Hexahedra model(body, {.material = rubber});
    for (const GhostFace& face : model.ghost_penalty().faces()) {
      const double of_full_mass = 0.25 * GhostPenaltyOptions().weight * rubber.mu() * face.need;
      EXPECT_GT(face.stiffness / of_full_mass, 0.003 * std::pow(0.125, face.distance - 1))
        << family.name << ": distance " << int(face.distance);
    }
  }
}

} // namespace
} // namespace kerf::fem::ghost_penalty_test
