#include "fem/hexahedra.h"

#include "base/parallel.h"
#include "dynamics/state.h"
#include "fem/batches.h"
#include "material/polar.h"
#include "tests/fem/bodies.h"
#include "tests/support/spectrum.h"

#include <gtest/gtest.h>

#include <bit>
#include <limits>
#include <numeric>

namespace kerf::fem::stiffness_test {
namespace {

using Matrix = Eigen::MatrixXd;

const material::Elastic rubber{.density = 1000, .youngs_modulus = 2e3, .poissons_ratio = 0.4};

/// K by products with unit vectors.
Matrix assembled(const Hexahedra& model) {
  const auto n = static_cast<Eigen::Index>(3 * model.lumped_mass().size());
  Matrix K(n, n);
  Eigen::VectorXd p = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    p[i] = 1;
    model.apply_stiffness({p.data(), p.data() + n}, {K.col(i).data(), K.col(i).data() + n});
    p[i] = 0;
  }
  return K;
}

/// Eigenvalues of K scaled to a unit diagonal: as many vanish, but a sliver's stiffness does not look like zero.
Eigen::VectorXd scaled_spectrum(const Matrix& K) {
  const Eigen::VectorXd s = K.diagonal().cwiseSqrt().cwiseInverse();
  const Matrix scaled = s.asDiagonal() * K * s.asDiagonal();
  return support::spectrum(scaled);
}

Points disturbed(const Points& rest, const Mat3& F, const double size, Draw& draw) {
  Points x = rest;
  for (Vec3& p : x)
    p = F * p + size * draw.vector();
  return x;
}

TEST(Stiffness, HasSixRigidModesAPiece) {
  Draw draw(31);
  std::size_t n_several = 0;
  double least = 1, most = 0;
  for (int n = 0; n < 24; ++n) {
    Body body = make_block({2, 2, 1 + n % 3}, 0.2, draw, {0.25, 0.75});
    cut_at_random(body, 0.2 + 0.2 * (n % 4), draw, {0.25, 0.75});
    for (const double weight : {0.0, 0.03}) {
      const Hexahedra model(body, {.material = rubber, .ghost_penalty = {.weight = weight}});
      const Eigen::VectorXd spectrum = scaled_spectrum(assembled(model));
      const std::uint32_t n_pieces = grid::n_pieces(body.complex);
      const Eigen::Index n_rigid = 6 * n_pieces;
      ASSERT_GT(spectrum.size(), n_rigid);
      EXPECT_LT(spectrum.head(n_rigid).cwiseAbs().maxCoeff(), 1e-13) << n_pieces << " pieces";
      EXPECT_GT(spectrum[n_rigid], 1e-4) << n_pieces << " pieces";
      most = std::max(most, spectrum.head(n_rigid).cwiseAbs().maxCoeff());
      least = std::min(least, spectrum[n_rigid]);
    }
    n_several += grid::n_pieces(body.complex) > 1;
  }
  EXPECT_GE(n_several, 5u);
  RecordProperty("least", std::to_string(least * 1e9) + "e-9");
  RecordProperty("most", std::to_string(most * 1e16) + "e-16");
}

TEST(Stiffness, ProductsAreThoseOfASymmetricMatrix) {
  Draw draw(32);
  Body body = make_block({2, 3, 2}, 0.2, draw, {0.2, 0.8});
  cut_at_random(body, 0.3, draw, {0.2, 0.8});
  Hexahedra model(body, {.material = rubber});
  model.linearise(disturbed(body.rest(), draw.rotation(), 0.03, draw));
  const Matrix K = assembled(model);
  EXPECT_LT((K - K.transpose()).norm(), 1e-15 * K.norm());
  EXPECT_GT(support::spectrum(K)[0], -1e-13 * K.norm());

  Points p(body.complex.n_corners()), y(p.size());
  for (Vec3& v : p)
    v = draw.vector();
  model.apply_stiffness(dynamics::flat(p), dynamics::flat(y));
  const Eigen::VectorXd expected = K * Eigen::Map<const Eigen::VectorXd>(p[0].data(), K.cols());
  EXPECT_LT((Eigen::Map<const Eigen::VectorXd>(y[0].data(), K.cols()) - expected).norm(), 1e-14 * expected.norm());

  const std::vector<Mat3> blocks = dynamics::stiffness_blocks(model);
  ASSERT_EQ(blocks.size(), p.size());
  for (std::size_t c = 0; c < blocks.size(); ++c)
    EXPECT_LT((blocks[c] - K.block<3, 3>(3 * c, 3 * c)).norm(), 1e-14 * K.norm());
}

/// Element by element, from make_element and the copies' corners alone.
TEST(Stiffness, IsTheSumOfItsElements) {
  Draw draw(33);
  Body body = make_block({2, 2, 2}, 0.2, draw, {0.2, 0.8});
  cut_at_random(body, 0.3, draw, {0.2, 0.8});
  const Hexahedra model(body, {.material = rubber, .ghost_penalty = {.weight = 0}});
  const Matrix found = assembled(model);
  Matrix K = Matrix::Zero(found.rows(), found.cols());
  for (const grid::Copy& copy : body.complex.copies) {
    const Matrix24 k = stiffness(make_element(material_moments(body, copy), body.grid.h(), rubber, {}), rubber);
    for (int a = 0; a < 8; ++a)
      for (int b = 0; b < 8; ++b)
        K.block<3, 3>(3 * copy.corners[a].value, 3 * copy.corners[b].value) += k.block<3, 3>(3 * a, 3 * b);
  }
  EXPECT_LT((K - found).norm(), 1e-14 * K.norm());
}

TEST(Stiffness, TurnsWithTheBody) {
  Draw draw(34);
  Body body = make_block({2, 2, 2}, 0.2, draw, {0.2, 0.8});
  cut_at_random(body, 0.3, draw, {0.2, 0.8});
  Hexahedra model(body, {.material = rubber});
  const Matrix at_rest = assembled(model);
  const Mat3 Q = draw.rotation();
  model.linearise(disturbed(body.rest(), Q, 0, draw));
  Matrix turned = assembled(model);
  for (Eigen::Index a = 0; a < turned.rows(); a += 3)
    for (Eigen::Index b = 0; b < turned.cols(); b += 3)
      turned.block<3, 3>(a, b) = (Q.transpose() * turned.block<3, 3>(a, b) * Q).eval();
  EXPECT_LT((turned - at_rest).norm(), 1e-6 * at_rest.norm()); // rotations are kept in single precision
}

TEST(Stiffness, IsTheDerivativeOfTheForceAtRest) {
  Draw draw(35);
  Body body = make_block({2, 2, 2}, 0.2, draw, {0.2, 0.8});
  cut_at_random(body, 0.4, draw, {0.2, 0.8});
  const Hexahedra model(body, {.material = rubber});
  const Matrix K = assembled(model);
  const Points rest = body.rest();
  const double eps = 1e-5 * body.grid.h();
  Matrix derivative(K.rows(), K.cols());
  Points x = rest, forward, backward;
  for (std::size_t i = 0; i < 3 * rest.size(); ++i) {
    const double at = dynamics::flat(rest)[i];
    dynamics::flat(x)[i] = at + eps;
    model.force(x, forward);
    dynamics::flat(x)[i] = at - eps;
    model.force(x, backward);
    dynamics::flat(x)[i] = at;
    for (std::size_t j = 0; j < 3 * rest.size(); ++j)
      derivative(j, i) = (dynamics::flat(forward)[j] - dynamics::flat(backward)[j]) / (2 * eps);
  }
  EXPECT_LT((derivative + K).norm(), 1e-8 * K.norm());
  RecordProperty("error", std::to_string((derivative + K).norm() / K.norm() * 1e10) + "e-10");
}

/// 40 elements at 50 corners, one in eight full, with any material, rotation and tangent.
template <class T>
struct AnyElements {
  static constexpr std::uint32_t n = 40, n_corners = 50;
  std::vector<Element> elements;
  std::vector<std::uint32_t> corners, order;
  std::vector<Mat3> rotations;
  std::vector<material::Tangent> tangents;
  Batching batching;
  BatchedElements<T> batched;
  std::vector<Row<T>> p;

