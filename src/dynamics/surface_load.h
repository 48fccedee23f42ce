#pragma once

/// Loads on a part of a body's surface.
///
/// Traction t(X, time) per rest area is dead: linear in each triangle between its vertices. So its work on a triangle
/// of rest area A is A/3 times the sum over the vertices a of t_a . u_a, with u_a the mean of 3 L_a u over the triangle,
/// L_a linear, 1 at a and 0 at the others. With the means of the corners' shape functions a constant stress and its
/// traction are in balance wherever the skin passes through the grid; where triangles are linear between their vertices,
/// a vertex gets A/12 (2 t_a + t_b + t_c). Pressure p(X, time) follows the body: each vertex of a
/// triangle gets -p c / 6 with c = (x_1 - x_0) x (x_2 - x_0), which is twice the current area times the outward
/// normal, and p the mean of the three vertices. It has a potential only on a closed surface, so none is used; its
/// stiffness -df/dx_k = -(p/6) [x_{k+1} - x_{k+2}]x is not symmetric on an open one and is left out of the positive
/// tangent.

#include "base/loan.h"
#include "base/parameters.h"
#include "dynamics/body_force.h"

namespace kerf::dynamics {

/// Some triangles of a surface whose vertices follow the corners.
struct SurfacePatch {
  Interpolation points;            ///< the vertices
  Points rest;                     ///< of the vertices [m]
  std::vector<Triangle> triangles; ///< of vertices, counter-clockwise seen from outside
  Interpolation means = {};        ///< u_a, three a triangle; none: triangles are linear between their vertices
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
  Traction(SurfacePatch patch, Field traction);

  Nature nature() const override { return Nature::conservative; }
  double energy(double time, const Points& x) const override;
  void add_force(const Moment& moment, Points& forces) const override;
  void add_tangent(Tangent, const Moment&, double, LoadTangent&) const override {} // does not depend on x

 private:
  /// At each mean.
  Loan<Vec3> forces(double time) const;

  SurfacePatch patch_;
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
  double mean_pressure(const Triangle& triangle, double time) const;

  SurfacePatch patch_;
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
           "semicolons.");
  }
};

struct PressureParameters {
  PatchParameters patch;
  std::string pressure = "0"; ///< [Pa]

  void describe(Parameters& p) {
    patch.describe(p);
    p.text("Pressure [Pa]", pressure,
           "Against the current outward normal, per current area: a function of x, y, z (rest position, m) and t (s).");
  }
};

} // namespace kerf::dynamics
