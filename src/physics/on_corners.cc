#include "physics/on_corners.h"

#include "grid/carriers.h"

#include <algorithm>
#include <cmath>

namespace kerf::physics {

namespace {

/// What a corner has of its copies' material [kg].
std::vector<double> material_mass(const fem::Hexahedra& model) {
  std::vector<double> mass(model.incidence().n_corners(), 0.0);
  for (std::size_t i = 0; i < mass.size(); ++i)
    for (const auto user : model.incidence().users(i))
      mass[i] += model.element(user / 8).mass[user % 8];
  return mass;
}

bool has_extended_mass(const fem::Hexahedra& model) {
  return model.lumped_mass().data() == model.ghost_penalty().extended_mass().data();
}

} // namespace

lattice::Riders riders_of(const fem::Hexahedra& model, const CutBody& body) {
  constexpr double light =
    1.0 / 32; // of a cube: what holds corners of less fades with their mass (fem/ghost_penalty.h)
  if (!has_extended_mass(model) || !grid::is_cut(body.solid.cuts))
    return {};
  const double h = body.solid.grid.h();
  return {body.solid.complex, material_mass(model), body.density * h * h * h, light};
}

void damp_riders(const fem::Hexahedra& model, const lattice::Riders& riders, const double dt, dynamics::State& state) {
  const auto& material = model.material();
  const double across = std::sqrt((material.lambda() + 2 * material.mu()) / material.density) / model.h(),
               alpha = std::min(1.0, across * dt * across * dt);
  if (riders.n_riders() > 0)
    riders.damp(state.x, model.lumped_mass(), alpha, state.v);
}

} // namespace kerf::physics
