#include "scene/compose_cut_surface.h"

namespace kerf::scene {

namespace {

cut::Shape make_shape(const ShapeParameters& p, const Section& section) {
  if (p.shape == "plane")
    return cut::Plane{p.point, p.normal.stableNormalized()};
  if (p.shape == "sphere")
    return cut::Sphere{p.point, p.radius};
  if (p.shape == "cylinder")
    return cut::Cylinder{p.point, p.axis.stableNormalized(), p.radius, p.height};
  if (p.shape == "disc")
    return cut::Disc{p.point, p.normal.stableNormalized(), p.radius};
  if (p.shape == "rectangle")
    return cut::Rectangle{p.point, p.first_side, p.second_side};
  try {
    return geometry::read_mesh(resolved(p.mesh, section), p.mesh_unit);
  } catch (const DataError& error) {
    throw DataError(section.complaint("Mesh", clause(error.what()), "").complaint());
  }
}

} // namespace

TimedSurface compose_cut_surface(const Section& section, const World& world) {
  const auto parameters = section.read<CutSurfaceParameters>();
  ShapeParameters of_shape;
  of_shape.shape = parameters.shape;
  const ShapeParameters shape = read_of_choice(section, "the shape '" + parameters.shape + "'", of_shape);
  cut::CutSurface surface{section.name(), make_shape(shape, section),
                          static_cast<grid::CutLabel>(world.blades.size() + world.cut_surfaces.size() + 1)};
  try {
    cut::check(surface);
  } catch (const ParameterError& error) {
    throw placed(section, error.complaint().path, error); // check() calls the keys as the scene does
  }
  const int step = first_step_from(parameters.time, world.time_step, world.n_steps);
  if (step > world.n_steps)
    throw section.complaint(
      "Time [s]", line("must be before the last step, which begins at ", (world.n_steps - 1) * world.time_step, " s"),
      "Cut earlier, or let the run end later");
  return {std::move(surface), step};
}

} // namespace kerf::scene