  explicit AnyElements(const bool has_tangents) {
    Draw draw(36);
    const Element full = make_element(full_cube_moments(), 0.3, rubber, {});
    for (std::uint32_t e = 0; e < n; ++e) {
      Moments moments = full_cube_moments();
      for (double& m : moments)
        m *= 1 + (e % 8 == 0 ? 0 : 0.1 * draw(-1, 1));
      elements.push_back(e % 8 == 0 ? full : make_element(moments, 0.3, rubber, {}));
      order.push_back(e);
      rotations.push_back(draw.rotation().cast<float>().cast<double>()); // as they are kept
      for (int a = 0; a < 8; ++a)
        corners.push_back(static_cast<std::uint32_t>(draw(0, n_corners)));
      const material::Tangent A = material::Tangent::Random();
      tangents.push_back(A + A.transpose());
    }
    std::vector<Kind> kinds;
    for (std::uint32_t e = 0; e < n; ++e)
      kinds.push_back(e % 8 == 0 ? Kind::full : Kind::partial);
    const std::array<std::uint32_t, 1> ends = {n};
    batching = Batching({order, ends, kinds, corners.data(), n_corners});
    batched = fem::batched<T>(batching, 0.3, rubber, full,
                              {[&](const std::uint32_t e) -> const Element& { return elements[e]; }});
    batched.tangents.resize(has_tangents ? batching.batches().size() : 0);
    for (std::size_t i = 0; i < batching.batches().size(); ++i)
      for (std::size_t lane = 0; lane < n_lanes; ++lane)
        if (const std::uint32_t e = batching.batches()[i].copies[lane]; e != BatchOfCopies::none)
          put(i, lane, e);
    p.resize(batching.n_rows());
    for (std::uint32_t c = 0; c < n_corners; ++c)
      p[c] = {T(draw(-1, 1)), T(draw(-1, 1)), T(draw(-1, 1))};
  }
  void put(const std::size_t batch, const std::size_t lane, const std::uint32_t e) {
    for (int k = 0; k < 9; ++k)
      (*batched.shared.rotations)[batch].row[k][lane] = float(rotations[e].data()[k]);
    if (!batched.tangents.empty())
      for (int i = 0; i < 9; ++i)
        for (int j = 0; j <= i; ++j)
          batched.tangents[batch].row[pair_index(i, j)][lane] = T(tangents[e](i, j));
  }
  /// The sum of the elements' matrices.
  Matrix expected() const {
    Matrix K = Matrix::Zero(3 * n_corners, 3 * n_corners);
    for (std::uint32_t e = 0; e < n; ++e) {
      std::array<Vec3, 8> b;
      for (int a = 0; a < 8; ++a)
        b[a] = elements[e].gradient(a);
      const Matrix24 k = stiffness(elements[e], rubber, batched.tangents.empty() ? Part::whole : Part::hourglass);
      for (int r = 0; r < 8; ++r)
        for (int c = 0; c < 8; ++c) {
          Mat3 block = rotations[e] * k.block<3, 3>(3 * r, 3 * c) * rotations[e].transpose();
          for (int j = 0; j < 3 && !batched.tangents.empty(); ++j)
            for (int l = 0; l < 3; ++l)
              block += b[r][j] * b[c][l] * tangents[e].block<3, 3>(3 * j, 3 * l);
          K.block<3, 3>(3 * corners[8 * e + r], 3 * corners[8 * e + c]) += block;
        }
    }
    return K;
  }
};

std::vector<InstructionSet> instruction_sets() {
  std::vector<InstructionSet> all = {InstructionSet::narrow};
  for (const auto set : {InstructionSet::middle, InstructionSet::wide})
    if (set <= instruction_set())
      all.push_back(set);
  return all;
}

template <class T>
void expect_kernels_are_the_matrices(const double tolerance) {
  for (const bool has_tangents : {false, true})
    for (const InstructionSet set : instruction_sets()) {
      const AnyElements<T> all(has_tangents);
      const Matrix K = all.expected();
      std::vector<Row<T>> y(all.p.size()), blocks(2 * all.p.size());
      for (std::size_t i = 0; i < all.batching.batches().size(); ++i) {
        const auto batch = all.batched.batch(all.batching, i);
        element_kernels<T>(set).product(all.batched.cube, batch, all.p.data(), y.data());
        element_kernels<T>(set).diagonal(all.batched.cube, batch, blocks.data());
      }
      Eigen::VectorXd p(K.rows()), product(K.rows());
      Matrix diagonal = Matrix::Zero(K.rows(), 3), found = diagonal;
      for (std::uint32_t c = 0; c < all.n_corners; ++c) {
        const Row<T>&d = blocks[2 * c], &s = blocks[2 * c + 1];
        p.segment<3>(3 * c) << all.p[c].x, all.p[c].y, all.p[c].z;
        product.segment<3>(3 * c) << y[c].x, y[c].y, y[c].z;
        found.middleRows<3>(3 * c) << d.x, s.x, s.z, s.x, d.y, s.y, s.z, s.y, d.z;
      }
      EXPECT_LT((product - K * p).norm(), tolerance * (K * p).norm()) << static_cast<int>(set);
      for (std::uint32_t e = 0; e < all.n; ++e) {
        const Matrix24 k = stiffness(all.elements[e], rubber, has_tangents ? Part::hourglass : Part::whole);
        for (int a = 0; a < 8; ++a) {
          Mat3 block = all.rotations[e] * k.block<3, 3>(3 * a, 3 * a) * all.rotations[e].transpose();
          const Vec3 b = all.elements[e].gradient(a);
          for (int j = 0; j < 3 && has_tangents; ++j)
            for (int l = 0; l < 3; ++l)
              block += b[j] * b[l] * all.tangents[e].template block<3, 3>(3 * j, 3 * l);
          diagonal.middleRows<3>(3 * all.corners[8 * e + a]) += 0.5 * (block + block.transpose());
        }
      }
      EXPECT_LT((diagonal - found).norm(), tolerance * diagonal.norm()) << static_cast<int>(set);
    }
}

TEST(Stiffness, KernelsAreTheMatricesOfTheirElements) {
  expect_kernels_are_the_matrices<double>(1e-14);
  expect_kernels_are_the_matrices<float>(1e-6);
}

/// So a run is the same, whichever of the two has told the energy.
TEST(Stiffness, EnergiesBesideForcesAreThoseAloneBitByBit) {
  for (const MeanPart mean : {MeanPart::hooke, MeanPart::none})
    for (const InstructionSet set : instruction_sets()) {
      const AnyElements<double> all(false);
      const ForceKernels& kernels = force_kernels(set);
      std::vector<Row<double>> forces(all.p.size());
      for (std::size_t i = 0; i < all.batching.batches().size(); ++i) {
        const auto batch = all.batched.batch(all.batching, i);
        Turns turns{};
        kernels.turn(all.batched.cube, batch, all.p.data(), turns);
        alignas(64) std::array<double, n_lanes> alone, beside;
        kernels.energy(all.batched.cube, batch, turns, mean, all.p.data(), alone.data());
        kernels.force(all.batched.cube, batch, turns, mean, nullptr, 1, all.p.data(), forces.data(), beside.data());
        for (std::size_t lane = 0; lane < batch.n_used; ++lane)
          EXPECT_EQ(alone[lane], beside[lane]) << static_cast<int>(set);
        EXPECT_NE(alone[0], 0);
      }
    }
}

void find_rotation(const double* const F, double* const R) {
  Eigen::Map<Mat3> found(R);
  found = material::rotation_of(Eigen::Map<const Mat3>(F));
}

/// Rotations and forces in one call are those in two, also of cubes whose rotation is told by the caller.
TEST(Stiffness, ForcesWithRotationsAreThoseInTwoCalls) {
  for (const InstructionSet set : instruction_sets()) {
    const AnyElements<double> all(false); // half of its cubes are inside out
    const ForceKernels& kernels = force_kernels(set);
    std::vector<Row<double>> at_once(all.p.size()), in_two(all.p.size());
    unsigned n_told = 0;
    for (std::size_t i = 0; i < all.batching.batches().size(); ++i) {
      const auto batch = all.batched.batch(all.batching, i);
      Turns turns{};
      for (unsigned unknown = kernels.turn(all.batched.cube, batch, all.p.data(), turns) & ((1U << batch.n_used) - 1);
           unknown != 0; unknown &= unknown - 1, ++n_told) {
        const int lane = std::countr_zero(unknown);
        double F[9], R[9];
        for (int k = 0; k < 9; ++k)
          F[k] = turns.F[k][lane];
        find_rotation(F, R);
        for (int k = 0; k < 9; ++k)
          turns.R[k][lane] = R[k];
      }
      alignas(64) std::array<double, n_lanes> energies, energies_in_two;
      kernels.turned_force(all.batched.cube, batch, find_rotation, all.p.data(), at_once.data(), energies.data());
      kernels.force(all.batched.cube, batch, turns, MeanPart::hooke, nullptr, 1, all.p.data(), in_two.data(),
                    energies_in_two.data());
      for (std::size_t lane = 0; lane < batch.n_used; ++lane)
        EXPECT_EQ(energies[lane], energies_in_two[lane]) << static_cast<int>(set);
    }
    EXPECT_GT(n_told, 0u);
    for (std::size_t corner = 0; corner < AnyElements<double>::n_corners; ++corner) {
      EXPECT_EQ(at_once[corner].x, in_two[corner].x) << static_cast<int>(set);
      EXPECT_EQ(at_once[corner].y, in_two[corner].y) << static_cast<int>(set);
      EXPECT_EQ(at_once[corner].z, in_two[corner].z) << static_cast<int>(set);
    }
  }
}

/// Sixteen cubes apart from each other, each deformed by a matrix of its own.
struct CubesApart {
  Batching batching;
  BatchedElements<double> batched;

