// Runs that end early, by signals at any moment, and go on: to the bits of one that nobody disturbed. Folders in use.

#include "output/checkpoint_file.h"
#include "output/h5_array.h"
#include "output/reader.h"
#include "output/stability_file.h"
#include "output/study_file.h"
#include "tests/apps/program.h"

#include <chrono>
#include <csignal>
#include <random>
#include <thread>

namespace kerf::apps::resume_test {
namespace {

/// A cube on a foot; a knife comes through while forceps hold it and draw, and all that a run can write is written.
std::string busy_scene(const std::string& backend) {
  return "subsection Time\n  set Time step [s] = 0.01\n  set End time [s] = 0.3\nend\n"
         "subsection Body cube\n  set Mesh = " +
         mesh_path("cube.off") + "\n  set Cube edge [m] = 0.03\n  set Backend = " + backend +
         "\n  subsection Material\n    set Density [kg/m^3] = 1000\n    set Young's modulus [Pa] = 1.5e4\n"
         "    set Poisson's ratio [1] = 0.3\n  end\n" +
         (backend == "pba" ? "  subsection Visibility\n    set Budget [1] = 40\n  end\n" : "") +
         "  subsection Support foot\n    set Lower [m] = -1, -1, -1\n    set Upper [m] = 1, 1, -0.05\n  end\nend\n"
         "subsection Blade knife\n  set Edge [m] = 0, -0.2, 0; 0, 0.2, 0\n  set Spine [m] = 0, 0, 0.03\n"
         "  set Times [s] = 0, 0.3\n  set Positions [m] = 0.003, 0, 0.13; 0.013, 0, -0.13\nend\n"
         "subsection Forceps grip\n  set Region = sphere\n  set Centre [m] = 0.09, 0, 0.09\n  set Radius [m] = 0.05\n"
         "  set Grip time [s] = 0.05\n  set Jaws [m] = 0.02, 0, 0\n  set Handle [m] = 0, 0, 0.1\n"
         "  set Times [s] = 0.05, 0.3\n"
         "  set Positions [m] = 0.09, 0, 0.09; 0.14, 0, 0.1\nend\n"
         "subsection Observables\n  set Names = kinetic energy, elastic energy, gravity energy, mass, momentum x, "
         "pieces, "
         "cut edges, waiting cuts, work of the cut, missing energy, energy gained, "
         "stable step, waiting pairs, reactions, tool forces, solver iterations, volume\nend\n"
         "subsection Gravity\nend\nsubsection Output\n  set Frames every [1] = 3\n  set Checkpoint every [1] = 4\nend\n"
         "subsection Surface file\nend\n"
         "subsection Images\n  set Every [1] = 5\n  set Width [1] = 64\n  set Height [1] = 48\n"
         "  set Eye [m] = 0.3, -0.6, 0.3\n  set Target [m] = 0, 0, 0\nend\n";
}

class Resume : public Program {
 protected:
  static int status_of(const pid_t id) {
    int status = 0;
    waitpid(id, &status, 0);
    return status;
  }

  /// Waits until a run into "out" that draws has drawn its first picture.
  void wait_for_first_frame() const {
    while (!std::filesystem::exists(folder / "out/frames/000000.png"))
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }

  /// Starts it, sends it the signal after so many milliseconds, and says how it ended.
  int disturbed(const Words& arguments, const int signal, const int milliseconds) const {
    const pid_t id = start(arguments);
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    ::kill(id, signal);
    return status_of(id);
  }
  /// The same after the first picture.
  int disturbed(const Words& arguments, const int signal) const {
    const pid_t id = start(arguments);
    wait_for_first_frame();
    ::kill(id, signal);
    return status_of(id);
  }

