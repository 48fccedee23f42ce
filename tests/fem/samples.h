#pragma once

/// Elements of cut copies, and their stiffness the textbook's way.

#include "fem/element.h"
#include "tests/fem/bodies.h"
#include "tests/fem/quadrature.h"

namespace kerf::fem {

/// A cut copy: its moments and points in it.
struct Sample {
  Moments moments;
  std::vector<WeightedPoint<Vec3>> rule;
};

/// Copies of randomly cut cells, all of more than a fifth of a cube.
inline std::vector<Sample> make_samples() {
  std::vector<Sample> all;
  Draw draw(3);
  while (all.size() < 40) {
    Body body = make_block({2, 2, 2}, 1, draw, {0.2, 0.8});
    cut_at_random(body, 0.5, draw, {0.2, 0.8});
    for (const grid::Copy& copy : body.complex.copies) {
      const Moments m = material_moments(body, copy);
      if (m[0] > 0.2 && copy.nodes != 0xff)
        all.push_back({m, material_rule(body, copy, 5)});
    }
  }
  return all;
}

/// Hooke's law on engineering strains (xx, yy, zz, xy, yz, zx).
inline Eigen::Matrix<double, 6, 6> elasticity(const material::Elastic& material) {
  Eigen::Matrix<double, 6, 6> D = Eigen::Matrix<double, 6, 6>::Zero();
  D.topLeftCorner<3, 3>().setConstant(material.lambda());
  for (int i = 0; i < 6; ++i)
    D(i, i) += i < 3 ? 2 * material.mu() : material.mu();
  return D;
}

/// Engineering strain of a displacement gradient.
inline Eigen::Matrix<double, 6, 1> engineering_strain(const Mat3& G) {
  Eigen::Matrix<double, 6, 1> e;
  e << G(0, 0), G(1, 1), G(2, 2), G(0, 1) + G(1, 0), G(1, 2) + G(2, 1), G(2, 0) + G(0, 2);
  return e;
}

/// Strains of the 24 nodal displacements at a point of a cube of edge 1 m.
inline Eigen::Matrix<double, 6, 24> nodal_strains(const Vec3& x) {
  Eigen::Matrix<double, 6, 24> B;
  for (int a = 0; a < 8; ++a)
    for (int i = 0; i < 3; ++i)
      B.col(3 * a + i) = engineering_strain(Vec3::Unit(i) * shape_gradient(a, x).transpose());
  return B;
}

} // namespace kerf::fem
