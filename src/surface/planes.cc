#include "surface/planes.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace kerf::surface {

namespace {

/// Turns columns p, q so that entry (p, q) of the matrix vanishes (Golub, van Loan, Matrix Computations, 8.5).
void rotate(Mat3& a, Mat3& vectors, const int p, const int q) {
  const double apq = a(p, q);
  const double theta = (a(q, q) - a(p, p)) / (2 * apq);
  const double t = std::copysign(1 / (std::abs(theta) + std::sqrt(theta * theta + 1)), theta);
  const double c = 1 / std::sqrt(t * t + 1), s = t * c;
  const int r = 3 - p - q;
  const double arp = a(r, p), arq = a(r, q);
  a(p, p) -= t * apq;
  a(q, q) += t * apq;
  a(p, q) = a(q, p) = 0;
  a(r, p) = a(p, r) = c * arp - s * arq;
  a(r, q) = a(q, r) = s * arp + c * arq;
  const Vec3 vp = vectors.col(p);
  vectors.col(p) = c * vp - s * vectors.col(q);
  vectors.col(q) = s * vp + c * vectors.col(q);
}

Vec3 largest_column(const Mat3& a) {
  int i = 0;
  a.diagonal().maxCoeff(&i);
  return a.col(i);
}

/// (a - shift I) adjugate times v: v brought closer to the eigenvector whose value is nearest to the shift.
Vec3 shifted_adjugate(const Mat3& a, const double shift, const Vec3& v) {
  const Vec3 x(a(0, 0) - shift, a(0, 1), a(0, 2)), y(a(0, 1), a(1, 1) - shift, a(1, 2)),
    z(a(0, 2), a(1, 2), a(2, 2) - shift);
  return v[0] * y.cross(z) + v[1] * z.cross(x) + v[2] * x.cross(y);
}

/// The most common case, a smooth cut: one eigenvalue stands out, and Rayleigh quotients find it, error cubed a step.
Fixed one_direction(const Mat3& quadric, Vec3 v, const double least) {
  double value = v.dot(quadric * v);
  constexpr int max_steps = 8; // 2 or 3 are enough
  for (int step = 0; step < max_steps; ++step) {
    const Vec3 next = shifted_adjugate(quadric, value, v);
    const double length2 = next.squaredNorm();
    if (length2 < 1e-28 * value * value * value * value) // the shift is the eigenvalue
      break;
    const double turn2 = next.cross(v).squaredNorm() / length2;
    v = next / std::copysign(std::sqrt(length2), next.dot(v));
    value = v.dot(quadric * v);
    if (turn2 < 1e-12)
      break;
  }
  Fixed fixed;
  fixed.of.values[0] = value;
  fixed.of.vectors.col(0) = v;
  fixed.n = value > least ? 1 : 0;
  return fixed;
}

void order(Spectrum& s, const int i, const int j) {
  if (s.values[i] < s.values[j]) {
    std::swap(s.values[i], s.values[j]);
    s.vectors.col(i).swap(s.vectors.col(j));
  }
}

} // namespace

Vec3 mean_point(const Planes& planes) {
  Vec3 sum = Vec3::Zero();
  for (const Plane& plane : planes)
    sum += plane.point;
  return sum / static_cast<double>(planes.size());
}

void Directions::remove(const Vec3& v, const double least) {
  const Vec3 part = projection * (projection * v); // twice: a short rest must not lead out of this space
  const double length2 = part.squaredNorm();
  if (n == 0 || !(length2 > least * least))
    return;
  projection -= part * (part / length2).transpose();
  --n;
}