  void expect_same_runs(const std::string& one, const std::string& other) const {
    const output::Reader a(folder / one / "run.h5"), b(folder / other / "run.h5");
    EXPECT_EQ(b.outcome(), output::Outcome::completed);
    EXPECT_FALSE(b.failure());
    EXPECT_EQ(a.steps(), b.steps());
    for (const output::Observable& o : a.schema().observables)
      EXPECT_EQ(a.observable(o.name), b.observable(o.name)) << o.name;
    ASSERT_EQ(a.n_frames("cube"), b.n_frames("cube"));
    ASSERT_EQ(a.n_complexes("cube"), b.n_complexes("cube"));
    for (std::size_t i = 0; i < a.n_frames("cube"); ++i) {
      EXPECT_EQ(a.frame("cube", i).positions, b.frame("cube", i).positions) << i;
      EXPECT_EQ(a.frame("cube", i).velocities, b.frame("cube", i).velocities) << i;
      EXPECT_EQ(a.frame("cube", i).complex, b.frame("cube", i).complex) << i;
    }
    for (std::size_t i = 0; i < a.n_surfaces("cube"); ++i)
      EXPECT_EQ(a.surface("cube", i).triangles, b.surface("cube", i).triangles) << i;
    expect_same_files(one, other);
  }

  /// Images byte by byte; of the surface file the bytes of its series.
  void expect_same_files(const std::string& one, const std::string& other) const {
    for (const char* name : {"frames/000000.png", "frames/000010.png", "frames/000025.png", "frames/000030.png"})
      EXPECT_EQ(read_text(folder / one / name), read_text(folder / other / name)) << name;
    const auto a = output::h5::open_read_only(folder / one / "surface_cube.vtkhdf"),
               b = output::h5::open_read_only(folder / other / "surface_cube.vtkhdf");
    const auto compare = [&]<class T>(const std::string& name, const T) {
      const auto values = output::h5::read_vector<T>(a, "/VTKHDF/" + name);
      EXPECT_FALSE(values.empty()) << name;
      EXPECT_EQ(values, output::h5::read_vector<T>(b, "/VTKHDF/" + name)) << name;
    };
    for (const char* name : {"NumberOfPoints", "Polygons/NumberOfCells", "Polygons/Connectivity", "Polygons/Offsets",
                             "Steps/PartOffsets", "Steps/PointOffsets", "Steps/PointDataOffsets/rest_position",
                             "Steps/CellDataOffsets/label", "Steps/CellOffsets"})
      compare(name, std::int64_t{});
    for (const char* name : {"Points", "PointData/rest_position"})
      compare(name, float{});
    compare("CellData/label", std::uint16_t{});
    compare("Steps/Values", double{});
    EXPECT_FALSE(std::filesystem::exists(folder / other / "checkpoint.kerf"));
  }

