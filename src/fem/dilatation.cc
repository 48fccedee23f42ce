#include "fem/dilatation.h"

#include "base/parallel.h"
#include "fem/two_rows.h"
#include "material/laws.h"

#include <cmath>

namespace kerf::fem {

std::optional<material::Elastic> without_excess(const material::Elastic& material, const Strain strain) {
  constexpr double nearly_incompressible = 0.49, moderate = 0.475; // nu
  if (strain != Strain::enhanced || material.poissons_ratio <= nearly_incompressible)
    return std::nullopt;
  const material::AnyLaw law = material::law_of(material);
  if (!std::holds_alternative<material::Corotational>(law) && !std::holds_alternative<material::SmallStrain>(law))
    return std::nullopt; // whose tangent is not Hooke's
  material::Elastic rest = material;
  rest.poissons_ratio = moderate;
  rest.youngs_modulus = 2 * material.mu() * (1 + moderate);
  return rest;
}

Dilatation::Dilatation(const Batching& batching, const BatchedElements<double>& elements,
                       const material::Elastic& rest, const double factor)
  : batching_(batching), elements_(elements), weights_(n_lanes * batching.batches().size(), 0) {
  const double lambda = elements.cube.lambda - rest.lambda();
  excess_ = lambda / (rest.lambda() + 2 * rest.mu());
  batching.for_each([&](const std::size_t i) {
    const BatchOfCopies& batch = batching.batches()[i];
    for (std::size_t lane = 0; lane < batch.n_used; ++lane) {
      const double volume = batch.partial == BatchOfCopies::none ? elements.cube.volume
                                                                 : elements.partial[batch.partial].volume[lane];
      weights_[n_lanes * i + lane] = std::sqrt(std::max(0.0, factor * lambda * volume));
    }
  });
}

void Dilatation::product(const std::span<const double> p, const std::span<double> q) const {
  const TwoRows lent(batching_.n_rows());
  put_rows(p, batching_.n_rows(), lent.first);
  const auto dilatation = force_kernels().dilatation;
  batching_.for_each([&](const std::size_t i) {
    alignas(64) double changes[n_lanes];
    dilatation(elements_.cube, elements_.batch(batching_, i), lent.first, changes);
    for (std::size_t lane = 0; lane < n_lanes; ++lane)
      q[n_lanes * i + lane] = weights_[n_lanes * i + lane] * changes[lane];
  });
}

void Dilatation::add_transposed(const std::span<const double> q, const std::span<double> y) const {
  const TwoRows lent(batching_.n_rows());
  Row<double>* const sums = lent.first;
  put_rows(y, batching_.n_rows(), sums);
  const auto add_pressure = force_kernels().add_pressure;
  batching_.for_each_in_order([&](const std::size_t i) {
    alignas(64) double pressures[n_lanes];
    for (std::size_t lane = 0; lane < n_lanes; ++lane)
      pressures[lane] = weights_[n_lanes * i + lane] * q[n_lanes * i + lane];
    add_pressure(elements_.cube, elements_.batch(batching_, i), pressures, sums);
  });
  write(sums, y);
}

} // namespace kerf::fem
