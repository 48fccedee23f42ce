#include "scene/grammar_tools.h"

#include "scene/region.h"

#include <algorithm>

namespace kerf::scene {

namespace {

void describe_edge_form(Parameters& p, std::string& form) {
  p.choice("Edge form", form, {"polyline", "arcs"},
           "What the points of the edge are: the corners of a polyline; or a chain of arcs, each through three points, "
           "the last of which begins the next.");
}

} // namespace

void MotionParameters::describe(Parameters& p) {
  p.numbers("Times [s]", times, any_number, "Times of the key frames, increasing.");
  p.require_last();
  p.points("Positions [m]", positions, "Where the tool's frame stands at these times, world frame.");
  p.require_last();
  p.points("Rotations [degrees]", rotations,
           "How the tool's frame is turned at these times: rotation vectors. Empty: never turned.");
}

void BladeParameters::describe(Parameters& p) {
  p.points("Edge [m]", edge, "The cutting edge, in the blade's frame.");
  p.require_last();
  describe_edge_form(p, edge_form);
  p.vector("Spine [m]", spine,
           "From the cutting edge to the back of the blade, in its frame; only drawn. Zero: against the blade's first "
           "motion, a "
           "fifth of the edge long.");
}

void ScissorsParameters::describe(Parameters& p) {
  p.vector("Pivot [m]", pivot, "A point of the axis that the blades turn on, in the tool's frame.");
  p.require_last();
  p.vector("Axis [1]", axis,
           "Direction of that axis, of any length: the first blade opens counter-clockwise about it.");
  p.require_last();
  p.points("Edge [m]", edge, "The cutting edges where they meet when closed, in the tool's frame.");
  p.require_last();
  describe_edge_form(p, edge_form);
  p.points("Second edge [m]", second_edge, "The second blade's edge when closed. Empty: the same as the first's.");
  p.vector("Spine [m]", spine,
           "From the first edge to the back of its blade when closed; the second has it the other way round. Only "
           "drawn. Zero: to the side that it opens to, a tenth of the edge long.");
  p.number("Handle [m]", handle, non_negative, "Length of the handles beyond the pivot; only drawn.");
  p.numbers("Opening times [s]", opening_times, any_number, "Times at which the opening is given, increasing.");
  p.require_last();
  p.numbers("Openings [degrees]", openings, {.min = 0, .max = 180, .min_excluded = false, .max_excluded = true},
            "Angle between the blades at these times, linear in between: 0 is closed.");
  p.require_last();
}

void ForcepsParameters::describe(Parameters& p) {
  p.choice(
    "Region", region, region_names(),
    "What is held: the corners (or phyxels) of every body that lie here in the rest configuration. Of the keys below, "
    "those of the region must be set, and no others.");
  p.require_last();
  p.number("Grip time [s]", grip_time, non_negative,
           "Held from where it is then, before the first step that begins then or later.");
  p.number("Release time [s]", release_time, non_negative,
           "Free again, with its velocity, before the first step that begins then or later.");
  p.vector("Jaws [m]", jaws,
           "From the middle between the jaws to one of them while they hold, tool frame; only drawn. Zero: as far "
           "apart as what they "
           "hold.");
  p.vector("Handle [m]", handle,
           "From the middle between the jaws to the joint of the arms; only drawn. Zero: away from the body, four "
           "times the size of what they hold.");
}

void CutSurfaceParameters::describe(Parameters& p) {
  p.number("Time [s]", time, non_negative, "When it cuts: before the first step that begins then or later.");
  p.choice("Shape", shape, {"plane", "sphere", "cylinder", "disc", "rectangle", "mesh"},
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
  if (is_any_of({"plane", "sphere", "cylinder", "disc", "rectangle"})) {
    p.vector("Point [m]", point, "Plane: a point of it. Sphere, cylinder, disc, rectangle: the centre.");
    require_of_a_shape();
  }
  if (is_any_of({"plane", "disc"})) {
    p.vector("Normal [1]", normal, "Plane, disc: the normal, of any length.");
    require_of_a_shape();
  }
  if (is_any_of({"rectangle"})) {
    p.vector("First side [m]", first_side, "Rectangle: direction and length of one side.");
    require_of_a_shape();
    p.vector("Second side [m]", second_side, "Rectangle: the same of the other, at right angles.");
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
    p.file("Mesh", mesh, "Mesh: open or closed triangles (OFF, OBJ, STL, PLY); what it crosses evenly stays whole.");
    require_of_a_shape();
    p.number("Mesh unit [m]", mesh_unit, positive, "Mesh: length of one unit of its file.");
  }
}

std::vector<SectionKind> tool_kinds() {
  return {
    {"Blade",
     Occurrence::named,
     "A moving blade that cuts every body it meets.",
     keys_of<BladeParameters, MotionParameters>(),
     {}},
    {"Scissors",
     Occurrence::named,
     "Two blades on a pivot, which move as a whole and cut every body they meet, but only while they close.",
     keys_of<ScissorsParameters, MotionParameters>(),
     {}},
    {"Forceps",
     Occurrence::named,
     "A tool that holds a part of a body for a time and carries it with its own rigid motion.",
     keys_of<ForcepsParameters, RegionParameters, MotionParameters>(),
     {}},
    {"Cut surface",
     Occurrence::named,
     "A surface that cuts every body it meets, all of it at once.",
     keys_of<CutSurfaceParameters, ShapeParameters>(),
     {}},
  };
}

} // namespace kerf::scene
