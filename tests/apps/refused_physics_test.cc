// Physics, loads and supports that cannot be: exit code 1 (2 for a file), and one line that says where, what, which
// rule and what to do.

#include "tests/apps/program.h"

namespace kerf::apps::refused_physics_test {
namespace {

/// The cube's scene with lines before its material, and sections behind it.
std::string scene_with(const std::string& inside, const std::string& outside = "") {
  return replaced(cube_scene(), "  subsection Material", inside + "  subsection Material") + outside;
}

/// "scene.prm:7: ", of the line that holds `words`.
std::string at(const std::string& scene, const std::string& words) {
  EXPECT_NE(scene.find(words), std::string::npos) << words;
  return "scene.prm:" + std::to_string(line_of(scene, words)) + ": ";
}

Words operator+(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

class RefusedPhysics : public Program {
 protected:
  /// The complaint comes from the line that holds `where`.
  void refuse(const std::string& scene, const std::string& where, Words parts, const Words& more = {}) const {
    SCOPED_TRACE(scene);
    parts.insert(parts.begin(), at(scene, where));
    expect_refused(scene, parts, more);
  }
};

const std::string bottom =
  "  subsection Support bottom\n    set Lower [m] = -1, -1, -1\n    set Upper [m] = 1, 1, -0.05\n";

TEST_F(RefusedPhysics, NoDisplacementFormulationIsIncompressible) {
  for (const std::string backend : {"fem", "pba", "lattice", "mass-spring"}) {
    const std::string scene = replaced(scene_with("  set Backend = " + backend + "\n"), "= 0.3", "= 0.5");
    refuse(scene, "Poisson", {"Body cube/Material/Poisson's ratio [1] = '0.5'", "must be > -1 and < 0.5"});
  }
}

TEST_F(RefusedPhysics, ContradictorySupports) {
  const std::string moved = replaced(bottom, "Support bottom", "Support hand");
  const std::string scene = scene_with(bottom + "  end\n" + moved + "    set Displacement [m] = 0; 0; 0.01*t\n  end\n");
  refuse(scene, "Support hand",
         {"Body cube/Support hand", "at 0.025 s", "0.00025 m away", "'Support bottom'", "Let the regions not overlap"});
}

TEST_F(RefusedPhysics, DirectionBesideHold) {
  refuse(scene_with(bottom + "    set Hold = x\n    set Held direction [1] = 1, 1, 0\n  end\n"), "Held direction",
         {"Body cube/Support bottom/Held direction [1] = '1, 1, 0'", "cannot stand beside the key Hold", "Remove one"});
}

TEST_F(RefusedPhysics, LoadsOnNothing) {
  const std::string box = "    set Lower [m] = 5, 5, 5\n    set Upper [m] = 6, 6, 6\n  end\n";
  for (const std::string load : {"Traction", "Pressure"})
    refuse(scene_with("  subsection " + load + " push\n" + box), load,
           {"Body cube/" + load + " push", "acts on nothing", "Check Faces, Lower [m] and Upper [m]"});
  refuse(scene_with("  subsection Handle hand\n    set Point [m] = 0, 0, 0.2\n  end\n"), "Point",
         {"Body cube/Handle hand/Point [m] = '0, 0, 0.2'", "no material there at rest", "Choose a point inside"});
}

TEST_F(RefusedPhysics, ProbeOutside) {
  refuse(scene_with("  subsection Probe eye\n    set Point [m] = 0.2, 0, 0\n  end\n"), "Point",
         {"Body cube/Probe eye/Point [m] = '0.2, 0, 0'", "no material there at rest", "Choose a point inside"});
}

TEST_F(RefusedPhysics, StaticsWithoutSupportNamesWhatIsFree) {
  const std::string all =
    "translation along x, translation along y, translation along z, rotation about x, rotation "
    "about y, rotation about z.";
  const std::string sliding = "translation along y, translation along z, rotation about x.";
  for (const std::string backend : {"fem", "pba", "mass-spring"}) {
    const std::string statics = "  set Integrator = quasi-static\n  set Backend = " + backend + "\n";
    refuse(scene_with(statics), "quasi-static",
           {"Body cube/Integrator = 'quasi-static'", "no static answer: " + all, "Add supports or handles"});
    refuse(scene_with(statics + bottom + "    set Hold = x\n  end\n"), "quasi-static",
           {"no static answer: " + sliding});
  }
}

/// Statics that a cut leaves without support is refused when it happens.
TEST_F(RefusedPhysics, StaticsOfAPieceThatACutSetsFree) {
  const std::string scene = scene_with("  set Integrator = quasi-static\n" + bottom + "  end\n",
                                       "subsection Cut surface knife\n  set Time [s] = 0.02\n  set Shape = plane\n"
                                       "  set Point [m] = 0, 0, 0.003\n  set Normal [1] = 0, 0, 1\nend\n");
  const Result result = run(scene);
  expect_error(result, 1, {"body cube, step 3", "nothing resists", "rotation about z of piece 1", "Add supports"});
}

TEST_F(RefusedPhysics, TooFewPhyxels) {
  refuse(scene_with("  set Backend = pba\n  subsection Phyxels\n    set Spacing [m] = 0.2\n  end\n"), "Spacing",
         {"Body cube/Phyxels/Spacing [m] = '0.2'", "at least 4 phyxels, and holds 1", "Use a smaller spacing"});
}

TEST_F(RefusedPhysics, SupportSmallerThanTheSpacing) {
  refuse(scene_with("  set Backend = pba\n  subsection Phyxels\n    set Support [m] = 0.01\n  end\n"), "Support [m]",
         {"Body cube/Phyxels/Support [m] = '0.01'", "must have others within its support", "Use a larger support"});
}

TEST_F(RefusedPhysics, UnknownCriterion) {
  refuse(scene_with("  set Backend = pba\n  subsection Visibility\n    set Criterion = sight\n  end\n"), "Criterion",
         {"Body cube/Visibility/Criterion = 'sight'",
          "must be one of visibility, diffraction, transparency, extended visibility"});
}

TEST_F(RefusedPhysics, UnknownBackendAndIntegrator) {
  refuse(scene_with("  set Backend = sph\n"), "Backend",
         {"Body cube/Backend = 'sph'", "must be one of fem, pba, lattice, mass-spring"});
  refuse(scene_with("  set Integrator = leapfrog\n"), "Integrator",
         {"Body cube/Integrator = 'leapfrog'", "must be one of implicit Euler, BDF2, Newmark"});
}

TEST_F(RefusedPhysics, SettingsOfAnotherBackend) {
  refuse(scene_with("  subsection Phyxels\n    set Spacing [m] = 0.04\n  end\n"), "Phyxels",
         {"Body cube/Phyxels", "nothing reads this section", "Remove it"});
  refuse(scene_with("  set Integrator = symplectic Euler\n  subsection Adaptive step\n  end\n"), "Adaptive step",
         {"Body cube/Adaptive step", "nothing reads this section"});
}

TEST_F(RefusedPhysics, LatticeWithoutWidth) {
  refuse(scene_with("  set Backend = lattice\n  subsection Lattice\n    set Half width [cells] = 0\n  end\n"),
         "Half width", {"Body cube/Lattice/Half width [cells] = '0'", "must be a whole number >= 1"});
}

/// The remedies are right: with any of them the scene runs.
TEST_F(RefusedPhysics, LatticeStiffnessBeyondTheTimeStep) {
  const std::string scene = replaced(scene_with("  set Backend = lattice\n"), "= 1e4", "= 1e6");
  refuse(scene, "Body cube",
         {"a Young's modulus of 50000 Pa at this time step; the material has 1e+06 Pa",
          "Half width [cells] = ", "a time step of 0.00223", "Alpha [1]"});
  EXPECT_EQ(run(scene, {"--set", "Time/Time step [s]=0.00223"}).exit_code, 0);
  EXPECT_EQ(run(scene, {"--set", "Body cube/Lattice/Alpha [1]=1"}).exit_code, 0);
}

TEST_F(RefusedPhysics, LatticeInStatics) {
  refuse(scene_with("  set Backend = lattice\n  set Integrator = quasi-static\n"), "quasi-static",
         {"Body cube/Integrator = 'quasi-static'", "the backend 'lattice' moves in time only", "another integrator"});
}

TEST_F(RefusedPhysics, ObservablesOfWhatIsNotThere) {
  for (const std::string name : {"reactions", "tool forces", "load forces", "probes", "probe strains"})
    refuse(scene_with("", "subsection Observables\n  set Names = volume, " + name + "\nend\n"), "Names",
           {"Observables/Names = 'volume, " + name + "'", "'" + name + "' has nothing to report", "Remove it, or add"});
  refuse(scene_with("  subsection Support wall\n    set Hold at = skin\n    set Lower [m] = -1, -1, -1\n"
                    "    set Upper [m] = 0.01, 1, 1\n  end\n",
                    "subsection Observables\n  set Names = reactions\nend\n"),
         "Names", {"one that holds the skin is a load: ask for 'load forces'"});
}

TEST_F(RefusedPhysics, LoadsThatAreNoExpressions) {
  for (const std::string text : {"1; 2", "x; y; 1/(", "0; 0; w"})
    refuse(scene_with("  subsection Traction push\n    set Traction [N/m^2] = " + text + "\n  end\n"), "set Traction",
           {"Body cube/Traction push/Traction [N/m^2] = '" + text + "'", "must be three expressions of x, y, z and t",
            "For example"});
  refuse(scene_with("  subsection Pressure push\n    set Pressure [Pa] = t; t\n  end\n"), "set Pressure",
         {"Body cube/Pressure push/Pressure [Pa] = 't; t'", "must be one expression of x, y, z and t", "For example"});
}

TEST_F(RefusedPhysics, LoadsThatAreNotFiniteSomewhere) {
  const std::string scene =
    scene_with("  subsection Traction push\n    set Traction [N/m^2] = 0; 0; 1/(t-0.03)\n  end\n");
  expect_error(run(scene), 1,
               {at(scene, "set Traction"), "Body cube/Traction push/Traction [N/m^2] = '0; 0; 1/(t-0.03)'",
                "must be finite, and is not at x, y, z, t = ", "0.03", "Choose an expression"});
}

TEST_F(RefusedPhysics, RegionMeshMissingOrOpen) {
  const std::string support =
    "  subsection Support bottom\n    set Region = mesh\n    set Region mesh = region.off\n  end\n";
  const std::string scene = scene_with(support);
  const Words place = {at(scene, "Region mesh"), "Body cube/Support bottom/Region mesh = 'region.off'"};
  expect_error(run(scene), 2, place + Words{"the mesh file does not exist", "Check the path"});
  write("region.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  expect_error(run(scene), 2, place + Words{"must be the skin of a solid, but it is open", "Fill the holes"});
}

TEST_F(RefusedPhysics, KeysOfAnotherRegion) {
  refuse(scene_with("  subsection Support ball\n    set Region = sphere\n    set Centre [m] = 0, 0, 0\n  end\n"),
         "Support ball", {"the region 'sphere' must have the key 'Radius [m]'", "Write 'set Radius [m] = ...'"});
  refuse(scene_with("  subsection Support ball\n    set Region = sphere\n    set Centre [m] = 0, 0, 0\n"
                    "    set Radius [m] = 0.1\n    set Upper [m] = 1, 1, 1\n  end\n"),
         "Upper", {"the region 'sphere' does not read this key", "Remove it"});
  refuse(scene_with("  subsection Support side\n    set Region = half space\n    set Plane point [m] = 0, 0, 0\n"
                    "    set Plane normal [1] = 0, 0, 0\n  end\n"),
         "Plane normal", {"Plane normal [1] = '0, 0, 0'", "must not be zero"});
}

TEST_F(RefusedPhysics, FloorWithoutNormal) {
  refuse(scene_with("", "subsection Floor ground\n  set Friction [1] = 0\n  set Normal [1] = 0, 0, 0\nend\n"), "Normal",
         {"Floor ground/Normal [1] = '0, 0, 0'", "must not be zero", "away from the floor"});
}

/// One linearisation a step would make friction stick whatever pulls.
TEST_F(RefusedPhysics, FrictionByOneNewtonIteration) {
  const std::string floor = "subsection Floor ground\nend\n";
  refuse(scene_with("", floor), "Body cube",
         {"Newton iterations [1] of 'Implicit Euler'", "friction of a floor needs 3 or more",
          "Write 'subsection Implicit Euler' with 'set Newton iterations [1] = 6'"});
  refuse(
    scene_with("  set Integrator = Newmark\n  subsection Newmark\n    set Newton iterations [1] = 2\n  end\n", floor),
    "Newton iterations", {"Body cube/Newmark/Newton iterations [1] = '2'", "friction of a floor needs 3 or more"});
  for (const std::string integrator : {"Newmark", "BDF2", "generalised alpha"}) { // whose default is more
    write("scene.prm", scene_with("  set Integrator = " + integrator + "\n", floor));
    EXPECT_EQ(kerf({"check", "scene.prm"}).exit_code, 0) << integrator;
  }
}

/// Told at the first step, with the file's line, and the step that would do.
TEST_F(RefusedPhysics, ExplicitStepBeyondTheStableOne) {
  const std::string scene =
    replaced(replaced(scene_with("  set Integrator = velocity Verlet\n"), "step [s] = 0.01", "step [s] = 0.05"),
             "time [s]  = 0.05", "time [s]  = 0.1");
  expect_error(run(scene), 1,
               {at(scene, "Time step"), "Time/Time step [s] = '0.05'", "body cube, step 1", "velocity Verlet is stable",
                "up to 0.01", "Use a smaller time step"});
}

TEST_F(RefusedPhysics, FieldsThatAreNotThere) {
  const auto output = [](const std::string& names) { return "subsection Output\n  set Fields = " + names + "\nend\n"; };
  refuse(scene_with("", output("stress, heat")), "Fields",
         {"Output/Fields = 'stress, heat'", "'heat' is not a field", "von Mises stress"});
  refuse(scene_with("", output("strain, strain")), "Fields", {"'strain' is named twice"});
  for (const std::string backend : {"pba", "lattice", "mass-spring"})
    refuse(scene_with("  set Backend = " + backend + "\n", output("displacement, stress")), "Fields",
           {"'stress' is known of finite elements only, and 'Body cube' has none", "set Backend = fem"});
}

} // namespace
} // namespace kerf::apps::refused_physics_test