  /// Runs the scene into "whole"; disturbs the same run into "out" so many times, and lets it end.
  void expect_resumable(const std::string& scene, const int signal, const int n_times, const unsigned seed) const {
    write("scene.prm", scene);
    const auto start = std::chrono::steady_clock::now();
    ASSERT_EQ(kerf({"run", "scene.prm", "--output", "whole"}).exit_code, 0) << read_text(folder / "stderr");
    const auto took = std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() - start);
    std::mt19937 random(seed);
    std::uniform_int_distribution<int> moment(20, std::max(40, static_cast<int>(took.count() * 3 / 4)));
    const Words resumed = {"run", "scene.prm", "--output", "out", "--resume"};
    int n_ended = 0;
    for (int i = 0; i < n_times; ++i) {
      const int status = i == 0 ? disturbed(resumed, signal) : disturbed(resumed, signal, moment(random));
      n_ended += WIFSIGNALED(status) || WEXITSTATUS(status) == 128 + signal ? 1 : 0;
      const bool has_begun =
        std::filesystem::exists(folder / "out/run.h5") && std::filesystem::file_size(folder / "out/run.h5") > 0;
      if (has_begun) { // then it can be read, at any moment
        EXPECT_NO_THROW(output::Reader(folder / "out/run.h5").outcome());
      }
    }
    EXPECT_GT(n_ended, 0);
    const Result last = kerf(resumed);
    ASSERT_EQ(last.exit_code, 0) << last.err;
    expect_same_runs("whole", "out");
  }
};

TEST_F(Resume, GivesTheBitsOfAnUndisturbedRun) {
  unsigned seed = 1;
  for (const std::string backend : {"fem", "pba", "lattice", "mass-spring"}) {
    SCOPED_TRACE(backend);
    expect_resumable(busy_scene(backend), SIGKILL, 4, seed++);
    for (const char* name : {"whole", "out"})
      std::filesystem::remove_all(folder / name);
  }
}

/// Integrators that remember: the step before, an acceleration, a length of substeps, the longest step checked.
TEST_F(Resume, KeepsWhatIntegratorsRemember) {
  unsigned seed = 11;
  for (const std::string more : {"BDF2", "generalised alpha", "Newmark", "implicit Euler", "velocity Verlet"}) {
    SCOPED_TRACE(more);
    std::string scene = replaced(busy_scene("fem"), "set Backend = fem", "set Integrator = " + more);
    const auto blade = scene.find("subsection Blade"); // without it, to steps of second order
    scene.erase(blade, scene.find("subsection Observables") - blade);
    scene = replaced(replaced(scene, "tool forces, ", ""), "cut edges, waiting cuts, work of the cut, ", "");
    if (more == "velocity Verlet") // a step that its stiffness bears
      scene = replaced(replaced(scene, "Time step [s] = 0.01", "Time step [s] = 0.0005"), "End time [s] = 0.3",
                       "End time [s] = 0.015");
    else if (more == "BDF2" || more == "implicit Euler")
      scene = replaced(scene, "  subsection Material",
                       "  subsection Adaptive step\n    set Error tolerance [m/s] = 0.1\n  end\n  subsection Material");
    expect_resumable(scene, SIGKILL, 2, seed++);
    for (const char* name : {"whole", "out"})
      std::filesystem::remove_all(folder / name);
  }
}

/// Killed while a checkpoint is half written, before it is on the disk, before it takes its name, and just after: the
/// one before serves, or the new one.
TEST_F(Resume, AKillInTheMiddleOfACheckpointLeavesTheOneBefore) {
  write("scene.prm", busy_scene("fem"));
  ASSERT_EQ(kerf({"run", "scene.prm", "--output", "whole"}).exit_code, 0) << read_text(folder / "stderr");
  const Words words = {"run", "scene.prm", "--output", "out", "--resume"};
  for (const std::string moment : {"write 1", "write 3", "fsync 3", "rename 3", "renamed 3"}) {
    SCOPED_TRACE(moment);
    const Result killed =
      kerf(words, "export KERF_KILL='" + moment +
                    "' ASAN_OPTIONS=verify_asan_link_order=0 LD_PRELOAD='" KERF_KILLED_AT_CHECKPOINT "'");
    EXPECT_EQ(killed.signal, SIGKILL) << killed.err;
    const auto checkpoint = folder / "out/checkpoint.kerf";
    EXPECT_EQ(std::filesystem::exists(checkpoint.string() + ".new"), moment != "renamed 3");
    EXPECT_EQ(std::filesystem::exists(checkpoint), moment != "write 1");
    if (moment != "write 1") {
      EXPECT_EQ(output::read_checkpoint(checkpoint)->step, moment == "renamed 3" ? 12 : 8);
    }
    const Result last = kerf(words);
    ASSERT_EQ(last.exit_code, 0) << last.err;
    expect_same_runs("whole", "out");
    EXPECT_FALSE(std::filesystem::exists(checkpoint.string() + ".new"));
    std::filesystem::remove_all(folder / "out");
  }
}

TEST_F(Resume, SignalsEndAStepCleanly) {
  write("scene.prm", busy_scene("fem"));
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    std::filesystem::remove_all(folder / "out");
    const int status = disturbed({"run", "scene.prm", "--output", "out", "--set", "Time/End time [s]=30"}, signal);
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 128 + signal);
    const std::string said = read_text(folder / "stderr");
    EXPECT_TRUE(said.starts_with("kerf: interrupted by SIG")) << said;
    EXPECT_NE(said.find("--resume goes on from there"), std::string::npos) << said;
    const output::Reader reader(folder / "out/run.h5");
    EXPECT_EQ(reader.outcome(), output::Outcome::interrupted);
    ASSERT_TRUE(reader.failure());
    EXPECT_EQ(reader.failure()->step, reader.steps().back());
    EXPECT_TRUE(std::filesystem::exists(folder / "out/checkpoint.kerf"));
  }
}

