// Damaged files: whatever stands in a scene, a study, a mesh or a file of results, the program says what is wrong in a
// line and ends with exit code 1, 2 or 3, or it works. Never by a signal, an exception that nobody knows, or with no
// end of memory. `./kerf test -L long -R Mutations` tries 300; every test run some.

#include "tests/apps/program.h"
#include "tests/support/vandal.h"

#include <csignal>

namespace kerf::apps::mutations_test {
namespace {

using support::Vandal;

class Mutations : public Program, public testing::WithParamInterface<int> {
 protected:
  /// Ends in a known way within some seconds, or ends when it is told to: a number that makes a scene large is no
  /// mistake.
  void expect_known_end(const Words& arguments, const std::string& what) const {
    const Result result = kerf(arguments, "set -- timeout -k 10 20 \"$0\" \"$@\" && exec \"$@\"");
    EXPECT_EQ(result.signal, 0) << what;
    if (result.exit_code == 0 || result.exit_code == 124 || result.exit_code == 137)
      return;
    EXPECT_GE(result.exit_code, 1) << what;
    EXPECT_LE(result.exit_code, 3) << what << ": " << result.err;
    EXPECT_TRUE(result.err.starts_with("kerf: ")) << what << ": " << result.err;
    EXPECT_LT(result.err.size(), 6000u) << what << ": " << result.err.substr(0, 2000);
    EXPECT_EQ(result.err.find("internal error"), std::string::npos) << what << ": " << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << what << ": " << result.err;
  }

  /// A run that SIGTERM has ended between two steps, as soon as it had written a checkpoint.
  void leave_unfinished(const std::string& scene, const std::string& output) const {
    kerf({"run", scene, "--output", output, "--set", "Output/Checkpoint every [1]=1"},
         "{ \"$0\" \"$@\" & p=$!; while kill -0 $p 2>/dev/null && [ ! -e '" + output +
           "/checkpoint.kerf' ]; do sleep 0.002; done; kill -TERM $p; wait $p; exit; }");
    ASSERT_TRUE(std::filesystem::exists(folder / output / "checkpoint.kerf"));
  }

  std::string small_scene() const { return cube_scene() + falling_blade() + "subsection Gravity\nend\n"; }
};

TEST_P(Mutations, EndInAKnownWay) {
  const std::string study =
    "subsection Study\n  set Title = a title\n  set Scene = scene.prm\n"
    "  set Answer = kinetic energy\n  set Unit = J\nend\n"
    "subsection Variant one\n  set Set = Time/End time [s]=0.02\nend\n";
  write("whole.prm", replaced(small_scene(), "= 0.05\nend", "= 6\nend") +
                       "subsection Observables\n  set Names = kinetic energy\nend\n");
  leave_unfinished("whole.prm", "whole");
  const std::string mesh = read_text(mesh_path("cube.off"));
  const int n = GetParam();
  for (int i = 0; i < n; ++i) {
    Vandal vandal(static_cast<unsigned>(i));
    const std::string what = "mutation " + std::to_string(i);
    std::filesystem::remove_all(folder / "out");
    if (i % 4 == 0) {
      write("scene.prm", vandal.damaged(read_text(folder / "whole.prm")));
      expect_known_end({"check", "scene.prm"}, what);
    } else if (i % 4 == 1) {
      write("cube.off", vandal.damaged(mesh));
      write("scene.prm", replaced(small_scene(), mesh_path("cube.off"), "cube.off"));
      expect_known_end({"run", "scene.prm", "--output", "out"}, what);
    } else if (i % 4 == 2) {
      write("scene.prm", read_text(folder / "whole.prm"));
      write("study.prm", vandal.damaged(study));
      expect_known_end({"study", "study.prm", "--output", "out"}, what);
    } else { // results of a run that was cut short
      std::filesystem::copy(folder / "whole", folder / "out", std::filesystem::copy_options::recursive);
      const bool of_checkpoint = i % 8 == 3;
      const std::string name = of_checkpoint ? "out/checkpoint.kerf" : "out/run.h5";
      write(name, vandal.damaged(read_text(folder / (of_checkpoint ? "whole/checkpoint.kerf" : "whole/run.h5"))));
      expect_known_end({"run", "whole.prm", "--output", "out", "--resume"}, what);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Short, Mutations, testing::Values(24));
INSTANTIATE_TEST_SUITE_P(Long, Mutations, testing::Values(300));

} // namespace
} // namespace kerf::apps::mutations_test
