#include "fem/turned.h"

#include "material/polar.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace kerf::fem {

namespace {

Vec3 vertex_offset(const int a) { return Vec3(a & 1, a >> 1 & 1, a >> 2 & 1); }

/// A^-1; zero where R has no derivative, or none is wanted.
Mat3 inverse_spin(const Turned& state, const Frame frame) {
  constexpr double collapsed = 1e-6;
  const Mat3 S = state.R.transpose() * state.F;
  const Mat3 A = S.trace() * Mat3::Identity() - S;
  return frame == Frame::turning && A.determinant() > collapsed ? Mat3(A.inverse()) : Mat3(Mat3::Zero());
}

/// sum p_a x q_a.
Vec3 torque(const Vector24& p, const Vector24& q) {
  Vec3 sum = Vec3::Zero();
  for (int a = 0; a < 8; ++a)
    sum += p.segment<3>(3 * a).cross(q.segment<3>(3 * a));
  return sum;
}

/// (K u)_a - z x b_a.
Vector24 local_gradient(const Element& element, const Vector24& Ku, const Vec3& z) {
  Vector24 g;
  for (int a = 0; a < 8; ++a)
    g.segment<3>(3 * a) = Ku.segment<3>(3 * a) - z.cross(element.gradient(a));
  return g;
}

} // namespace

Turned turned(const Element& element, const double h, const std::array<Vec3, 8>& x, const Frame frame) {
  Turned state;
  state.F.setZero();
  for (int a = 1; a < 8; ++a)
    state.F += (x[a] - x[0]) * element.gradient(a).transpose();
  state.R = frame == Frame::turning ? material::rotation_of(state.F) : Mat3(Mat3::Identity());
  for (int a = 0; a < 8; ++a) {
    state.y.segment<3>(3 * a) = state.R.transpose() * (x[a] - x[0]);
    state.u.segment<3>(3 * a) = state.y.segment<3>(3 * a) - h * vertex_offset(a);
  }
  return state;
}

Matrix24 turned_stiffness(const Matrix24& K, const Mat3& R) {
  Matrix24 result;
  for (int a = 0; a < 8; ++a)
    for (int b = 0; b < 8; ++b)
      result.block<3, 3>(3 * a, 3 * b) = R * K.block<3, 3>(3 * a, 3 * b) * R.transpose();
  return result;
}

/// Column by column: the change of the gradient with one coordinate. In the turned frame x_b moves by e_i for
/// p = R e_i, so all but the last turn is done with the unit vectors of that frame.
Matrix24 hessian(const Element& element, const Matrix24& K, const Turned& state, const Frame frame) {
  const Mat3 inverse = inverse_spin(state, frame), S = state.R.transpose() * state.F;
  const Vector24 Ku = K * state.u;
  const Vec3 z = inverse * torque(state.y, Ku);
  const Vector24 g = local_gradient(element, Ku, z);
  Matrix24 local;
  for (int b = 0; b < 8; ++b)
    for (int i = 0; i < 3; ++i) {
      const Vec3 p = Vec3::Unit(i), w = inverse * element.gradient(b).cross(p);
      Vector24 du = Vector24::Zero();
      du.segment<3>(3 * b) = p;
      for (int a = 0; a < 8; ++a)
        du.segment<3>(3 * a) -= w.cross(state.y.segment<3>(3 * a));
      const Vector24 Kdu = K * du;
      Mat3 dS = p * element.gradient(b).transpose();
      for (int j = 0; j < 3; ++j)
        dS.col(j) -= w.cross(S.col(j));
      const Vec3 dt = torque(du, Ku) + torque(state.y, Kdu);
      const Vec3 dz = inverse * (dt - dS.trace() * z + dS * z);
      Vector24 column = local_gradient(element, Kdu, dz);
      for (int a = 0; a < 8; ++a)
        column.segment<3>(3 * a) += w.cross(g.segment<3>(3 * a));
      local.col(3 * b + i) = column;
    }
  Matrix24 result;
  for (int a = 0; a < 8; ++a)
    for (int b = 0; b < 8; ++b)
      result.block<3, 3>(3 * a, 3 * b) = state.R * local.block<3, 3>(3 * a, 3 * b) * state.R.transpose();
  return 0.5 * (result + result.transpose());
}

} // namespace kerf::fem