TEST_F(Resume, ASignalWhileComposingEndsWithAMessage) {
  write("scene.prm", busy_scene("fem"));
  const pid_t id = start({"run", "scene.prm", "--output", "out"});
  const auto heeds = [&] { // the mask of caught signals has SIGTERM
    const std::string status = read_text("/proc/" + std::to_string(id) + "/status");
    const auto at = status.find("SigCgt:");
    return at != std::string::npos && (std::stoull(status.substr(at + 7), nullptr, 16) >> (SIGTERM - 1) & 1) != 0;
  };
  while (!heeds())
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  ::kill(id, SIGTERM);
  const int status = status_of(id);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 128 + SIGTERM);
  EXPECT_NE(read_text(folder / "stderr").find("interrupted by SIGTERM while the scene was composed"), std::string::npos)
    << read_text(folder / "stderr");
  EXPECT_FALSE(std::filesystem::exists(folder / "out/run.h5"));
}

TEST_F(Resume, ASecondRunLeavesTheFirstWhole) {
  write("scene.prm", busy_scene("fem"));
  const Words words = {"run", "scene.prm", "--output", "out"};
  const pid_t first = start(words);
  wait_for_first_frame();
  ::kill(first, SIGSTOP); // it shall not come to its end before the others have tried
  const std::string second = "cd '" + (folder / "").string() + "' && '" + program_file() + "' run scene.prm --output out ";
  for (const std::string option : {"", "--force", "--resume"})
    EXPECT_EQ(WEXITSTATUS(std::system((second + option + " >second 2>&1").c_str())), 2);
  EXPECT_NE(read_text(folder / "second").find("is in use: process "), std::string::npos)
    << read_text(folder / "second");
  ::kill(first, SIGCONT);
  EXPECT_EQ(WEXITSTATUS(status_of(first)), 0);
  ASSERT_EQ(kerf({"run", "scene.prm", "--output", "whole"}).exit_code, 0);
  expect_same_runs("whole", "out");
  expect_error(kerf(words), 1, {"out", "holds the results of an earlier run", "--force", "--resume"});
  const Result again = kerf({"run", "scene.prm", "--output", "out", "--resume"});
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_NE(again.out.find("nothing is left to resume"), std::string::npos) << again.out;
  const Result other = kerf({"run", "scene.prm", "--output", "out", "--resume", "--set", "Time/End time [s]=0.2"});
  expect_error(other, 1, {"run.h5", "cannot be resumed", "another scene",
                          "'set End time [s] = 0.3' there, 'set End time [s] = 0.2"});
}

TEST_F(Resume, RefusesAnotherScene) {
  write("scene.prm", replaced(busy_scene("fem"), "End time [s] = 0.3", "End time [s] = 30"));
  disturbed({"run", "scene.prm", "--output", "out"}, SIGTERM);
  expect_error(kerf({"run", "scene.prm", "--output", "out", "--resume", "--set", "Time/End time [s]=1"}), 1,
               {"run.h5", "cannot be resumed", "another scene", "--force"});
  EXPECT_EQ(output::Reader(folder / "out/run.h5").outcome(), output::Outcome::interrupted);
  std::string bytes = read_text(folder / "out/checkpoint.kerf");
  ASSERT_GT(bytes.size(), 1000u);
  bytes[bytes.size() / 2] ^= 1;
  write("out/checkpoint.kerf", bytes);
  expect_error(kerf({"run", "scene.prm", "--output", "out", "--resume"}), 2,
               {"checkpoint.kerf", "is damaged", "--force"});
}

