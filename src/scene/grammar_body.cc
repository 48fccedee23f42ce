#include "scene/grammar_body.h"

#include "dynamics/body_force.h"
#include "dynamics/floor.h"
#include "dynamics/handle.h"
#include "dynamics/loads.h"
#include "dynamics/surface_load.h"
#include "material/elastic.h"
#include "scene/crack.h"
#include "scene/grammar_interior.h"
#include "scene/grammar_physics.h"
#include "scene/initial_state.h"
#include "scene/region.h"

#include <algorithm>

namespace kerf::scene {

void BodyShapeParameters::describe(Parameters& p) {
  const auto is_any_of = [&](const std::vector<std::string>& shapes) {
    return shape.empty() || std::find(shapes.begin(), shapes.end(), shape) != shapes.end();
  };
  const auto require_of_a_shape = [&] {
    if (!shape.empty())
      p.require_last();
  };
  if (is_any_of({"mesh"})) {
    p.file("Mesh", mesh, "Mesh: closed triangles (OFF, OBJ, STL, PLY); a relative path starts at the scene file.");
    require_of_a_shape();
    p.number("Mesh unit [m]", mesh_unit, positive, "Mesh: length of one unit of the file.");
  }
  if (is_any_of({"box", "ball", "cylinder"}))
    p.vector("Centre [m]", centre, "Box, ball, cylinder: the middle.");
  if (is_any_of({"box"})) {
    p.vector("Sides [m]", sides, "Box, which must say it: lengths of its sides along x, y, z, before it is turned.");
    require_of_a_shape();
    p.vector("Rotation [degrees]", rotation, "Box: turned about its middle by this rotation vector.");
  }
  if (is_any_of({"ball", "cylinder"})) {
    p.number(
      "Radius [m]", radius, positive,
      "Ball, cylinder, which must say it: the radius. Their triangles are half a cube wide, and enclose the volume of the round body.");
    require_of_a_shape();
  }
  if (is_any_of({"cylinder"})) {
    p.number("Height [m]", height, positive, "Cylinder, which must say it: from end face to end face.");
    require_of_a_shape();
    p.vector("Axis [1]", axis, "Cylinder: direction of its axis, of any length.");
  }
}

void BodyParameters::describe(Parameters& p) {
  p.choice("Shape", shape, {"mesh", "box", "ball", "cylinder"},
           "What the body is. Of the keys below, those of the shape must be set where they have no default, and no "
           "others.");
  p.number("Cube edge [m]", cube_edge, positive, "Edge h of the grid's cubes: the resolution of physics and cuts.");
  p.require_last();
  p.vector(
    "Lattice offset [1]", lattice_offset,
    "How far inside the lower end of the mesh's bounding box the first grid nodes stand along x, y, z, in parts of "
    "a cube's edge. A half keeps the plane sides of a box away from grid nodes.");
  p.number("Sharp angle [degrees]", sharp_angle, {.min = 0, .max = 90, .min_excluded = true, .max_excluded = true},
           "Two cut planes that turn by more than this inside a face meet at a sharp edge (thesis §2.4.3).");
  p.choice("Backend", backend, backend_names(),
           "The physics: hexahedral finite elements, point-based animation, lattice shape matching, or springs.");
  p.choice("Integration", integration, {"octants", "volume fraction", "full cube"},
           "Backend fem: how a partly filled cell counts: with its own material; as a cube of less density and "
           "stiffness, by its "
           "volume; or as a full cube.");
  p.choice("Element", element, {"trilinear", "enhanced"},
           "Backend fem: strain inside a cell: that of the trilinear displacement, too stiff in bending and near a "
           "Poisson's ratio of "
           "0.5, or enhanced by 12 modes of the cell's own, which cure both.");
  p.choice(
    "Mass", mass, {"lumped", "consistent"},
    "Backend fem: a mass for each corner, or the mass matrix of the shape functions, whose frequencies are nearer to "
    "those of the body in bending; for implicit integrators only.");
  p.choice("Integrator", integrator, integrator_names(),
           "How time advances; lattice shape matching is an integrator by itself. Quasi-static: each step is the "
           "equilibrium of its "
           "end. Modal: nothing moves; each step finds the lowest frequencies of the body as cuts have left it.");
}

void DampingParameters::describe(Parameters& p) {
  p.number("Mass damping [1/s]", mass, non_negative, "Rayleigh's alpha: a force -alpha M v.");
  p.number("Stiffness damping [s]", stiffness, non_negative,
           "Rayleigh's beta: a force -beta K v. K of any law but the corotational, and of points and springs, knows "
           "the stress: there a spin omega is braked too, by beta omega^3.");
}

void SupportParameters::describe(Parameters& p) {
  p.choice("Region", region, region_names(),
           "What is held: the corners (or phyxels) that lie here in the rest configuration. Of the keys below, those "
           "of the region must be set, and no others.");
  p.choice("Hold", hold, dynamics::hold_words(),
           "In all directions, or along these axes only: it slides along the others.");
  p.choice("Hold at", hold_at, {"corners", "skin"},
           "Corners: those in the region, or phyxels, go exactly where they are told; they seldom lie on the skin, so "
           "up to half a cube of the body is held too much or too little. Skin: its triangles whose rest centre is in "
           "the region, by a stiff spring for each area; the force is then among the observables 'load forces', not "
           "'reactions'. Not for the backend lattice.");
  p.number("Skin stiffness [1]", skin_stiffness, positive,
           "Hold at skin: the stiffness for each area [N/m^3] is this times Young's modulus over the cube edge h. A "
           "held face gives way by its strain times h over this; explicit steps must be the smaller the larger it is.");
  p.vector("Held direction [1]", direction,
           "Held along this direction only, of any length, and slides across it. Zero: what Hold says.");
  p.text("Displacement [m]", displacement,
         "How far the region has moved from rest: three expressions of the time t, separated by semicolons.");
  p.text("Rotation [degrees]", rotation,
         "How the region is turned about the pivot, before it is moved: a rotation vector, three expressions of t.");
  p.vector("Pivot [m]", pivot, "What the region turns about, rest configuration.");
}

std::vector<SectionKind> body_kinds() {
  std::vector<SectionKind> inside = {
    {"Material", Occurrence::once, "Elastic law and density.", keys_of<material::Elastic>(), {}},
    {"Damping",
     Occurrence::once,
     "Rayleigh damping. Without this section there is none.",
     keys_of<DampingParameters>(),
     {}},
    {"Initial state",
     Occurrence::once,
     "Where the body is at time 0, and how it moves. Without this section it is at rest.",
     keys_of<InitialStateParameters>(),
     {}},
    {"Support",
     Occurrence::named,
     "A region that is held, slides or is moved.",
     keys_of<SupportParameters, RegionParameters>(),
     {}},
    {"Body force",
     Occurrence::named,
     "A force per volume beside gravity.",
     keys_of<dynamics::BodyForceParameters>(),
     {}},
    {"Traction",
     Occurrence::named,
     "A force per rest area on a part of the surface; it keeps its direction. Crumbs of less than a quarter of a cube "
     "bear none.",
     keys_of<dynamics::TractionParameters>(),
     {}},
    {"Pressure",
     Occurrence::named,
     "A pressure on a part of the surface; it follows the surface. Crumbs of less than a quarter of a cube bear none.",
     keys_of<dynamics::PressureParameters>(),
     {}},
    {"Handle",
     Occurrence::named,
     "A point drawn towards a moving target by a spring and a damper.",
     keys_of<dynamics::HandleParameters>(),
     {}},
    {"Probe",
     Occurrence::named,
     "A point whose motion is reported; see the observables probes and probe strains.",
     keys_of<ProbeParameters>(),
     {}}};
  inside.push_back(crack_front_kind());
  const auto physics = physics_kinds();
  inside.insert(inside.begin() + 2, physics.begin(), physics.end());
  inside.push_back(interior_kind());
  return {{"Body", Occurrence::named, "A deformable solid.", keys_of<BodyParameters, BodyShapeParameters>(), inside},
          {"Floor",
           Occurrence::named,
           "A plane that every body lands on, with friction.",
           keys_of<dynamics::FloorParameters>(),
           {}}};
}

} // namespace kerf::scene
