#pragma once

/// What nearly incompressible elements have against changes of volume, apart from the rest.
///
/// As nu goes to 1/2, Hooke's stiffness is K = A + C^T C. In A each element resists its mean strain as another material
/// would, of the same mu and a moderate nu, and C u = sqrt(excess of lambda times volume) tr(R^T G) there,
/// with G the mean of grad u. Multigrid's smoothing at single corners is good for A, but not for C^T C: hardly any
/// motion at a corner keeps all volumes around it (Schoeberl 1999, Multigrid methods for a parameter dependent problem
/// in primal variables, Numer. Math. 84). So multigrid is made for A, and the equation is solved for displacements and
/// pressures together (dynamics/minimal_residuals.h).
///
/// This takes elements whose only stiffness that grows with lambda is C: enhanced ones. Trilinear ones resist other
/// changes of volume too, which is why they lock. And it takes statics: where masses count, a change of pressure does
/// not reach as far, 1 + e is no longer near what the pressures meet, and conjugate gradients by multigrid for all of K
/// need less time (nu = .4999, implicit steps to 1e-3: half of it).

#include "dynamics/preconditioner.h"
#include "fem/batches.h"
#include "fem/hourglass.h"

#include <optional>

namespace kerf::fem {

/// The material of A; none where nothing is to be kept apart.
std::optional<material::Elastic> without_excess(const material::Elastic& material, Strain strain);

class Dilatation : public dynamics::StiffPart {
 public:
  /// Of elements in batches, which have to live as long, times a factor. `rest`: the material of A.
  Dilatation(const Batching& batching, const BatchedElements<double>& elements, const material::Elastic& rest,
             double factor);

  std::size_t n_rows() const override { return weights_.size(); }
  void product(std::span<const double> p, std::span<double> q) const override;
  void add_transposed(std::span<const double> q, std::span<double> y) const override;
  double excess() const override { return excess_; }

 private:
  const Batching& batching_;
  const BatchedElements<double>& elements_;
  double excess_;
  std::vector<double> weights_; // of tr(R^T grad u) in each lane; zero in those without use
};

} // namespace kerf::fem