/// What is said of where it goes on; and what is refused or told where files are lost.
TEST_F(Resume, SaysFromWhereItGoesOn) {
  write("scene.prm", replaced(busy_scene("fem"), "Checkpoint every [1] = 4", "Checkpoint every [1] = 0"));
  const Words resumed = {"run", "scene.prm", "--output", "out", "--resume"};
  const auto say = [&](const std::string& text) {
    const Result result = kerf(resumed);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.out.find(text), std::string::npos) << text << " in " << result.out;
  };
  const auto has_steps = [&] {
    try {
      return output::Reader(folder / "out/run.h5").n_steps() > 0;
    } catch (const Error&) {
      return false; // killed before the first of them was in the file
    }
  };
  for (int i = 0; i < 50 && !has_steps(); ++i) {
    std::filesystem::remove_all(folder / "out");
    disturbed(resumed, SIGKILL); // before its first checkpoint
  }
  say("no checkpoint had been written: starts from step 0, and compares with the");
  std::filesystem::remove_all(folder / "out");
  disturbed(resumed, SIGTERM);
  const auto step = output::read_checkpoint(folder / "out/checkpoint.kerf")->step;
  EXPECT_EQ(output::Reader(folder / "out/run.h5").failure()->step, step);
  for (const std::string name : {"checkpoint.kerf", "surface_cube.vtkhdf"}) {
    std::filesystem::rename(folder / "out" / name, folder / "kept");
    expect_error(kerf(resumed), 2, {name, "is not there", "--force"});
    EXPECT_EQ(output::Reader(folder / "out/run.h5").outcome(), output::Outcome::interrupted);
    std::filesystem::rename(folder / "kept", folder / "out" / name);
  }
  std::filesystem::remove(folder / "out/frames/000000.png");
  const Result last = kerf(resumed);
  EXPECT_EQ(last.exit_code, 0) << last.err;
  for (const std::string& text : {"goes on from step " + std::to_string(step) + " of 30 (t = ",
                                  std::string("warning: 1 images up to there are lost")})
    EXPECT_NE(last.out.find(text), std::string::npos) << text << " in " << last.out;
  std::filesystem::remove_all(folder / "out");
  say("nothing is there to resume: starts from step 0");
}

/// Copies whose nodes no edges between them hold together: parts that lie on the same side of all cuts.
std::size_t n_joined_copies(const output::Complex& complex) {
  return static_cast<std::size_t>(std::ranges::count_if(complex.nodes, [](const unsigned nodes) {
    unsigned reached = nodes & ~(nodes - 1);
    for (int i = 0; i < 3; ++i) // no way in a cube is longer
      for (int axis = 0; axis < 3; ++axis)
        for (unsigned v = 0; v < 8; ++v)
          reached |= (reached >> v & 1) << (v ^ 1u << axis) & nodes;
    return reached != nodes;
  }));
}

/// Killed while a blade crosses an earlier cut, after parts have been joined again.
TEST_F(Resume, KeepsPartsThatWereJoinedAgain) {
  const std::string first = "subsection Cut surface first\n  set Shape = plane\n  set Point [m] = 0.012, 0, 0\n"
                            "  set Normal [1] = 0.93, 0.3, -0.2\nend\n";
  write("scene.prm", busy_scene("fem") + first);
  ASSERT_EQ(kerf({"run", "scene.prm", "--output", "whole"}).exit_code, 0) << read_text(folder / "stderr");
  const output::Reader whole(folder / "whole/run.h5");
  std::vector<std::size_t> n_joined;
  for (std::size_t i = 0; i < whole.n_frames("cube"); ++i)
    n_joined.push_back(n_joined_copies(whole.complex("cube", whole.frame("cube", i).complex)));
  const auto some = std::ranges::find_if(n_joined, [](const std::size_t n) { return n > 0; });
  ASSERT_NE(some, n_joined.end());
  const auto step =
    static_cast<std::int64_t>(whole.frame("cube", static_cast<std::size_t>(some - n_joined.begin())).step);
  const pid_t id = start({"run", "scene.prm", "--output", "out"});
  const auto checkpoint = folder / "out/checkpoint.kerf";
  while (!std::filesystem::exists(checkpoint) || output::read_checkpoint(checkpoint)->step < step)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  ::kill(id, SIGKILL);
  ASSERT_TRUE(WIFSIGNALED(status_of(id)));
  ASSERT_EQ(kerf({"run", "scene.prm", "--output", "out", "--resume"}).exit_code, 0) << read_text(folder / "stderr");
  expect_same_runs("whole", "out");
}