  CubesApart() {
    const Element full = make_element(full_cube_moments(), h, rubber, {});
    const std::vector<Kind> kinds(n_lanes, Kind::full);
    std::vector<std::uint32_t> order(n_lanes), corners(8 * n_lanes);
    std::iota(order.begin(), order.end(), 0);
    std::iota(corners.begin(), corners.end(), 0);
    const std::array<std::uint32_t, 1> ends = {n_lanes};
    batching = Batching({order, ends, kinds, corners.data(), 8 * n_lanes});
    batched =
      fem::batched<double>(batching, h, rubber, full, {[&](std::uint32_t) -> const Element& { return full; }});
  }
  struct Found {
    std::array<Mat3, n_lanes> R;
    std::array<bool, n_lanes> is_known;
  };
  Found turn(const InstructionSet set, const std::array<Mat3, n_lanes>& F) const {
    std::vector<Row<double>> x(batching.n_rows());
    for (std::size_t e = 0; e < n_lanes; ++e)
      for (int a = 0; a < 8; ++a) {
        const Vec3 at = F[e] * (h * Vec3(a & 1, a >> 1 & 1, a >> 2 & 1));
        x[8 * e + a] = {at[0], at[1], at[2]};
      }
    Turns turns{};
    const unsigned unknown = force_kernels(set).turn(batched.cube, batched.batch(batching, 0), x.data(), turns);
    Found found;
    for (std::size_t lane = 0; lane < n_lanes; ++lane) {
      const std::uint32_t e = batching.batches()[0].copies[lane];
      found.is_known[e] = (unknown >> lane & 1) == 0;
      for (int i = 0; i < 9; ++i)
        found.R[e].data()[i] = turns.R[i][lane];
    }
    return found;
  }

