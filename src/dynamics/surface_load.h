#pragma once

/// Loads on a part of a body's surface.
///
/// A triangle of a copy's surface is carried by the copy's trilinear map, so its image is cubic (cubic_triangle.h), and
/// loads are integrated over it with the corners' own shape functions: a constant stress and what acts on its surface
/// are in balance wherever the skin passes through the grid. Fields are linear in a triangle between its vertices.
///
/// Traction t(X, time) per rest area is dead. Pressure p(X, time) follows the body: a node a of the triangle gets
/// -int p L_a (x_u x x_v) du dv for the position x(u, v) of the image. Uniform on a closed surface, that is p times the
/// derivative of the volume inside, so it gives neither force nor moment. It has a potential only there, so none is
/// used; its stiffness is not symmetric on an open surface, and is left out of the positive tangent.

#include "base/loan.h"
#include "base/parameters.h"
#include "dynamics/body_force.h"
#include "dynamics/cubic_triangle.h"

#include <array>

namespace kerf::dynamics {

/// What carries triangles by trilinear maps, as a copy carries what is in its cube.
struct TriangleCarriers {
  Interpolation corners; ///< each once, so that fields and forces go through points that follow them once
  std::vector<std::array<std::uint32_t, 8>> of_triangle;                 ///< eight of these
  std::vector<Eigen::Matrix<double, n_triangle_nodes, 8>> shape_at_nodes; ///< theirs at the nodes of the triangle
};

/// Some triangles of a surface whose vertices follow the corners.
struct SurfacePatch {
  Interpolation points;            ///< the vertices
  Points rest;                     ///< of the vertices [m]
  std::vector<Triangle> triangles; ///< of vertices, counter-clockwise seen from outside
  TriangleCarriers carriers = {};  ///< none: triangles stay flat
};

/// Throws ParameterError when triangles, rest positions and vertices do not fit together.
void check(const SurfacePatch& patch);
/// Throws ParameterError when there is no triangle to act on. Faces that a cut has not revealed yet may be none.
void require_triangles(const SurfacePatch& patch);
/// Rest area [m^2].
double rest_area(const SurfacePatch& patch);

class Traction : public Load {
 public:
  /// traction [N/m^2], world frame, per rest area. Throws as check().
  Traction(const SurfacePatch& patch, Field traction);

  Nature nature() const override { return Nature::conservative; }
  double energy(double time, const Points& x) const override;
  void add_force(const Moment& moment, Points& forces) const override;
  void add_tangent(Tangent, const Moment&, double, LoadTangent&) const override {} // does not depend on x

 private:
  Interpolation corners_, shares_; // of each vertex what the corners get of its traction [m^2]
  Points rest_;                    // of vertices [m]
  Points moments_;                 // of the same shares: their sum of rest positions [m^3]
  Field traction_;
};

/// A number at a rest position X [m] and a time [s].
using ScalarField = std::function<double(const Vec3& X, double time)>;

class Pressure : public Load {
 public:
  /// pressure [Pa], against the outward normal. Throws as check().
  Pressure(SurfacePatch patch, ScalarField pressure);

  Nature nature() const override { return Nature::driving; }
  double energy(double, const Points&) const override { return 0; }
  void add_force(const Moment& moment, Points& forces) const override;
  void add_tangent(Tangent kind, const Moment& moment, double velocity_factor, LoadTangent& tangent) const override;

 private:
  class Images;

  SurfacePatch patch_;
  std::vector<std::uint32_t> vertices_; // of triangles
  ScalarField pressure_;
};

/// Which part of a surface a load acts on.
struct PatchParameters {
  std::string faces = "skin";
  Vec3 lower = Vec3::Constant(-1e9), upper = Vec3::Constant(1e9); ///< [m]

  void describe(Parameters& p) {
    p.choice("Faces", faces, {"skin", "revealed", "all"}, "The original skin, faces revealed by cuts, or both.");
    p.vector("Lower [m]", lower, "Lowest corner of the box that holds the triangles' rest centres.");
    p.vector("Upper [m]", upper, "Highest corner of that box.");
  }
};

struct TractionParameters {
  PatchParameters patch;
  std::string traction = "0; 0; 0"; ///< [N/m^2]

  void describe(Parameters& p) {
    patch.describe(p);
    p.text("Traction [N/m^2]", traction,
           "Force per rest area, world frame: three functions of x, y, z (rest position, m) and t (s), separated by "
           "semicolons. They are asked for at the surface's vertices, and linear between: where they jump, the jump is "
           "as wide as a triangle.");
  }
};

struct PressureParameters {
  PatchParameters patch;
  std::string pressure = "0"; ///< [Pa]

  void describe(Parameters& p) {
    patch.describe(p);
    p.text("Pressure [Pa]", pressure,
           "Against the current outward normal, per current area: a function of x, y, z (rest position, m) and t (s). "
           "It is asked for at the surface's vertices, and linear between: where it jumps, the jump is as wide as a "
           "triangle.");
  }
};

} // namespace kerf::dynamics
