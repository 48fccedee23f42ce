#include "scene/grammar.h"

#include "material/elastic.h"
#include "scene/observables.h"

#include <algorithm>

namespace kerf::scene {

namespace {

constexpr Range at_least_one{1, 1e9};

std::string observable_names() {
  std::string names;
  for (const BodyObservable& observable : body_observables())
    names += (names.empty() ? "" : ", ") + observable.name;
  return names;
}

} // namespace

void TimeParameters::describe(Parameters& p) {
  p.number("Time step [s]", time_step, positive, "Length of every step.");
  p.number("End time [s]", end_time, positive, "The run takes round(end time / time step) steps from time 0.");
}

void GravityParameters::describe(Parameters& p) {
  p.vector("Acceleration [m/s^2]", acceleration,
           "Acts on every body, world frame. Without this section there is none.");
}

void BodyParameters::describe(Parameters& p) {
  p.text("Mesh", mesh, "Closed triangle mesh (OFF, OBJ, STL, PLY); a relative path starts at the scene file.");
  p.require_last();
  p.number("Mesh unit [m]", mesh_unit, positive, "Length of one unit of the mesh file.");
  p.number("Cube edge [m]", cube_edge, positive, "Edge h of the grid's cubes: the resolution of physics and cuts.");
  p.require_last();
  p.vector(
    "Lattice offset [1]", lattice_offset,
    "How far inside the lower end of the mesh's bounding box the first grid nodes stand along x, y, z, in parts of "
    "a cube's edge. A half keeps the plane sides of a box away from grid nodes.");
  p.number("Sharp angle [degrees]", sharp_angle, {.min = 0, .max = 90, .min_excluded = true, .max_excluded = true},
           "Two cut planes that turn by more than this inside a face meet at a sharp edge (thesis §2.4.3).");
  p.choice("Integration", integration, {"octants", "full cube"},
           "How a partly filled cell counts: with its own material, or as a full cube.");
  p.choice("Integrator", integrator, {"implicit Euler", "symplectic Euler"}, "How time advances.");
}

void DampingParameters::describe(Parameters& p) {
  p.number("Mass damping [1/s]", mass, non_negative, "Rayleigh's alpha: a force -alpha M v.");
  p.number("Stiffness damping [s]", stiffness, non_negative, "Rayleigh's beta: a force -beta K v.");
}

void ImplicitEulerParameters::describe(Parameters& p) {
  p.integer("Newton iterations [1]", n_newton, at_least_one, "Corrections a step; 1 is the linearly implicit method.");
  p.number("CG tolerance [1]", cg_tolerance, {.min = 0, .max = 1, .min_excluded = true, .max_excluded = true},
           "Residual over the forces that balance in it, at which conjugate gradients stop.");
  p.integer("CG iterations [1]", max_cg_iterations, at_least_one, "Most iterations; more is a failure of the run.");
  p.number("Sliver floor [1]", sliver_floor, {.min = 0, .max = 1},
           "A copy that holds less than this part of its cube gets the stiffness of this part.");
}

void SymplecticEulerParameters::describe(Parameters& p) {
  p.number("Mass spread [1]", mass_spread, {.min = 0, .max = 1},
           "Part of each cell's mass that its corners share evenly: bounds the frequency of slivers, and with it the "
           "stable time step.");
}

void SupportParameters::describe(Parameters& p) {
  p.vector("Lower [m]", lower, "Lower corner of the box, rest configuration: every grid node in the box is held.");
  p.require_last();
  p.vector("Upper [m]", upper, "Upper corner of the box.");
  p.require_last();
  p.text("Displacement [m]", displacement,
         "How far the box has moved from rest: three expressions of the time t, separated by semicolons.");
}

void BladeParameters::describe(Parameters& p) {
  p.points("Edge [m]", edge, "The cutting edge, a polyline in the blade's frame.");
  p.require_last();
  p.vector("Spine [m]", spine, "From the cutting edge to the back of the blade, in its frame; only drawn.");
  p.numbers("Times [s]", times, any_number, "Times of the key frames, increasing.");
  p.require_last();
  p.points("Positions [m]", positions, "Where the blade's frame stands at these times, world frame.");
  p.require_last();
  p.points("Rotations [degrees]", rotations,
           "How the blade's frame is turned at these times: rotation vectors. Empty: never turned.");
}

void CutSurfaceParameters::describe(Parameters& p) {
  p.number("Time [s]", time, non_negative, "When it cuts: before the first step that begins then or later.");
  p.choice("Shape", shape, {"plane", "sphere", "cylinder", "disc", "mesh"},
           "What cuts, in the world frame, every body as it stands at that time. Of the keys below, those of the shape "
           "must be set, and no others.");
  p.require_last();
}

void ShapeParameters::describe(Parameters& p) {
  const auto is_any_of = [&](const std::vector<std::string>& shapes) {
    return shape.empty() || std::find(shapes.begin(), shapes.end(), shape) != shapes.end();
  };
  const auto require_of_a_shape = [&] {
    if (!shape.empty())
      p.require_last();
  };
  if (is_any_of({"plane", "sphere", "cylinder", "disc"})) {
    p.vector("Point [m]", point, "Plane: a point of it. Sphere, cylinder, disc: the centre.");
    require_of_a_shape();
  }
  if (is_any_of({"plane", "disc"})) {
    p.vector("Normal [1]", normal, "Plane, disc: the normal, of any length.");
    require_of_a_shape();
  }
  if (is_any_of({"cylinder"})) {
    p.vector("Axis [1]", axis, "Cylinder: direction of its axis, of any length.");
    require_of_a_shape();
    p.number("Height [m]", height, positive, "Cylinder: from end face to end face, both of which cut.");
    require_of_a_shape();
  }
  if (is_any_of({"sphere", "cylinder", "disc"})) {
    p.number("Radius [m]", radius, positive, "Sphere, cylinder, disc.");
    require_of_a_shape();
  }
  if (is_any_of({"mesh"})) {
    p.text("Mesh", mesh, "Mesh: open or closed triangles (OFF, OBJ, STL, PLY); what it crosses evenly stays whole.");
    require_of_a_shape();
    p.number("Mesh unit [m]", mesh_unit, positive, "Mesh: length of one unit of its file.");
  }
}

void OutputParameters::describe(Parameters& p) {
  p.integer("Frames every [1]", frames_every, at_least_one,
            "Steps between frames of corner positions and velocities in run.h5; its series have every step.");
}

void SurfaceFileParameters::describe(Parameters& p) {
  p.integer("Every [1]", every, at_least_one, "Steps between two states in surface_BODY.vtkhdf.");
}

void ObservableParameters::describe(Parameters& p) {
  p.text("Names", names,
         "Quantities of every body to record at every step, separated by commas: " + observable_names() + ".");
  p.require_last();
}

void ImageParameters::describe(Parameters& p) {
  p.integer("Every [1]", every, at_least_one, "Steps between two images.");
  p.integer("Width [1]", width, {16, 8192}, "Pixels.");
  p.integer("Height [1]", height, {16, 8192}, "Pixels.");
  p.vector("Eye [m]", eye, "Where the camera stands, world frame.");
  p.require_last();
  p.vector("Target [m]", target, "What the middle of the image shows.");
  p.require_last();
  p.vector("Up [1]", up, "Direction that is up in the image.");
  p.number("Field of view [degrees]", field_of_view, {.min = 1, .max = 150}, "Vertical opening angle.");
}

std::vector<SectionKind> grammar() {
  const SectionKind body{
    "Body",
    Occurrence::named,
    "A deformable solid.",
    keys_of<BodyParameters>(),
    {{"Material", Occurrence::once, "Elastic law and density.", keys_of<material::Elastic>(), {}},
     {"Damping",
      Occurrence::once,
      "Rayleigh damping. Without this section there is none.",
      keys_of<DampingParameters>(),
      {}},
     {"Implicit Euler", Occurrence::once, "Settings of that integrator.", keys_of<ImplicitEulerParameters>(), {}},
     {"Symplectic Euler", Occurrence::once, "Settings of that integrator.", keys_of<SymplecticEulerParameters>(), {}},
     {"Support", Occurrence::named, "A box whose grid nodes are held or moved.", keys_of<SupportParameters>(), {}}}};
  return {
    {"Time", Occurrence::once, "Steps of the run.", keys_of<TimeParameters>(), {}},
    {"Gravity", Occurrence::once, "A uniform field.", keys_of<GravityParameters>(), {}},
    body,
    {"Blade", Occurrence::named, "A moving blade that cuts every body it meets.", keys_of<BladeParameters>(), {}},
    {"Cut surface",
     Occurrence::named,
     "A surface that cuts every body it meets, all of it at once.",
     keys_of<CutSurfaceParameters, ShapeParameters>(),
     {}},
    {"Output", Occurrence::once, "What run.h5 holds.", keys_of<OutputParameters>(), {}},
    {"Observables",
     Occurrence::once,
     "Quantities over time in run.h5. Without this section there are none.",
     keys_of<ObservableParameters>(),
     {}},
    {"Surface file",
     Occurrence::once,
     "The surface as a time series for ParaView. Without this section there is none.",
     keys_of<SurfaceFileParameters>(),
     {}},
    {"Images",
     Occurrence::once,
     "PNG images. Without this section no graphics are started.",
     keys_of<ImageParameters>(),
     {}},
  };
}

} // namespace kerf::scene