  static constexpr double h = 0.25;
};

/// Whatever a kernel says it knows is the rotation, also beside lanes that are flat, inverted or no numbers.
TEST(Stiffness, RotationsOfKernelsAreThoseOfThePolarDecomposition) {
  const CubesApart cubes;
  Draw draw(38);
  double worst = 0;
  for (const InstructionSet set : instruction_sets())
    for (const double strain : {0.0, 1e-8, 1e-3, 0.03, 0.3, 1.2, 4.0})
      for (int n = 0; n < 50; ++n) {
        std::array<Mat3, n_lanes> F;
        for (Mat3& one : F) {
          const Mat3 V = draw.rotation();
          const Vec3 stretches = (strain * Vec3(draw(-1, 1), draw(-1, 1), draw(-1, 1))).array().exp();
          one = draw.rotation() * V * stretches.asDiagonal() * V.transpose();
        }
        const CubesApart::Found plain = cubes.turn(set, F);
        F[1] = Mat3::Zero();
        F[6] = F[6] * Vec3(1, 1, -1).asDiagonal();
        F[11] = F[11] * Vec3(1, 0, 1).asDiagonal();
        F[12].setConstant(std::numeric_limits<double>::quiet_NaN());
        const CubesApart::Found found = cubes.turn(set, F);
        EXPECT_EQ(found.R[3], plain.R[3]);
        for (const std::size_t e : {1, 6, 11, 12})
          EXPECT_FALSE(found.is_known[e]) << e;
        for (std::size_t e = 0; e < n_lanes; ++e)
          if (found.is_known[e])
            worst = std::max(worst, (found.R[e] - material::rotation_of(F[e])).norm());
          else
            EXPECT_TRUE(strain > 2 || e == 1 || e == 6 || e == 11 || e == 12) << strain;
      }
  EXPECT_LT(worst, 1e-12);
  RecordProperty("worst", std::to_string(worst * 1e16) + "e-16");
}

/// Of some fifty chunks of elements, so that both threads have work (batches.h).
TEST(Stiffness, OneAndTwoThreadsGiveTheSameBits) {
  const int n_before = n_threads();
  std::array<std::vector<double>, 2> results;
  for (const int n : {1, 2}) {
    set_n_threads(n);
    Draw draw(37);
    Body body = make_block({29, 27, 30}, 0.1, draw, {0.1, 0.9});
    cut_at_random(body, 0.02, draw, {0.1, 0.9});
    Hexahedra model(body, {.material = rubber});
    const Points x = disturbed(body.rest(), draw.rotation(), 0.02, draw);
    model.linearise(x);
    Points f, y(x.size());
    model.force(x, f);
    model.apply_stiffness(dynamics::flat(x), dynamics::flat(y));
    std::vector<double>& result = results[n - 1];
    result = {model.energy(x), model.volume()};
    for (const Points& part : {f, y})
      result.insert(result.end(), dynamics::flat(part).begin(), dynamics::flat(part).end());
    result.insert(result.end(), model.lumped_mass().begin(), model.lumped_mass().end());
  }
  set_n_threads(n_before);
  EXPECT_EQ(results[0], results[1]);
}

} // namespace
} // namespace kerf::fem::stiffness_test
