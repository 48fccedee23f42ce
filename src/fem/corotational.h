#pragma once

/// Corotational trilinear hexahedra on the copies of a cut body (Mueller and others 2002; Hauth and Strasser 2004;
/// thesis §2.1.6).
///
/// Element energy E = 1/2 u^T K u with u = R^T x - X, K the small-strain stiffness of the copy's material and R the
/// rotation of its mean deformation gradient over that material (the cube's centre for a full cell). Forces are the
/// exact -dE/dx: beside R K u they hold the term of dR/dx, without which an element would exert a torque on itself. K
/// in the linearisation leaves out the derivatives of R, which keeps it positive semi-definite.
///
/// Limits: trilinear, so it locks near nu = 0.5 and in bending of thin parts; Hooke's law, so no good for large strain.

#include "dynamics/model.h"
#include "fem/element.h"

#include <memory>
#include <string>

namespace kerf::fem {

enum class Integration {
  octants,  ///< a copy counts with its own material: exact for every position of the cut
  full_cube ///< a copy counts as a full cube, as is common: doubles mass and stiffness along a cut
};

struct CorotationalOptions {
  material::Elastic material;
  Integration integration = Integration::octants;
  double sliver_floor = 1e-3; ///< make_element
  double mass_spread = 0;     ///< spread_mass
};

class Corotational : public dynamics::ElasticModel {
 public:
  Corotational(const grid::Grid& grid, const grid::Cuts& cuts, const grid::CellComplex& complex,
               const CorotationalOptions& options);

  std::span<const double> lumped_mass() const override { return mass_; }
  double energy(const Points& x) const override;
  void force(const Points& x, Points& forces) const override;
  void linearise(const Points& x) override;
  void apply_stiffness(std::span<const double> p, std::span<double> y) const override;
  void stiffness_diagonal(std::vector<Mat3>& blocks) const override;

  /// Volume of the material that the elements integrate over [m^3].
  double volume() const;
  std::size_t n_elements() const { return element_of_.size(); }
  /// How many copies are not full cubes.
  std::size_t n_partial() const { return elements_.size() - 1; }

 private:
  const Element& element(std::size_t e) const { return elements_[element_of_[e]]; }
  Mat3 deformation_gradient(std::size_t e, const Points& x) const;
  /// u = R^T (x - x_0) - (X - X_0) of an element.
  void local_displacement(std::size_t e, const Points& x, const Mat3& R, double* u) const;
  /// y = sum over elements of their 24 values.
  void gather(const std::vector<double>& values, double* y) const;

  double h_;
  std::vector<Element> elements_;                 // [0] is the full cube
  std::vector<std::uint32_t> element_of_;         // by copy
  std::vector<const double*> stiffness_;          // by copy
  std::vector<std::uint32_t> corners_;            // 8 a copy
  std::vector<std::uint32_t> user_start_, users_; // by corner: 8 copy + vertex
  std::vector<double> mass_;
  std::vector<double> rotations_;      // 9 a copy, at the linearisation point
  mutable std::vector<double> values_; // 24 a copy, scratch
};

} // namespace kerf::fem
