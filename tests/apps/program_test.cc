// The program as its users meet it: arguments, summary, what it stores, failures, threads.

#include "tests/apps/program.h"
#include "output/reader.h"

#include <regex>

#include <sched.h>

namespace kerf::apps::program_test {
namespace {

const std::string go_on = "  subsection Symplectic Euler\n    set Beyond the stable step = go on\n  end\n";

using ProgramTest = Program;

TEST_F(ProgramTest, HelpsWithItsArguments) {
  const Result help = kerf({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_NE(help.out.find("kerf run SCENE.prm"), std::string::npos);
  EXPECT_EQ(kerf({}).exit_code, 1);
  const Result unknown = kerf({"rum", "scene.prm"});
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_NE(unknown.err.find("there is no command 'rum'"), std::string::npos);
  EXPECT_NE(unknown.err.find("kerf run SCENE.prm"), std::string::npos);
}

TEST_F(ProgramTest, RefusesArgumentsThatMeanNothing) {
  write("scene.prm", cube_scene());
  expect_error(kerf({"run"}), 1, {"a scene file must be given", "params/liver.prm"});
  expect_error(kerf({"run", "scene.prm", "--bogus"}), 1,
               {"'--bogus'", "is no option", "--set, --output, --threads, --force, --resume, --jobs of run and study, and --row of study"});
  for (const auto& [first, second] : {std::pair{"--force", "--resume"}, std::pair{"--resume", "--force"}})
    expect_error(kerf({"run", "scene.prm", first, second}), 1, {"--force and --resume exclude each other"});
  expect_error(kerf({"check", "scene.prm", "--output", "out"}), 1, {"'--output'", "takes no such option"});
  expect_error(kerf({"run", "scene.prm", "--output"}), 1, {"--output", "needs a value"});
  expect_error(kerf({"check", "scene.prm", "other.prm"}), 1, {"'other.prm'", "only one scene"});
  expect_error(kerf({"run", "scene.prm", "folder/scene.prm"}), 1, {"'folder/scene.prm'", "as another scene does"});
  expect_error(kerf({"params", "scene.prm"}), 1, {"'scene.prm'", "no arguments"});
  for (const std::string n : {"0", "-1", "2.5", "two", "100000", ""})
    expect_error(kerf({"run", "scene.prm", "--threads", n}), 1, {"--threads", n, "whole number from 1 to 1024"});
}

TEST_F(ProgramTest, ChecksWithoutRunning) {
  write("scene.prm", cube_scene());
  const Result result = kerf({"check", "scene.prm"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("left out: Images"), std::string::npos);
  EXPECT_NE(result.out.find("scene.prm is sound: 5 steps of 0.01 s"), std::string::npos) << result.out;
  EXPECT_FALSE(std::filesystem::exists(folder / "results"));
}

/// What `params` prints is a page on scenes that names every section.
TEST_F(ProgramTest, ListsItsParameters) {
  const Result result = kerf({"params"});
  EXPECT_EQ(result.exit_code, 0);
  for (const char* words : {"subsection Time", "subsection Body", "subsection Blade", "subsection Images",
                            "Cube edge [m]", "Young's modulus [Pa]", "kinetic energy"})
    EXPECT_NE(result.out.find(words), std::string::npos) << words;
}

/// Each name that the key takes stands below, with its unit and what it means.
TEST_F(ProgramTest, ListsItsObservables) {
  const std::string page = kerf({"params"}).out;
  std::string key = std::regex_replace(page, std::regex("\n *# "), " ");
  key = key.substr(key.find("separated by commas: ") + 21);
  std::istringstream names(key.substr(0, key.find(". 'kerf params' ends")));
  std::size_t n = 0;
  for (std::string name; std::getline(names >> std::ws, name, ','); ++n)
    EXPECT_TRUE(std::regex_search(page, std::regex("\n# " + name + " \\[[^\\]]+\\]: \\S"))) << name;
  EXPECT_GT(n, 40u);
}

TEST_F(ProgramTest, HelpsBesideACommandAndSaysWhatItIs) {
  for (const Words& words : {Words{"run", "--help"}, {"run", "no.prm", "-h"}, {"study", "--help"}, {"help"}}) {
    const Result help = kerf(words);
    EXPECT_EQ(help.exit_code, 0) << words[0];
    EXPECT_NE(help.out.find("--resume"), std::string::npos) << help.out;
  }
  const std::string page = kerf({"run", "--help"}).out; // a screen, of this command alone
  EXPECT_LT(std::count(page.begin(), page.end(), '\n'), 30);
  EXPECT_EQ(page.find("kerf study"), std::string::npos) << page;
  for (const char* option : {"--set", "--output", "--threads", "--jobs", "--force", "--resume"})
    EXPECT_NE(page.find(std::string("\n  ") + option), std::string::npos) << option;
  for (const char* command : {"check", "study", "bench", "weights", "texture", "params", "table"}) {
    const std::string own = kerf({command, "--help"}).out;
    EXPECT_TRUE(own.starts_with(std::string("usage: kerf ") + command)) << own;
    EXPECT_NE(own.find("exit codes"), std::string::npos) << own;
  }
  const Result version = kerf({"--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_TRUE(std::regex_search(version.out, std::regex(R"(^kerf \d+\.\d+\.\d+, commit .*deal\.II \d)")))
    << version.out;
}

TEST_F(ProgramTest, RefusesAnEmptyFolder) {
  const Result result = kerf({"run", "no.prm", "--output", ""});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("--output: must name a folder"), std::string::npos) << result.err;
}

TEST_F(ProgramTest, SumsUpTheRun) {
  const Result result = run(cube_scene() + falling_blade() + all_outputs());
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  for (
    const char* pattern :
    {R"(step 5/5  t = 0\.050/0\.050 s)", R"(body cube: 125 cells, 150 copies, 2 pieces, \d+ surface triangles)",
     R"(volume: mesh 8\.000000e-03 m\^3; grid [+-]0\.000 %; cuts changed the rest volume by [+-](\d\.\d\de-1\d|0\.00e\+00))",
     R"(energy: elastic \S+ J, kinetic \S+ J)", R"(blade knife: cut 16 grid edges\n)",
     R"(time per stage \[s\]:  cut \S+  topology \S+  assemble \S+  visibility \S+  solve \S+  surface \S+  colour \S+  output \S+  images \S+\n)",
     R"([\d.]+ steps/s without images and files, [\d.]+ with\n)", R"(results in out\n$)"})
    EXPECT_TRUE(std::regex_search(result.out, std::regex(pattern))) << pattern << " in:\n" << result.out;
  EXPECT_EQ(result.out.find("waiting"), std::string::npos);
  EXPECT_EQ(result.out.find('\r'), std::string::npos); // no terminal
}

TEST_F(ProgramTest, SaysThatABladeMetNothing) {
  const std::string scene = cube_scene() + replaced(falling_blade(), "0.003, 0, -0.13", "0.003, 0, 0.12");
  const Result result = run(scene);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("blade knife: cut 0 grid edges: it never met a body"), std::string::npos) << result.out;
}

TEST_F(ProgramTest, StoresWhatItRanAndComposed) {
  const std::string scene = "# a comment\n" + cube_scene();
  const Result result = run(scene, {"--threads", "1", "--set", "Time/End time [s]=0.02"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const output::Reader reader(folder / "out/run.h5");
  EXPECT_EQ(reader.scene(), replaced(scene, "set End time [s]  = 0.05", "set End time [s] = 0.02 # --set"));
  ASSERT_EQ(reader.inputs().size(), 1u);
  EXPECT_TRUE(std::regex_match(reader.inputs()[0], std::regex("[0-9a-f]{64}  /.*/cube\\.off"))) << reader.inputs()[0];
  EXPECT_EQ(reader.outcome(), output::Outcome::completed);
  EXPECT_EQ(reader.n_steps(), 3u);
  for (const std::string& line : reader.composition())
    EXPECT_NE(result.out.find(line + "\n"), std::string::npos) << line;
  const output::RunInfo info = reader.info();
  EXPECT_EQ(info.command_line, "kerf run scene.prm --output out --force --threads 1 --set \"Time/End time [s]=0.02\"");
  EXPECT_EQ(info.n_threads, 1);
  EXPECT_TRUE(std::regex_match(info.version, std::regex(R"(\d+\.\d+\.\d+)"))) << info.version;
  EXPECT_TRUE(std::regex_match(info.started, std::regex(R"(\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ)"))) << info.started;
  EXPECT_NE(info.compiler, "");
  EXPECT_NE(info.git_commit, "");
  EXPECT_NE(info.host, "");
  Words libraries;
  for (const output::Library& library : info.libraries) {
    libraries.push_back(library.name);
    EXPECT_NE(library.version, "") << library.name;
  }
  for (const char* name : {"deal.II", "Eigen", "CGAL", "HDF5"})
    EXPECT_EQ(std::count(libraries.begin(), libraries.end(), name), 1) << name;
}

/// Where no OpenGL context can be made, a scene without images does not even notice.
TEST_F(ProgramTest, AsksForNoOpenGlWithoutImages) {
  const std::string without = "export ASAN_OPTIONS=verify_asan_link_order=0 LD_PRELOAD='" KERF_NO_GL "'";
  const Result plain = run(cube_scene() + falling_blade(), {}, without);
  EXPECT_EQ(plain.exit_code, 0) << plain.err;
  EXPECT_EQ(plain.err, "");
  const Result images = run(cube_scene() + all_outputs(), {}, without);
  EXPECT_EQ(images.exit_code, 2);
  EXPECT_TRUE(images.err.starts_with("a context was asked for\nkerf: ")) << images.err;
  EXPECT_NE(images.err.find("OpenGL"), std::string::npos) << images.err;
}

/// Far beyond the stable time step: exit code 3, body, step, time and quantity, and all that was before.
TEST_F(ProgramTest, TellsHowAComputationFailed) {
  const std::string scene =
    replaced(cube_scene(), "  subsection Material",
             "  set Integrator = symplectic Euler\n" + go_on +
               "  subsection Support top\n"
               "    set Lower [m] = -1, -1, 0.05\n    set Upper [m] = 1, 1, 1\n  end\n  subsection Material") +
    "subsection Gravity\nend\nsubsection Output\n  set Frames every [1] = 1\nend\n";
  const Result result = run(scene, {"--set", "Time/Time step [s]=0.5", "--set", "Time/End time [s]=500"});
  expect_error(result, 3,
               {"body cube, step ", ", time ", " s: the step gained ", " J that no load and no support gave",
                "It shows most at particle ", "Use a smaller time step"});

  const output::Reader reader(folder / "out/run.h5");
  EXPECT_EQ(reader.outcome(), output::Outcome::failed);
  EXPECT_EQ(reader.attribute("/", "outcome"), "failed");
  ASSERT_TRUE(reader.failure());
  EXPECT_EQ("kerf: " + reader.failure()->text + "\n", result.err);
  EXPECT_NE(result.err.find("step " + std::to_string(reader.failure()->step) + ","), std::string::npos);
  EXPECT_DOUBLE_EQ(reader.failure()->time, 0.5 * reader.failure()->step);
  ASSERT_EQ(reader.n_frames("cube"), static_cast<std::size_t>(reader.failure()->step));
  for (std::size_t i = 0; i < reader.n_frames("cube"); ++i)
    EXPECT_EQ(reader.frame("cube", i).positions.size(), 216u);
}

TEST_F(ProgramTest, ShortTimesAreNotRoundedToNothing) {
  const std::string scene = replaced(cube_scene(), "  subsection Material",
                                     "  set Integrator = symplectic Euler\n" + go_on + "  subsection Material");
  const Result result =
    run(scene + "subsection Gravity\nend\n",
        {"--set", "Time/Time step [s]=1e-7", "--set", "Time/End time [s]=1e-4", "--set",
         "Body cube/Material/Density [kg/m^3]=1e-12", "--set", "Body cube/Material/Young's modulus [Pa]=1e12"});
  expect_error(result, 3, {"body cube, step ", "e-"});
}

/// A run of more corners than one thread is given, with a cut through them.
/// As many threads as there are processors that the process may run on, as under taskset.
TEST_F(ProgramTest, TakesAsManyThreadsAsItMayRunOn) {
  cpu_set_t all, one;
  ASSERT_EQ(sched_getaffinity(0, sizeof(all), &all), 0);
  for (const int n : {CPU_COUNT(&all), 1}) {
    CPU_ZERO(&one);
    for (int cpu = 0; cpu < CPU_SETSIZE && CPU_COUNT(&one) < n; ++cpu)
      if (CPU_ISSET(cpu, &all))
        CPU_SET(cpu, &one);
    ASSERT_EQ(sched_setaffinity(0, sizeof(one), &one), 0);
    const Result result = run(cube_scene(), {"--set", "Time/End time [s]=0.01"});
    ASSERT_EQ(sched_setaffinity(0, sizeof(all), &all), 0);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(output::Reader(folder / "out/run.h5").info().n_threads, n);
  }
}

TEST_F(ProgramTest, GivesTheSameBitsForAnyNumberOfThreads) {
  const std::string scene = cube_scene() + falling_blade() + "subsection Gravity\nend\n";
  std::vector<output::Frame> frames;
  for (const std::string threads : {"1", "2", "2"}) {
    const Result result = run(scene, {"--threads", threads, "--set", "Body cube/Cube edge [m]=0.0117"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const output::Reader reader(folder / "out/run.h5");
    EXPECT_EQ(std::to_string(reader.info().n_threads), threads);
    frames.push_back(reader.frame("cube", reader.n_frames("cube") - 1));
    EXPECT_EQ(frames.back().step, 5);
    EXPECT_GE(reader.n_complexes("cube"), 2u);
  }
  EXPECT_GT(frames[0].positions.size(), 2 * 4096u / 2);
  for (const auto& frame : frames) {
    EXPECT_EQ(frame.positions, frames[0].positions);
    EXPECT_EQ(frame.velocities, frames[0].velocities);
  }
}

} // namespace
} // namespace kerf::apps::program_test
