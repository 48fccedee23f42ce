#include "scene/compose_physics.h"

#include "lattice/calibration.h"
#include "physics/on_corners.h"
#include "physics/phyxels.h"
#include "scene/compose_integrator.h"
#include "scene/grammar_physics.h"

#include <algorithm>

namespace kerf::scene {

namespace {

using physics::CutBody;

fem::Boundary boundary_named(const std::string& name) {
  return name == "full cube"         ? fem::Boundary::full_cube
         : name == "volume fraction" ? fem::Boundary::volume_fraction
                                     : fem::Boundary::octants;
}

/// Where stiffness damping acts within a step it calms light corners, and they need not follow others: it would act on
/// their way, which is not that of the velocity that they are led by, and give energy.
fem::Inertia inertia_of(const Integrator& integrator, const Section& section, const double time_step) {
  const bool is_calmed = integrator.inertia == fem::Inertia::gathered &&
                         read_if_written<DampingParameters>(section, "Damping").stiffness > time_step;
  return is_calmed ? fem::Inertia::lumped : integrator.inertia;
}

PhysicsMaker make_elements(const Section& section, const BodyParameters& parameters, const double time_step) {
  const Integrator integrator = compose_integrator(section, parameters.integrator);
  const auto& implicit = implicit_integrator_names();
  if (parameters.mass == "consistent" && parameters.integrator != "modal" &&
      std::find(implicit.begin(), implicit.end(), parameters.integrator) == implicit.end())
    throw section.complaint(
      "Mass", "'consistent' is for implicit integrators and modal, and this body has " + parameters.integrator,
      "Write 'set Mass = lumped', or take another integrator");
  const fem::HexahedraOptions options{
    .material = read_if_written<material::Elastic>(section, "Material"),
    .boundary = boundary_named(parameters.integration),
    .strain = parameters.element == "enhanced" ? fem::Strain::enhanced : fem::Strain::trilinear,
    .inertia = inertia_of(integrator, section, time_step),
    .mass = parameters.mass == "consistent" ? fem::MassMatrix::consistent : fem::MassMatrix::lumped,
    .counted = grid::Counted::deforming};
  return [=](const CutBody& body) {
    return std::make_unique<physics::Elements>(
      body, [=](const CutBody& b) { return std::make_unique<fem::Hexahedra>(b.solid, options); }, integrator.make);
  };
}

PhysicsMaker make_springs(const Section& section, const BodyParameters& parameters) {
  const auto material = read_if_written<material::Elastic>(section, "Material");
  const Integrator integrator = compose_integrator(section, parameters.integrator);
  const spring::MassSpringOptions options = {material.density, material.youngs_modulus, grid::Counted::deforming,
                                             is_explicit(parameters.integrator)
                                               ? grid::TieStiffness::of_explicit_steps
                                               : grid::TieStiffness::of_fronts};
  return [=](const CutBody& body) {
    return std::make_unique<physics::Springs>(
      body, [=](const CutBody& b) { return std::make_unique<spring::MassSpring>(b.solid, options); },
      integrator.make);
  };
}

PhysicsMaker make_phyxels(const Section& section, const BodyParameters& parameters) {
  physics::PhyxelsOptions options;
  options.material = read_if_written<material::Elastic>(section, "Material");
  if (const Section* phyxels = section.find("Phyxels")) {
    phyxels->read(options.phyxels);
    phyxels->read(options.model);
  }
  options.visibility = read_if_written<physics::VisibilityOptions>(section, "Visibility");
  const Integrator integrator = compose_integrator(section, parameters.integrator);
  const Section* const written = section.find("Phyxels");
  const Section& place = written ? *written : section; // outlives the making
  return [=, &place](const CutBody& body) {
    try {
      return std::make_unique<physics::Phyxels>(body, options, integrator.make);
    } catch (const ParameterError& error) {
      const std::string key = error.complaint().path;
      if (place.writes(key))
        throw placed(place, key, error);
      throw place.complaint(error.complaint().rule, clause(error.complaint().remedy));
    }
  };
}

/// k of shape matching: as alpha says, or by Young's modulus.
lattice::MatchingOptions matching_options(const Section& section, const LatticeParameters& lattice, const double h,
                                          const double dt) {
  const auto material = read_if_written<material::Elastic>(section, "Material");
  const int w = lattice.half_width;
  if (lattice.alpha > 0)
    return {material.density, w, lattice.alpha / (dt * dt)};
  const double k = lattice::stiffness_for(material.youngs_modulus, material.density, h, w);
  if (!(k * dt * dt <= 1)) {
    const Section* written = section.find("Lattice");
    const int least = lattice::least_half_width(material.youngs_modulus, material.density, h, dt);
    const double longest = 1 / std::sqrt(k);
    throw(written ? *written : section)
      .complaint(
        line("shape matching with a half width of ", w, " cells reaches a Young's modulus of ",
             lattice::youngs_modulus(1 / (dt * dt), material.density, h, w), " Pa at this time step; the material has ",
             material.youngs_modulus, " Pa"),
        line("Write 'set Half width [cells] = ", least, "' in 'subsection Lattice', a time step of ", longest,
             " s at most, or Alpha [1]"));
  }
  return {material.density, w, k};
}

PhysicsMaker make_lattice(const Section& section, const BodyParameters& parameters, const double dt) {
  if (parameters.integrator == "quasi-static" || parameters.integrator == "modal")
    throw section.complaint(
      "Integrator", "the backend 'lattice' moves in time only",
      "Take another integrator (any: shape matching is its own) and let damping bring it to rest");
  const auto lattice = read_if_written<LatticeParameters>(section, "Lattice");
  lattice::MatchingOptions options = matching_options(section, lattice, parameters.cube_edge, dt);
  options.counted = grid::Counted::deforming;
  return [=](const CutBody& body) {
    return std::make_unique<physics::ShapeMatching>(
      body, [=](const CutBody& b) { return std::make_unique<lattice::Matching>(b.solid, options); },
      [=](lattice::Matching& model, const physics::PiecesOfParticles&) {
        return std::make_unique<lattice::ShapeMatching>(model, lattice.region_damping);
      });
  };
}

} // namespace

std::vector<std::string> keys_left_out(const BodyParameters& parameters) {
  if (parameters.backend == "pba")
    return {"Element", "Integration", "Material/Law"};
  if (parameters.backend == "lattice")
    return {"Element", "Integration", "Integrator", "Material/Law", "Material/Poisson's ratio [1]"};
  if (parameters.backend == "mass-spring")
    return {"Element", "Integration", "Material/Law", "Material/Poisson's ratio [1]"};
  return {};
}

PhysicsMaker physics_maker(const Section& section, const BodyParameters& parameters, const double time_step) {
  if (parameters.mass != "lumped" && parameters.backend != "fem")
    throw section.complaint("Mass", "the backend '" + parameters.backend + "' has a mass for each particle",
                            "Write 'set Mass = lumped', or take the backend fem");
  if (parameters.backend == "pba")
    return make_phyxels(section, parameters);
  if (parameters.backend == "lattice")
    return make_lattice(section, parameters, time_step);
  if (parameters.backend == "mass-spring")
    return make_springs(section, parameters);
  return make_elements(section, parameters, time_step);
}

} // namespace kerf::scene
