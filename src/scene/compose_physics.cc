#include "scene/compose_physics.h"

#include "dynamics/implicit_euler.h"
#include "dynamics/symplectic_euler.h"
#include "fem/hexahedra.h"

namespace kerf::scene {

namespace {

fem::Boundary boundary_named(const std::string& name) {
  return name == "full cube"         ? fem::Boundary::full_cube
         : name == "volume fraction" ? fem::Boundary::volume_fraction
                                     : fem::Boundary::octants;
}

fem::Strain strain_named(const std::string& name) {
  return name == "enhanced" ? fem::Strain::enhanced : fem::Strain::trilinear;
}

} // namespace

std::function<Physics(const Body&)> physics_maker(const Section& section, const BodyParameters& parameters) {
  fem::HexahedraOptions fem_options{.material = read_if_written<material::Elastic>(section, "Material"),
                                    .boundary = boundary_named(parameters.integration),
                                    .strain = strain_named(parameters.element)};
  if (parameters.integrator == "symplectic Euler") {
    fem_options.sliver_floor = 0; // nothing is solved
    fem_options.mass_spread = read_if_written<SymplecticEulerParameters>(section, "Symplectic Euler").mass_spread;
    return [fem_options](const Body& body) {
      Physics physics{std::make_unique<fem::Hexahedra>(body.grid, body.cuts, body.complex, fem_options), nullptr};
      physics.stepper = std::make_unique<dynamics::SymplecticEuler>(*physics.model);
      return physics;
    };
  }
  const auto settings = read_if_written<ImplicitEulerParameters>(section, "Implicit Euler");
  fem_options.sliver_floor = settings.sliver_floor;
  const dynamics::ImplicitEulerOptions options{settings.n_newton, settings.cg_tolerance, settings.max_cg_iterations};
  return [fem_options, options](const Body& body) {
    Physics physics{std::make_unique<fem::Hexahedra>(body.grid, body.cuts, body.complex, fem_options), nullptr};
    physics.stepper = std::make_unique<dynamics::ImplicitEuler>(*physics.model, options);
    return physics;
  };
}

} // namespace kerf::scene
