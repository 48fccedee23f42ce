#include "scene/grammar_body.h"

#include "material/elastic.h"

namespace kerf::scene {

namespace {

constexpr Range at_least_one{1, 1e9};

} // namespace

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
  p.choice("Integration", integration, {"octants", "volume fraction", "full cube"},
           "How a partly filled cell counts: with its own material; as a cube of less density and stiffness, by its "
           "volume; or as a full cube.");
  p.choice(
    "Element", element, {"trilinear", "enhanced"},
    "Strain inside a cell: that of the trilinear displacement, too stiff in bending and near a Poisson's ratio of "
    "0.5, or enhanced by 12 modes of the cell's own, which cure both.");
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

std::vector<SectionKind> body_kinds() {
  return {
    {"Body",
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
      {"Support", Occurrence::named, "A box whose grid nodes are held or moved.", keys_of<SupportParameters>(), {}}}}};
}

} // namespace kerf::scene
