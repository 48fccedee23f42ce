#pragma once

/// What keeps copies from turning inside out, which springs do not: their lengths are the same in a mirror.
///
/// A copy whose cube has lost more than half its volume resists with the energy
///
///     W = E V / 2 (J_0 - J)^2,  J = det F < J_0 = 1/2,
///
/// a penalty on volume as of Teschner, Heidelberger, Mueller and Gross 2004 (A versatile and robust model for
/// geometrically complex deformable solids, CGI), asked only where a spring's law has no say any more. F is the mean
/// gradient over the cube, V its material's volume. Flat cubes get E V / 8, mirrored ones 9/8 E V. The energy is smooth
/// and nothing above half the volume, so what is said of small strain (mass_spring.h) stays. Twice as much shortens the
/// largest steps of symplectic Euler by up to a fifth (params/studies/stability.prm).

#include "base/loan.h"
#include "base/vec.h"
#include "dynamics/model.h"
#include "dynamics/pieces.h"
#include "grid/corner_numbers.h"

#include <array>
#include <span>
#include <vector>

namespace kerf::spring {

class Inversion {
 public:
  /// Of all copies with material: `fill` is each copy's part of the cube, 0 for none.
  Inversion(const grid::Solid& solid, const grid::CornerNumbers& numbers, std::span<const double> fill,
            double youngs_modulus);

  double energy(const Points& x) const; ///< [J]
  /// The same, to each piece's what is in it.
  void add_energies(const Points& x, const dynamics::Pieces& pieces, std::span<double> sums) const;
  void add_force(const Points& x, Points& forces) const; ///< [N]

  /// K without what would make it indefinite: the part along the gradient of J.
  void linearise(const Points& x);
  void add_product(std::span<const double> p, std::span<double> y) const;
  void add_diagonal(std::vector<Mat3>& blocks) const;
  /// At x, whether linearise() was called or not.
  void add_entries(const Points& x, dynamics::Tangent kind, std::vector<Eigen::Triplet<double>>& entries) const;

 private:
  struct Cube {
    std::array<std::uint32_t, 8> corners; ///< numbers, in deal.II's vertex order
    double strength;                      ///< E V [J]
  };
  /// Of a copy at the linearisation point: the gradient of J by its corners [1/m].
  struct Squashed {
    const Cube* cube;
    std::array<Vec3, 8> gradient;
  };

  Mat3 mean_gradient(const Cube& cube, const Points& x) const;
  std::array<Vec3, 8> gradient_of_volume(const Mat3& F) const;
  /// J of each copy.
  Loan<double> volumes(const Points& x) const;

  double h_;
  std::vector<Cube> cubes_;
  std::vector<Squashed> squashed_;
};

} // namespace kerf::spring