Spectrum spectrum(const Mat3& symmetric) {
  Mat3 a = symmetric;
  Spectrum result{Vec3::Zero(), Mat3::Identity()};
  const double negligible = std::numeric_limits<double>::epsilon() / 64 * a.trace();
  constexpr int max_sweeps = 12; // quadratic convergence: 3 or 4 are enough
  for (int sweep = 0; sweep < max_sweeps; ++sweep) {
    int n_turned = 0;
    for (const auto& [p, q] : {std::pair(0, 1), std::pair(0, 2), std::pair(1, 2)})
      if (std::abs(a(p, q)) > negligible) {
        rotate(a, result.vectors, p, q);
        ++n_turned;
      }
    if (n_turned == 0)
      break;
  }
  result.values = a.diagonal();
  order(result, 0, 1);
  order(result, 1, 2);
  order(result, 0, 1);
  return result;
}

Fixed fixed_directions(const Planes& planes, const Directions& allowed, const double threshold, const double least) {
  Mat3 quadric = Mat3::Zero();
  for (const Plane& plane : planes) {
    const Vec3 m = allowed.projection * plane.normal;
    quadric += m * m.transpose();
  }
  const Vec3 guess = (quadric * largest_column(quadric)).normalized();
  const double largest = guess.dot(quadric * guess), others = quadric.trace() - largest; // bounds from below and above
  if (largest > 0 && (others < threshold * threshold * largest || others < least * least))
    return one_direction(quadric, guess, least * least);
  Fixed fixed{spectrum(quadric), 0};
  const Vec3& squares = fixed.of.values;
  while (fixed.n < allowed.n && squares[fixed.n] > std::max(least * least, threshold * threshold * squares[0]))
    ++fixed.n;
  return fixed;
}

Directions free_directions(const Planes& planes, const Directions& allowed, const double threshold) {
  const Fixed fixed = fixed_directions(planes, allowed, threshold);
  Directions result = allowed;
  for (int i = 0; i < fixed.n; ++i)
    result.remove(fixed.of.vectors.col(i), 0.5);
  return result;
}

Moves moves_to_planes(const Vec3& p, const Planes& planes, const Directions& allowed, const double threshold) {
  Moves moves;
  const Fixed fixed = fixed_directions(planes, allowed, threshold);
  Vec3 slope = Vec3::Zero();
  for (const Plane& plane : planes)
    slope += plane.normal * plane.normal.dot(plane.point - p);
  std::array<Vec3, 3> sums;
  Vec3 move = Vec3::Zero();
  for (int i = 0; i < fixed.n; ++i) {
    const Vec3 direction = allowed.projection * fixed.of.vectors.col(i);
    move += direction * (direction.dot(slope) / fixed.of.values[i]);
    sums[i] = move;
  }
  for (int i = fixed.n; i-- > 0;)
    moves.push_back(sums[i]);
  if (moves.empty())
    moves.push_back(Vec3::Zero());
  return moves;
}

std::optional<Plane> common_plane(const Planes& planes, const Vec3& p, const double near) {
  constexpr double same = 1e-6; // sine of the angle between two: of a slow blade normals are known no better
  for (const Plane& plane : planes)
    if (std::abs(plane.normal.dot(p - plane.point)) > near || plane.normal.cross(planes[0].normal).norm() > same)
      return {};
  return planes.empty() ? std::nullopt : std::optional<Plane>({p, planes[0].normal});
}

std::optional<Vec3> meeting_in(const std::array<Vec3, 3>& triangle, const Plane& a, const Plane& b) {
  const Vec3 u = triangle[1] - triangle[0], v = triangle[2] - triangle[0];
  const Eigen::Matrix2d along{{a.normal.dot(u), a.normal.dot(v)}, {b.normal.dot(u), b.normal.dot(v)}};
  const Eigen::Vector2d heights(a.normal.dot(a.point - triangle[0]), b.normal.dot(b.point - triangle[0])),
    t = along.inverse() * heights; // not finite where they do not meet
  constexpr double inside = 1e-3;
  if (!(t.minCoeff() > inside && t.sum() < 1 - inside))
    return {};
  return triangle[0] + t[0] * u + t[1] * v;
}

} // namespace kerf::surface