/// The processor time and memory of a row are those of all processes that it took.
TEST_F(Resume, ARowsCostIsThatOfAllItsProcesses) {
  const std::string scene = busy_scene("fem");
  write("scene.prm", scene.substr(0, scene.find("subsection Surface file")));
  write("study.prm", "subsection Study\n  set Title = t\n  set Scene = scene.prm\n  set Answer = elastic energy\n"
                     "  set Unit = J\n  set Reference = 1e-3\n  set Reference source = none\nend\n"
                     "subsection Variant one\nend\n");
  const Words words = {"study", "study.prm", "--threads", "1", "--output"};
  const auto into = [&](const std::string& place, const Words& more = {}) {
    Words all = words;
    all.push_back(place);
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  ASSERT_EQ(kerf(into("whole")).exit_code, 0) << read_text(folder / "stderr");
  const pid_t id = start(into("out"));
  const auto checkpoint = folder / "out/rows/one/checkpoint.kerf";
  while (!std::filesystem::exists(checkpoint) || output::read_checkpoint(checkpoint)->step < 24)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  ::kill(id, SIGKILL);
  status_of(id);
  ASSERT_EQ(kerf(into("out", {"--resume"})).exit_code, 0) << read_text(folder / "stderr");
  const auto whole = output::read_study_file(folder / "whole/study.h5").rows.at(0),
             row = output::read_study_file(folder / "out/study.h5").rows.at(0);
  EXPECT_GT(row.cpu_seconds, 0.45 * whole.cpu_seconds); // the last process ran a fifth of the steps
  EXPECT_GT(row.peak_memory, 0.7 * whole.peak_memory);
}

/// Ten moments; rows that were finished are not run again, the one under way goes on.
TEST_F(Resume, StudiesGoOnToo) {
  std::string scene = busy_scene("fem");
  for (const std::string kind : {"subsection Images", "subsection Surface file"})
    scene.erase(scene.find(kind), scene.find("end\n", scene.find(kind)) + 4 - scene.find(kind));
  write("scene.prm", scene);
  write("study.prm",
        "subsection Study\n  set Title = t\n  set Scene = scene.prm\n  set Answer = elastic energy\n"
        "  set Unit = J\n  set Reference = 1e-3\n  set Reference source = none\nend\n"
        "subsection Variant one\nend\n"
        "subsection Variant two\n  set Set = Body cube/Material/Poisson's ratio [1]=0.2\nend\n"
        "subsection Variant three\n  set Set = Body cube/Element=enhanced\nend\n");
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(kerf({"study", "study.prm", "--output", "whole"}).exit_code, 0) << read_text(folder / "stderr");
  const auto took = std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() - start);
  std::mt19937 random(5);
  const Words resumed = {"study", "study.prm", "--output", "out", "--resume"};
  const auto file = folder / "out/study.h5";
  int n_ended = 0;
  for (int i = 0; i < 10; ++i) {
    const int signal = i % 2 == 0 ? SIGKILL : SIGTERM;
    const int status = disturbed(resumed, signal, 50 + static_cast<int>(random() % (took.count() / 3 + 1)));
    EXPECT_TRUE(WIFSIGNALED(status) || WEXITSTATUS(status) == 128 + signal || WEXITSTATUS(status) == 0)
      << read_text(folder / "stderr");
    n_ended += WIFSIGNALED(status) || WEXITSTATUS(status) != 0 ? 1 : 0;
    if (std::filesystem::exists(file)) { // then it can be read, at any moment
      EXPECT_NO_THROW(output::read_study_file(file));
    }
  }
  EXPECT_GT(n_ended, 2);
  const Result last = kerf(resumed);
  ASSERT_EQ(last.exit_code, 0) << last.err;
  const auto a = output::read_study_file(folder / "whole/study.h5"),
             b = output::read_study_file(folder / "out/study.h5");
  EXPECT_EQ(b.outcome, output::Outcome::completed);
  ASSERT_EQ(a.rows.size(), b.rows.size());
  for (std::size_t i = 0; i < a.rows.size(); ++i) {
    EXPECT_EQ(a.rows[i].name, b.rows[i].name);
    EXPECT_EQ(a.rows[i].value, b.rows[i].value);
    EXPECT_EQ(a.rows[i].reference, b.rows[i].reference);
    EXPECT_EQ(a.rows[i].error, b.rows[i].error);
    EXPECT_EQ(a.rows[i].n_steps, b.rows[i].n_steps);
    EXPECT_EQ(a.rows[i].n_dof, b.rows[i].n_dof);
    EXPECT_EQ(a.rows[i].n_iterations, b.rows[i].n_iterations);
    EXPECT_EQ(b.rows[i].outcome, "completed");
  }
  Words other = resumed;
  other.insert(other.end(), {"--set", "Study/Take=maximum"});
  expect_error(kerf(other), 1, {"study.h5", "cannot be resumed", "--force"});
  write("scene.prm", scene + "# a comment more\n");
  expect_error(kerf(resumed), 1, {"study.h5", "cannot be resumed", "--force"});
}

