#include "material/polar.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <random>

namespace kerf::material::polar_test {
namespace {

class Polar : public testing::Test {
 protected:
  double draw(const double lower, const double upper) {
    return std::uniform_real_distribution<double>(lower, upper)(engine_);
  }

  Mat3 rotation() {
    std::normal_distribution<double> normal;
    Eigen::Quaterniond q(normal(engine_), normal(engine_), normal(engine_), normal(engine_));
    return q.normalized().toRotationMatrix();
  }

  /// Symmetric, with the given eigenvalues in random directions.
  Mat3 symmetric(const Vec3& eigenvalues) {
    const Mat3 V = rotation();
    return V * eigenvalues.asDiagonal() * V.transpose();
  }

  Mat3 any_matrix() {
    Mat3 F;
    for (int i = 0; i < 9; ++i)
      F(i) = draw(-1, 1);
    return F;
  }

 private:
  std::mt19937 engine_{11};
};

double distance(const Mat3& A, const Mat3& B) { return (A - B).cwiseAbs().maxCoeff(); }

void expect_proper(const Mat3& R, const Mat3& F) {
  EXPECT_LT(distance(R.transpose() * R, Mat3::Identity()), 4e-15) << F;
  EXPECT_NEAR(R.determinant(), 1, 1e-14) << F;
}

TEST_F(Polar, FindsTheRotationOfAStretch) {
  double worst = 0;
  for (int n = 0; n < 2000; ++n) {
    const Mat3 R = rotation();
    worst = std::max(worst, distance(rotation_of(R * symmetric({draw(0.3, 3), draw(0.3, 3), draw(0.3, 3)})), R));
  }
  EXPECT_LT(worst, 1e-14);
  RecordProperty("worst", std::to_string(worst * 1e16) + "e-16");
}

/// The rotation is as sensitive as 1 / (sum of the two smallest stretches).
TEST_F(Polar, FindsItNearSingular) {
  for (double small = 0.5; small > 1e-9; small *= 0.5) {
    const Mat3 R = rotation();
    EXPECT_LT(distance(rotation_of(R * symmetric({1, 0.8, small})), R), 2e-14) << small;
    EXPECT_LT(distance(rotation_of(R * symmetric({1, small, small})), R), 1e-14 / small) << small;
  }
}

TEST_F(Polar, FlattenedKeepsItsRotation) {
  for (int n = 0; n < 200; ++n) {
    const Mat3 R = rotation();
    EXPECT_LT(distance(rotation_of(R * symmetric({draw(0.5, 2), draw(0.5, 2), 0})), R), 2e-14);
  }
}

TEST_F(Polar, InvertedAlongTheLeastStretch) {
  for (int n = 0; n < 500; ++n) {
    const Mat3 R = rotation();
    const Mat3 F = R * symmetric({draw(1, 2), draw(0.5, 1), -draw(0, 0.3)});
    const Mat3 found = rotation_of(F);
    expect_proper(found, F);
    EXPECT_LT(distance(found, R), 5e-14);
  }
}

/// The polar rotation is the nearest of all: it maximises tr(R^T F).
TEST_F(Polar, NoOtherRotationIsNearer) {
  for (int n = 0; n < 300; ++n) {
    const Mat3 F = any_matrix();
    const Mat3 R = rotation_of(F);
    expect_proper(R, F);
    const double best = (R.transpose() * F).trace();
    for (int k = 0; k < 30; ++k) {
      const double angle = std::pow(10, draw(-4, 0.5));
      const Mat3 Q = Eigen::AngleAxisd(angle, Vec3(rotation().col(0))).toRotationMatrix() * R;
      EXPECT_GE(best, (Q.transpose() * F).trace() - 1e-14);
    }
  }
}

TEST_F(Polar, IsProperForEveryMatrixOfMinusOneZeroOne) {
  for (int n = 0; n < 19683; ++n) {
    Mat3 F;
    for (int i = 0, code = n; i < 9; ++i, code /= 3)
      F(i) = code % 3 - 1;
    expect_proper(rotation_of(F), F);
  }
}

TEST_F(Polar, IsProperForEverySize) {
  for (const double size : {1e-300, 1e-150, 1e-110, 1e-20, 1e20, 1e100, 1e140})
    for (int n = 0; n < 20; ++n) {
      const Mat3 R = rotation();
      const Mat3 F = size * R * symmetric({1, 0.7, 0.5});
      EXPECT_LT(distance(rotation_of(F), R), 2e-14) << size;
      expect_proper(rotation_of(size * any_matrix()), F);
    }
}

TEST_F(Polar, OfZeroIsSomeRotation) { expect_proper(rotation_of(Mat3::Zero()), Mat3::Zero()); }

TEST_F(Polar, TurnsWithTheBodyAndWithTheFrame) {
  for (int n = 0; n < 500; ++n) {
    Mat3 F = symmetric({draw(0.5, 2), draw(0.5, 2), draw(-0.3, 2)});
    const Mat3 Q = rotation();
    EXPECT_LT(distance(rotation_of(Q * F), Q * rotation_of(F)), 5e-14);
    EXPECT_LT(distance(rotation_of(F * Q), rotation_of(F) * Q), 5e-14);
  }
}

} // namespace
} // namespace kerf::material::polar_test
