#include "physics/crumb_body.h"

#include "grid/material.h"
#include "material/polar.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <map>

namespace kerf::physics {

namespace {

constexpr double least_volume = 1e-12, least_thickness = 0.01; // of a cube

/// Of material, in cube edges from a corner of its own: volume, and integrals of X and X X^T.
struct Spread {
  double volume = 0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();

  void add(const grid::Tetrahedron& t, const Vec3& origin) {
    const double v = grid::volume(t);
    const Vec3 sum = t[0] + t[1] + t[2] + t[3] + 4 * origin;
    Mat3 squares = sum * sum.transpose();
    for (const Vec3& p : t)
      squares += (p + origin) * (p + origin).transpose();
    volume += v;
    first += v / 4 * sum;
    second += v / 20 * squares;
  }
};

/// The nearest matrix whose eigenvalues are not below `least`.
Mat3 at_least(const Mat3& A, const double least) {
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(A);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(least).asDiagonal() * eigen.eigenvectors().transpose();
}

Mat3 inertia_of(const Mat3& second_moment) { return second_moment.trace() * Mat3::Identity() - second_moment; }

/// The material of a crumb, lengths in cube edges from `origin` [m].
struct Material {
  Vec3 origin;
  Spread spread;
  Vec3 middle = Vec3::Zero();            ///< of its cubes
  std::map<std::uint32_t, double> parts; ///< of a cube, by corner
};

Material material_of(const grid::Solid& solid, const grid::Crumb& crumb) {
  const auto origin_of = [&](const grid::CopyId c) { return solid.grid.origin(solid.complex.copies[c].cell); };
  Material material{.origin = origin_of(crumb.copies[0]), .spread = {}, .parts = {}};
  for (const grid::CopyId c : crumb.copies) {
    const grid::Copy& copy = solid.complex.copies[c];
    const Vec3 from = (origin_of(c) - material.origin) / solid.grid.h();
    material.middle += (from + Vec3::Constant(0.5)) / static_cast<double>(crumb.copies.size());
    for (const auto corner : copy.corners)
      material.parts[corner.value] += least_volume;
    grid::for_each_tetrahedron(solid, copy, [&](const grid::Tetrahedron& t, int) {
      material.spread.add(t, from);
      const auto integrals = grid::shape_integrals(t);
      for (int a = 0; a < 8; ++a)
        material.parts[copy.corners[a].value] += integrals[a];
    });
  }
  if (!(material.spread.volume > least_volume))
    material.spread = {least_volume, least_volume * material.middle,
                       least_volume * material.middle * material.middle.transpose()};
  return material;
}

} // namespace

CrumbBody measure(const grid::Solid& solid, const grid::Crumb& crumb, const double density) {
  const double h = solid.grid.h();
  const auto& [origin, spread, middle, parts] = material_of(solid, crumb);
  const Vec3 centre = spread.first / spread.volume;
  const Mat3 around = spread.second / spread.volume - centre * centre.transpose();
  const double mass = density * spread.volume * h * h * h;
  CrumbBody made{
    {mass, origin + h * centre, mass * h * h * inertia_of(at_least(around, least_thickness * least_thickness / 12))},
    {},
    {},
    {}};
  for (const auto& [corner, part] : parts) {
    made.corners.push_back(corner);
    made.rest_of_corners.push_back(solid.grid.position(solid.complex.node[grid::CornerId(corner)]));
    made.mass_of_corners.push_back(density * h * h * h * std::max(part, least_volume));
  }
  return made;
}

dynamics::RigidMotion motion_of(const CrumbBody& crumb, const Motion& now) {
  const auto& [body, corners, mass, rest] = crumb;
  dynamics::RigidMotion motion;
  Vec3 X = Vec3::Zero();
  double all = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    all += mass[i];
    X += mass[i] * rest[i];
    motion.x += mass[i] * now.x[corners[i]];
    motion.v += mass[i] * now.v[corners[i]];
  }
  X /= all;
  motion.x /= all;
  motion.v /= all;
  Mat3 A = Mat3::Zero(), second = Mat3::Zero();
  Vec3 L = Vec3::Zero();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 r = now.x[corners[i]] - motion.x;
    A += mass[i] * r * (rest[i] - X).transpose();
    second += mass[i] * r * r.transpose();
    L += mass[i] * r.cross(now.v[corners[i]] - motion.v);
  }
  motion.R = material::rotation_of(A);
  const Vec3 omega = dynamics::angular_velocity(inertia_of(second), all * motion.x.squaredNorm(), L),
             to_centre = motion.R * (body.centre - X);
  motion.x += to_centre;
  motion.v += omega.cross(to_centre);
  motion.spin = motion.R * body.inertia * motion.R.transpose() * omega;
  return motion;
}

} // namespace kerf::physics