/// The same of a study of stability: all of its rows but their times.
TEST_F(Resume, StudiesOfStabilityGoOnToo) {
  write("scene.prm", cube_scene());
  write("study.prm", "subsection Stability\n  set Scene = scene.prm\n  set Steps [1] = 30\nend\n"
                     "subsection Variant fem\nend\n"
                     "subsection Variant springs\n  set Set = Body cube/Backend=mass-spring\nend\n"
                     "subsection Change start\n  subsection Case pulled\n"
                     "    set Set = Body cube/Initial state/Displacement [m]=0.2*x; 0; 0\n  end\nend\n"
                     "subsection Change step\n  subsection Case short\n    set Set = Time/Time step [s]=0.001\n  end\n"
                     "  subsection Case long\n    set Set = Time/Time step [s]=0.1\n  end\nend\n"
                     "subsection Change soft\n  subsection Case no\n  end\n"
                     "  subsection Case yes\n    set Set = Body cube/Material/Young's modulus [Pa]=100\n  end\nend\n"
                     "subsection Sweep all\n  set Changes = step, soft\nend\n");
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(kerf({"study", "study.prm", "--output", "whole"}).exit_code, 0) << read_text(folder / "stderr");
  const auto took = std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() - start);
  const Words resumed = {"study", "study.prm", "--output", "out", "--resume"};
  std::mt19937 random(6);
  int n_ended = 0;
  for (int i = 0; i < 10; ++i) {
    const int signal = i % 2 == 0 ? SIGTERM : SIGKILL;
    const int status = disturbed(resumed, signal, 20 + static_cast<int>(random() % (took.count() / 3 + 1)));
    n_ended += WIFSIGNALED(status) || WEXITSTATUS(status) == 128 + signal ? 1 : 0;
    if (std::filesystem::exists(folder / "out/stability.h5")) {
      EXPECT_NO_THROW(output::read_stability_file(folder / "out/stability.h5"));
    }
  }
  EXPECT_GT(n_ended, 0);
  ASSERT_EQ(kerf(resumed).exit_code, 0) << read_text(folder / "stderr");
  const auto a = output::read_stability_file(folder / "whole/stability.h5"),
             b = output::read_stability_file(folder / "out/stability.h5");
  EXPECT_EQ(b.outcome, output::Outcome::completed);
  ASSERT_EQ(a.rows.size(), 8u);
  ASSERT_EQ(b.rows.size(), 8u);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(a.rows[i].changes, b.rows[i].changes);
    EXPECT_EQ(a.rows[i].outcome, b.rows[i].outcome);
    EXPECT_EQ(a.rows[i].last_energy, b.rows[i].last_energy);
    EXPECT_EQ(a.rows[i].momentum, b.rows[i].momentum);
    EXPECT_EQ(a.rows[i].n_iterations, b.rows[i].n_iterations);
  }
}

/// /scene is a scene by itself: from anywhere, with what --set has changed, the same bits.
TEST_F(Resume, TheStoredSceneReproducesTheRun) {
  std::filesystem::create_directories(folder / "scenes");
  std::filesystem::copy_file(mesh_path("cube.off"), folder / "scenes/cube.off");
  write("scenes/scene.prm", replaced(busy_scene("fem"), mesh_path("cube.off"), "cube.off"));
  const Result result = kerf({"run", "scenes/scene.prm", "--output", "whole", "--set", "Time/End time [s]=0.3", "--set",
                              "Body cube/Material/Poisson's ratio [1]=0.2", "--set",
                              "Body cube/Damping/Mass damping [1/s]=3", "--set", "Body cube/Element=enhanced"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  write("stored.prm", output::Reader(folder / "whole/run.h5").scene());
  ASSERT_EQ(kerf({"run", "stored.prm", "--output", "out"}).exit_code, 0) << read_text(folder / "stderr");
  expect_same_runs("whole", "out");
  EXPECT_EQ(output::Reader(folder / "out/run.h5").scene(), output::Reader(folder / "whole/run.h5").scene());
}

} // namespace
} // namespace kerf::apps::resume_test
