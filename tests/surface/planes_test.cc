/// The small linear algebra of vertex placement against Eigen's decompositions.

#include "surface/planes.h"

#include "tests/support/bodies.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include <gtest/gtest.h>

namespace kerf::surface::planes_test {
namespace {

using support::Random;
using support::uniform;

constexpr double threshold = 0.41;

/// Normals near one, two or three directions, or anywhere.
Planes random_planes(Random& random, const int n) {
  const int n_clusters = 1 + static_cast<int>(random() % 3);
  Points clusters;
  for (int k = 0; k < n_clusters; ++k)
    clusters.push_back(support::random_direction(random));
  const double spread = std::pow(10, uniform(random, -17, 0));
  Planes planes;
  for (int i = 0; i < n; ++i) {
    const Vec3 normal = clusters[i % n_clusters] + spread * support::random_vector(random);
    planes.push_back({support::random_vector(random), (random() % 2 ? 1 : -1) * normal.normalized()});
  }
  return planes;
}

/// Space, a plane, a line.
Directions random_directions(Random& random) {
  Directions allowed;
  for (int k = static_cast<int>(random() % 3); k > 0; --k)
    allowed.remove(support::random_direction(random), 0.01);
  return allowed;
}

/// By the singular values of all normals, as seen from the allowed directions.
Eigen::JacobiSVD<Eigen::MatrixXd> decomposed(const Planes& planes, const Directions& allowed) {
  Eigen::MatrixXd normals(planes.size(), 3);
  for (int i = 0; i < planes.size(); ++i)
    normals.row(i) = (allowed.projection * planes[i].normal).transpose();
  return Eigen::JacobiSVD<Eigen::MatrixXd>(normals, Eigen::ComputeFullV | Eigen::ComputeFullU);
}

int rank(const Eigen::JacobiSVD<Eigen::MatrixXd>& svd) {
  const auto& s = svd.singularValues();
  int n = 0;
  while (n < s.size() && s[n] > least_lean && s[n] > threshold * s[0])
    ++n;
  return n;
}

/// Singular values that are apart, and away from where ranks change: then the answer is one.
bool is_clear(const Eigen::JacobiSVD<Eigen::MatrixXd>& svd) {
  const auto& s = svd.singularValues();
  for (int i = 0; i < s.size(); ++i)
    if (std::abs(s[i] - least_lean) < 1e-6 || std::abs(s[i] / s[0] - threshold) < 1e-6 ||
        (i > 0 && s[i - 1] - s[i] < 1e-3 && s[i] > 0.05))
      return false;
  return true;
}

TEST(Planes, MovesAreThePseudoInversesOfEveryRank) {
  Random random(61);
  int n_clear = 0;
  std::array<int, 4> n_of_rank{};
  for (int i = 0; i < 20000; ++i) {
    const Planes planes = random_planes(random, 1 + static_cast<int>(random() % 12));
    const Directions allowed = random_directions(random);
    const Vec3 p = support::random_vector(random);
    const auto svd = decomposed(planes, allowed);
    if (!is_clear(svd))
      continue;
    ++n_clear;
    ++n_of_rank[rank(svd)];
    const Moves moves = moves_to_planes(p, planes, allowed, threshold);
    ASSERT_EQ(moves.size(), std::max(1, rank(svd)));
    Eigen::VectorXd distances(planes.size());
    for (int k = 0; k < planes.size(); ++k)
      distances[k] = planes[k].normal.dot(planes[k].point - p);
    Vec3 expected = Vec3::Zero();
    for (int n = 0; n < rank(svd); ++n) {
      expected += svd.matrixV().col(n) * svd.matrixU().col(n).dot(distances) / svd.singularValues()[n];
      ASSERT_LT((moves[rank(svd) - 1 - n] - expected).norm(), 1e-10 * (1 + distances.norm())) << "case " << i;
    }
    if (rank(svd) == 0) {
      ASSERT_EQ(moves[0], Vec3(Vec3::Zero()));
    }
  }
  EXPECT_GT(n_clear, 10000);
  for (const int n : n_of_rank)
    EXPECT_GT(n, 30);
}

TEST(Planes, FreeDirectionsKeepThemMet) {
  Random random(62);
  for (int i = 0; i < 5000; ++i) {
    const Planes planes = random_planes(random, 4);
    const Directions allowed = random_directions(random);
    const auto svd = decomposed(planes, allowed);
    if (!is_clear(svd))
      continue;
    const Directions free = free_directions(planes, allowed, threshold);
    ASSERT_EQ(free.n, allowed.n - rank(svd));
    ASSERT_NEAR(free.projection.trace(), free.n, 1e-12);
    ASSERT_LT((free.projection * free.projection - free.projection).norm(), 1e-12);
    ASSERT_LT((allowed.projection * free.projection - free.projection).norm(), 1e-12) << "within what is allowed";
    for (int n = 0; n < rank(svd); ++n)
      ASSERT_LT((free.projection * svd.matrixV().col(n)).norm(), 1e-11);
  }
}

TEST(Planes, SpectraAreExactForEqualEigenvaluesToo) {
  Random random(63);
  const Points values = {{1, 1, 1}, {2, 2, 1}, {2, 1, 1}, {1, 0, 0}, {1, 1, 0}, {1, 1e-9, 0}, {3, 2, 1}, {0, 0, 0}};
  for (int i = 0; i < 2000; ++i) {
    const Vec3 expected = values[i % values.size()];
    const Mat3 q = Eigen::AngleAxisd(uniform(random, -4, 4), support::random_direction(random)).toRotationMatrix();
    const Mat3 a = q * expected.asDiagonal() * q.transpose();
    const Mat3 symmetric = 0.5 * (a + a.transpose());
    const Spectrum s = spectrum(symmetric);
    ASSERT_LT((s.values - expected).norm(), 1e-14);
    ASSERT_LT((s.vectors.transpose() * s.vectors - Mat3::Identity()).norm(), 1e-14);
    ASSERT_LT((symmetric * s.vectors - s.vectors * s.values.asDiagonal()).norm(), 1e-14);
  }
}

TEST(Planes, AShortRestDoesNotLeadOutOfTheSpace) {
  // Two directions that differ by 1e-6: what is left is at right angles to both.
  const Vec3 a = Vec3(1, 2, 2) / 3, b = (a + 1e-6 * Vec3(2, 1, -2) / 3).normalized();
  Directions d;
  d.remove(a, 1e-9);
  d.remove(b, 1e-9);
  EXPECT_EQ(d.n, 1);
  EXPECT_LT((d.projection * a).norm(), 1e-15);
  EXPECT_LT((d.projection * b).norm(), 1e-15);
  d = Directions();
  d.remove(a, 1e-9);
  d.remove(b, 1e-3); // too near: taken for the same
  EXPECT_EQ(d.n, 2);
}

} // namespace
} // namespace kerf::surface::planes_test
