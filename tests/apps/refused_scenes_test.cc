// Scenes that cannot be: exit code 1, and one line that says where, what, which rule and what to do.

#include "tests/apps/program.h"

namespace kerf::apps::refused_scenes_test {
namespace {

using RefusedScene = Program;

/// "scene.prm:7: ", of the line that holds `words`.
std::string at(const std::string& scene, const std::string& words) {
  EXPECT_NE(scene.find(words), std::string::npos) << words;
  return "scene.prm:" + std::to_string(line_of(scene, words)) + ": ";
}

TEST_F(RefusedScene, MisspeltKey) {
  const std::string scene = replaced(cube_scene(), "Density [kg/m^3]", "Densty [kg/m^3]");
  expect_refused(scene, {at(scene, "Densty"), "Body cube/Material/Densty [kg/m^3] = '1000'", "no such key",
                         "Did you mean 'Density [kg/m^3]'"});
}

TEST_F(RefusedScene, MisspeltSection) {
  const std::string scene = replaced(cube_scene(), "subsection Material", "subsection Materiel");
  expect_refused(scene, {at(scene, "Materiel"), "Body cube/Materiel", "no such section", "Did you mean 'Material'"});
}

TEST_F(RefusedScene, SectionThatNothingReads) {
  const std::string scene = replaced(
    cube_scene(), "  subsection Material",
    "  set Integrator = symplectic Euler\n  subsection Implicit Euler\n    set CG tolerance [1] = 1e-3\n  end\n"
    "  subsection Material");
  expect_refused(scene,
                 {at(scene, "Implicit Euler"), "Body cube/Implicit Euler", "nothing reads this section", "Remove it"});
  const std::string other =
    replaced(replaced(scene, "symplectic Euler", "implicit Euler"),
             "  subsection Implicit Euler\n    set CG tolerance [1] = 1e-3", "  subsection Symplectic Euler");
  expect_refused(other, {at(other, "Symplectic Euler"), "Body cube/Symplectic Euler", "nothing reads this section"});
}

TEST_F(RefusedScene, ValueOutOfItsRange) {
  struct Bad {
    std::string line, path, value, rule;
  };
  const std::vector<Bad> bad = {
    {"Young's modulus [Pa] = 1e4", "Body cube/Material/Young's modulus [Pa]", "0", "must be > 0"},
    {"Young's modulus [Pa] = 1e4", "Body cube/Material/Young's modulus [Pa]", "-5", "must be > 0"},
    {"Young's modulus [Pa] = 1e4", "Body cube/Material/Young's modulus [Pa]", "stiff", "is no number; must be > 0"},
    {"Young's modulus [Pa] = 1e4", "Body cube/Material/Young's modulus [Pa]", "1e", "is no number; must be > 0"},
    {"Poisson's ratio [1]  = 0.3", "Body cube/Material/Poisson's ratio [1]", "0.5", "must be > -1 and < 0.5"},
    {"Poisson's ratio [1]  = 0.3", "Body cube/Material/Poisson's ratio [1]", "0.7", "must be > -1 and < 0.5"},
    {"Time step [s] = 0.01", "Time/Time step [s]", "0", "must be > 0"},
    {"Time step [s] = 0.01", "Time/Time step [s]", "-1", "must be > 0"},
    {"Time step [s] = 0.01", "Time/Time step [s]", "1", "must be at least one time step"},
    {"Time step [s] = 0.01", "Time/Time step [s]", "1e-30", "must lead to the end within 1e9 steps"},
    {"Cube edge [m] = 0.05", "Body cube/Cube edge [m]", "0", "must be > 0"},
    {"Cube edge [m] = 0.05", "Body cube/Cube edge [m]", "-0.1", "must be > 0"},
    {"Cube edge [m] = 0.05", "Body cube/Cube edge [m]", "1e-12", "would fill the body with 8e+33 cells"},
    {"Cube edge [m] = 0.05", "Body cube/Cube edge [m]", "3", "smaller than a cube"},
  };
  for (const Bad& b : bad) {
    const std::string key = b.line.substr(0, b.line.find('='));
    const std::string scene = replaced(cube_scene(), b.line, key + "= " + b.value);
    const bool is_about_end = b.rule.find("at least one") != std::string::npos; // told at the end time
    SCOPED_TRACE(b.path + " = " + b.value);
    if (is_about_end)
      expect_refused(scene, {at(scene, "End time"), "Time/End time [s] = '0.05'", b.rule, "smaller time step"});
    else
      expect_refused(scene, {at(scene, key), b.path + " = '" + b.value + "'", b.rule});
  }
}

TEST_F(RefusedScene, LatticeOffsetOutOfItsRange) {
  const std::string scene =
    replaced(cube_scene(), "  subsection Material", "  set Lattice offset [1] = 2, 0, 0\n  subsection Material");
  expect_refused(scene, {at(scene, "Lattice"), "Body cube/Lattice offset [1] = '2, 0, 0'", "[-1, 1]"});
}

TEST_F(RefusedScene, OverrideIsNamedAsSuch) {
  expect_refused(cube_scene(), {"--set \"Time/Time step [s]=0\"", "Time/Time step [s] = '0'", "must be > 0"},
                 {"--set", "Time/Time step [s]=0"});
  expect_refused(cube_scene(), {"--set \"nonsense\"", "Section/Key=value"}, {"--set", "nonsense"});
}

TEST_F(RefusedScene, MissingSection) {
  expect_refused("subsection Time\nend\n", {"scene.prm", "Body", "must be written", "subsection Body"});
}

TEST_F(RefusedScene, BladeThatNeverComesNear) {
  const std::string scene = cube_scene() +
                            "subsection Blade knife\n  set Edge [m] = 0, 0, 0; 0, 1, 0\n  set Times [s] = 0, 1\n"
                            "  set Positions [m] = 5, 0, 0; 6, 0, 0\nend\n";
  expect_refused(scene, {at(scene, "Blade knife"), "Blade knife", "never comes near a body", "units and key frames"});
}

TEST_F(RefusedScene, KeyFramesThatDoNotFit) {
  const std::string scene = cube_scene() + falling_blade(), times = "Times [s]     = 0, 0.05";
  std::string wrong = replaced(scene, times, "Times [s]     = 0");
  expect_refused(wrong, {at(wrong, "Positions"), "Blade knife/Positions [m] = '0.003, 0, 0.13; 0.003, 0, -0.13'",
                         "must be as many as Times [s], which are 1", "one position for each time"});
  wrong = replaced(scene, "end\nsubsection Blade knife\n",
                   "end\nsubsection Blade knife\n  set Rotations [degrees] = 0, 0, 0\n");
  expect_refused(wrong,
                 {at(wrong, "Rotations"), "Rotations [degrees] = '0, 0, 0'", "as many as Times [s], which are 2"});
  wrong = replaced(scene, times, "Times [s]     = 0.05, 0.05");
  expect_refused(wrong, {at(wrong, "Times"), "Blade knife/Times [s] = '0.05, 0.05'", "times must increase", "Sort"});
  wrong = replaced(scene, "0, -0.2, 0; 0, 0.2, 0", "0, -0.2, 0");
  expect_refused(wrong, {at(wrong, "Edge [m]"), "Blade knife/Edge [m] = '0, -0.2, 0'", "at least two points", "ends"});
}

TEST_F(RefusedScene, SupportThatHoldsNothing) {
  const std::string support =
    "  subsection Support floor\n    set Lower [m] = 1, 1, 1\n    set Upper [m] = 2, 2, 2\n  end\n";
  std::string scene = replaced(cube_scene(), "  subsection Material", support + "  subsection Material");
  expect_refused(scene,
                 {at(scene, "Support"), "Body cube/Support floor", "holds no corner or phyxel", "Move or enlarge it"});
  scene = replaced(scene, "Upper [m] = 2, 2, 2", "Upper [m] = 2, 0, 2");
  expect_refused(scene, {at(scene, "Upper"), "Support floor/Upper [m] = '2, 0, 2'", "must not be below Lower", "Swap"});
}

TEST_F(RefusedScene, DisplacementThatIsNoExpression) {
  for (const std::string text : {"0; 0; sin(t", "0; 0; u", "0; 0", "0; 0; 1/t", "0; 0; t +", "0; ; 0"}) {
    const std::string scene =
      replaced(cube_scene(), "  subsection Material",
               "  subsection Support top\n    set Lower [m] = -1, -1, 0.05\n    set Upper [m] = 1, 1, 1\n"
               "    set Displacement [m] = " +
                 text + "\n  end\n  subsection Material");
    SCOPED_TRACE(text);
    expect_refused(scene, {at(scene, "Displacement"), "Body cube/Support top/Displacement [m] = '" + text + "'",
                           "must be", "For example: 0; 0; 0.01*sin(2*pi*t)"});
  }
}

TEST_F(RefusedScene, ObservablesThatDoNotExistOrComeTwice) {
  std::string scene = cube_scene() + "subsection Observables\n  set Names = volume, volum\nend\n";
  expect_refused(
    scene, {at(scene, "Names"), "Observables/Names = 'volume, volum'", "'volum' is not an observable", "Did you mean 'volume'", "kerf params"});
  scene = replaced(scene, "volum\n", "volume\n");
  expect_refused(scene, {at(scene, "Names"), "'volume' is named twice"});
}

TEST_F(RefusedScene, CameraThatSeesNothing) {
  std::string scene = cube_scene() + "subsection Images\n  set Eye [m] = 0, 0, 1\n  set Target [m] = 0, 0, 1\nend\n";
  expect_refused(scene, {at(scene, "Eye"), "Images/Eye [m] = '0, 0, 1'", "apart from the target", "Move the eye"});
  scene = replaced(scene, "Target [m] = 0, 0, 1", "Target [m] = 0, 0, 0\n  set Up [1] = 0, 0, 1");
  expect_refused(scene, {at(scene, "Up"), "Images/Up [1] = '0, 0, 1'", "parallel to the view", "another up direction"});
}

} // namespace
} // namespace kerf::apps::refused_scenes_test
