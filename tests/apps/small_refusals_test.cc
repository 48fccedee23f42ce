// Small things that users trip over: what editors write, what is too long to be echoed, devices for files.

#include "output/reader.h"
#include "tests/apps/program.h"

#include <regex>

namespace kerf::apps::small_refusals_test {
namespace {

using SmallRefusals = Program;

TEST_F(SmallRefusals, AByteOrderMarkSaysNothing) {
  EXPECT_EQ(run("\xef\xbb\xbf" + cube_scene()).exit_code, 0) << read_text(folder / "stderr");
}

TEST_F(SmallRefusals, LongValuesAreNotEchoed) {
  const std::string million(1000000, 'k');
  for (const std::string& scene :
       {replaced(cube_scene(), "= 1e4", "= " + million), replaced(cube_scene(), "Density", million),
        replaced(cube_scene(), "Material", million), million}) {
    const Result result = run(scene);
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_LT(result.err.size(), 2000u);
    EXPECT_TRUE(result.err.starts_with("kerf: scene.prm:")) << result.err;
  }
}

TEST_F(SmallRefusals, DevicesAreNoFiles) {
  std::filesystem::create_symlink("/dev/zero", folder / "zero.off");
  expect_error(run(replaced(cube_scene(), mesh_path("cube.off"), "zero.off")), 2,
               {"scene.prm:6", "zero.off", "is not a file that holds a mesh"});
  expect_error(kerf({"check", "/dev/zero"}), 2, {"/dev/zero", "is longer than 64 MB"});
}

TEST_F(SmallRefusals, AMeshThatPromisesTooMuchTakesNoMemory) {
  write("huge.off", "OFF\n8 1000000000 0\n0 0 0\n");
  expect_error(run(replaced(cube_scene(), mesh_path("cube.off"), "huge.off"), {}, "ulimit -v 2000000"), 2,
               {"huge.off", "promises 8 vertices and 1000000000 faces"});
}

TEST_F(SmallRefusals, ExpressionsAssignNothing) {
  const std::string support =
    "  subsection Support top\n    set Lower [m] = -1, -1, 0.05\n    set Upper [m] = 1, 1, 1\n"
    "    set Displacement [m] = 0; 0; ";
  const auto with = [&](const std::string& expression) {
    return replaced(cube_scene(), "  subsection Material", support + expression + "\n  end\n  subsection Material");
  };
  expect_error(run(with("t=3")), 1, {"Displacement [m]", "t=3", "assigns nothing"});
  EXPECT_EQ(run(with("if(t>=0.01, if(t==5, 1, 0.001), 0)")).exit_code, 0) << read_text(folder / "stderr");
}

TEST_F(SmallRefusals, ABladeThatPassesBetweenTheNodesHasMetTheBody) {
  const std::string knife = replaced(replaced(falling_blade(), "0, -0.2, 0; 0, 0.2, 0", "0, -0.005, 0; 0, 0.005, 0"),
                                     "0.003, 0, 0.13; 0.003, 0, -0.13", "0.003, 0, 0.06; 0.003, 0, 0.05");
  const Result result = run(cube_scene() + knife);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("cut 0 grid edges: it passed between them"), std::string::npos) << result.out;
  EXPECT_EQ(result.out.find("it never met a body"), std::string::npos) << result.out;
}

/// The supports' lines, and the two warnings.
TEST_F(SmallRefusals, SupportsSayWhatTheyHold) {
  const auto with = [&](const std::string& lower) {
    return replaced(cube_scene(), "  subsection Material",
                    "  subsection Support top\n    set Lower [m] = -1, -1, " + lower +
                      "\n    set Upper [m] = 1, 1, 1\n  end\n  subsection Material");
  };
  const Result clear = run(with("0.06"));
  EXPECT_NE(clear.out.find("support top holds 72 corners from (-0.125, -0.125, 0.075) to (0.125, 0.125, 0.125) m"),
            std::string::npos)
    << clear.out;
  EXPECT_EQ(clear.out.find("warning"), std::string::npos) << clear.out;
  const Result close = run(with("0.07500000001"));
  EXPECT_NE(close.out.find("warning: body cube: the face z = 0.075 m of support top lies on a layer of nodes"),
            std::string::npos)
    << close.out;
  const auto lines = output::Reader(folder / "out/run.h5").composition();
  EXPECT_TRUE(std::any_of(lines.begin(), lines.end(), [](const auto& l) { return l.starts_with("warning: "); }));
  const Result all = run(replaced(with("-1"), "  set Cube edge", "  set Backend = pba\n  set Cube edge"));
  EXPECT_NE(all.out.find("so nothing of it moves"), std::string::npos) << all.out;
}

/// A half space across an axis like a box; what holds the skin; forceps.
TEST_F(SmallRefusals, EveryHoldSaysWhatItHolds) {
  const auto with = [&](const std::string& keys) {
    return replaced(cube_scene(), "  subsection Material",
                    "  subsection Support top\n" + keys + "  end\n  subsection Material");
  };
  const Result half =
    run(with("    set Region = half space\n    set Plane point [m] = 0, 0, 0.075\n"
             "    set Plane normal [1] = 0, 0, -2\n"));
  EXPECT_NE(half.out.find("the face z = 0.075 m of support top lies on a layer of nodes"), std::string::npos)
    << half.out;
  const Result skin =
    run(with("    set Lower [m] = -1, -1, 0.0999\n    set Upper [m] = 1, 1, 1\n    set Hold at = skin\n"));
  EXPECT_NE(skin.out.find(", 1 supports, 0 loads"), std::string::npos) << skin.out;
  EXPECT_TRUE(std::regex_search(
    skin.out,
    std::regex(
      R"(support top holds 0\.0[34]\d* m\^2 of skin from \(-0\.1, -0\.1, 0\.1\) to \(0\.1, 0\.1, 0\.1\) m, in 1 piece)")))
    << skin.out;
  const Result forceps = run(cube_scene() +
                             "subsection Forceps grip\n  set Region = box\n  set Lower [m] = -1, -1, 0.075\n"
                             "  set Upper [m] = 1, 1, 1\n  set Times [s] = 0, 1\n"
                             "  set Positions [m] = 0, 0, 0.1; 0, 0, 0.1\nend\n");
  EXPECT_NE(forceps.out.find(", from (-0.125, -0.125, "), std::string::npos) << forceps.out << forceps.err;
  EXPECT_NE(forceps.out.find("the face z = 0.075 m of forceps grip lies on a layer of nodes"), std::string::npos)
    << forceps.out;
}

/// A decimal comma, a comma for a semicolon, the time where there is none.
TEST_F(SmallRefusals, ExpressionsTakeNoLooseCommasAndNoTimeAtTheStart) {
  const auto displaced = [&](const std::string& text) {
    return run(
      replaced(cube_scene(), "  subsection Material",
               "  subsection Initial state\n    set Displacement [m] = " + text + "\n  end\n  subsection Material"));
  };
  for (const std::string text : {"0,5*x; 0; 0", "x,y; 0; 0", "(0,1)*x; 0; 0"})
    expect_error(displaced(text), 1, {"Displacement [m]", "a comma separates arguments of a function only", "0.5"});
  expect_error(
    displaced("t; 0; 0"), 1,
    {"Displacement [m]", "three expressions of x, y, z that can be evaluated: ", "\"t\"", "sin(2*pi*x)"});
  expect_error(displaced("x > > 1; 0; 0"), 1, {"Displacement [m]", "operator \">\""});
  EXPECT_EQ(displaced("max(0.001, 0.01*x); 0; 0").exit_code, 0);
}

TEST_F(SmallRefusals, AStudyIsNoScene) {
  write("scene.prm", cube_scene());
  expect_error(kerf({"study", "scene.prm"}), 1, {"scene.prm:", "this is a scene, not a study", "kerf run scene.prm"});
  write("study.prm", "subsection Study\n  set Title = a\nend\n");
  for (const std::string command : {"run", "check"})
    expect_error(kerf({command, "study.prm"}), 1, {"study.prm:1: Study", "not a scene", "kerf study study.prm"});
}

TEST_F(SmallRefusals, ASlabThinnerThanACubeIsToldTheKey) {
  std::string mesh = read_text(mesh_path("cube.off"));
  std::istringstream in(mesh);
  std::string thin, line;
  for (int number = 0; std::getline(in, line); ++number) {
    std::istringstream numbers(line);
    double x, y, z;
    std::string more;
    if (number >= 2 && numbers >> x >> y >> z && !(numbers >> more))
      line = std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(0.1 * z);
    thin += line + "\n";
  }
  write("slab.off", thin);
  const std::string scene = replaced(cube_scene(), mesh_path("cube.off"), "slab.off");
  const Result refused = run(scene);
  EXPECT_EQ(refused.exit_code, 1);
  const std::string key = "'set Lattice offset [1] = ";
  const auto at = refused.err.find(key);
  ASSERT_NE(at, std::string::npos) << refused.err;
  const auto begin = at + key.size();
  const std::string offset = refused.err.substr(begin, refused.err.find('\'', begin) - begin);
  EXPECT_EQ(run(scene, {"--set", "Body cube/Lattice offset [1]=" + offset}).exit_code, 0)
    << read_text(folder / "stderr");
}

} // namespace
} // namespace kerf::apps::small_refusals_test
