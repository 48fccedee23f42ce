// `kerf study --jobs N` and `--row K`: rows as processes of their own, beside each other or not, killed and resumed.

#include "output/study_file.h"
#include "tests/apps/program.h"

#include <chrono>
#include <cmath>
#include <csignal>
#include <iterator>
#include <thread>

namespace kerf::apps::study_jobs_test {
namespace {

using namespace std::chrono_literals;

/// Four variants in some cases, of a cube that sags on its foot.
std::string four_rows_a_case(const std::string& times, const int n_cases) {
  std::string text =
    "subsection Study\n  set Scene = scene.prm\n  set Answer = elastic energy\n  set Unit = J\n"
    "  set Reference = 1e-3\n  set Reference source = a guess\n  set Times = " +
    times +
    "\n  set Reference row = fem, 1\nend\n"
    "subsection Points\n  set Points [m] = 0, 0, 0; 0.03, 0, 0.04\nend\n"
    "subsection Variant fem\nend\n"
    "subsection Variant enhanced\n  set Set = Body cube/Element=enhanced\nend\n"
    "subsection Variant springs\n  set Set = Body cube/Backend=mass-spring\nend\n"
    "subsection Variant points\n  set Set = Body cube/Backend=pba\nend\n"
    "subsection Change stiffness\n";
  for (int i = 1; i <= n_cases; ++i)
    text += "  subsection Case " + std::to_string(i) +
            "\n    set Set = Body cube/Material/Young's modulus [Pa]=" + std::to_string(i) + "e4\n  end\n";
  return text + "end\n";
}

class StudyJobs : public Program {
 protected:
  StudyJobs() {
    write("scene.prm", replaced(cube_scene(), "  subsection Material",
                                "  subsection Support foot\n    set Lower [m] = -1, -1, -1\n"
                                "    set Upper [m] = 1, 1, -0.05\n  end\n  subsection Material") +
                         "subsection Gravity\nend\nsubsection Observables\n  set Names = elastic energy\nend\n");
  }

  /// How many processes it has had at a time, at most; it comes to its end.
  static std::size_t most_at_a_time(const pid_t id) {
    const std::string file = "/proc/" + std::to_string(id) + "/task/" + std::to_string(id) + "/children";
    std::size_t most = 0;
    for (int status = 0; waitpid(id, &status, WNOHANG) == 0; std::this_thread::sleep_for(2ms)) {
      std::istringstream children(read_text(file));
      most = std::max<std::size_t>(most, std::distance(std::istream_iterator<int>(children), {}));
    }
    return most;
  }

  output::StudyTable table(const std::string& name) const {
    return output::read_study_file(folder / name / "study.h5");
  }

  static void expect_same(const std::vector<output::StudyRow>& a, const std::vector<output::StudyRow>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_EQ(a[i].name, b[i].name);
      EXPECT_EQ(a[i].value, b[i].value) << a[i].name;
      EXPECT_EQ(a[i].error, b[i].error) << a[i].name;
      EXPECT_EQ(a[i].displacements, b[i].displacements) << a[i].name;
      EXPECT_EQ(a[i].n_steps, b[i].n_steps) << a[i].name;
      EXPECT_EQ(a[i].n_dof, b[i].n_dof) << a[i].name;
      EXPECT_EQ(a[i].n_iterations, b[i].n_iterations) << a[i].name;
      EXPECT_EQ(b[i].outcome, "completed") << b[i].name;
    }
  }
};

/// Killed with the rows that were under way, five times, while rows still came in.
TEST_F(StudyJobs, FortyRowsKilledFiveTimesAreThoseOfAnUndisturbedStudy) {
  write("study.prm", four_rows_a_case("do not count", 10));
  ASSERT_EQ(kerf({"study", "study.prm", "--output", "whole"}).exit_code, 0) << read_text(folder / "stderr");
  const Words resumed = {"study", "study.prm", "--output", "out", "--jobs", "2", "--threads", "1", "--resume"};
  const auto n_rows = [&] { return std::filesystem::exists(folder / "out/study.h5") ? table("out").rows.size() : 0; };
  for (int kill = 1; kill <= 5; ++kill) {
    const pid_t id = start(resumed);
    int status = 0;
    while (n_rows() < static_cast<std::size_t>(6 * kill) && waitpid(id, &status, WNOHANG) == 0)
      std::this_thread::sleep_for(5ms);
    ::kill(id, SIGKILL);
    waitpid(id, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status)) << "it had ended: " << read_text(folder / "stderr");
    EXPECT_LT(n_rows(), 40u);
  }
  const Result last = kerf(resumed);
  ASSERT_EQ(last.exit_code, 0) << last.err;
  EXPECT_EQ(table("out").outcome, output::Outcome::completed);
  ASSERT_EQ(table("out").rows.size(), 40u);
  expect_same(table("whole").rows, table("out").rows);
}

TEST_F(StudyJobs, RowsThatTimeAreNeverBesideOthers) {
  write("study.prm", four_rows_a_case("count", 2));
  EXPECT_EQ(most_at_a_time(start({"study", "study.prm", "--output", "out", "--jobs", "3", "--threads", "1"})), 1u);
  for (const output::StudyRow& row : table("out").rows)
    EXPECT_GT(row.stepping_seconds, 0) << row.name;
  write("study.prm", four_rows_a_case("do not count", 2));
  EXPECT_EQ(most_at_a_time(start({"study", "study.prm", "--output", "beside", "--jobs", "3", "--threads", "1"})), 3u);
  for (const output::StudyRow& row : table("beside").rows)
    EXPECT_TRUE(std::isnan(row.stepping_seconds)) << row.name;
  expect_same(table("out").rows, table("beside").rows);
}

/// As an array of jobs of a cluster makes them: each row alone, in any order; then the study gathers them.
TEST_F(StudyJobs, RowsThatRanAloneAreGathered) {
  write("study.prm", four_rows_a_case("count", 2));
  EXPECT_EQ(kerf({"study", "study.prm", "--output", "out", "--row", "3"}).exit_code, 0) << read_text(folder / "stderr");
  EXPECT_EQ(kerf({"study", "study.prm", "--output", "out", "--row", "2"}).exit_code, 0) << read_text(folder / "stderr");
  EXPECT_FALSE(std::filesystem::exists(folder / "out/study.h5"));
  expect_error(kerf({"study", "study.prm", "--output", "out", "--row", "2"}), 1, {"earlier run", "--resume"});
  const double seconds = output::read_study_file(folder / "out/rows/enhanced+1/row.h5").rows[0].stepping_seconds;
  EXPECT_EQ(kerf({"study", "study.prm", "--output", "out", "--resume"}).exit_code, 0) << read_text(folder / "stderr");
  EXPECT_EQ(table("out").rows[2].stepping_seconds, seconds) << "taken as it was";
  EXPECT_EQ(table("out").rows.size(), 8u);
  write("study.prm", four_rows_a_case("do not count", 2));
  expect_error(kerf({"study", "study.prm", "--output", "out", "--row", "3", "--resume"}), 1, {"cannot be resumed"});
}

TEST_F(StudyJobs, WhatCannotBeIsRefused) {
  write("study.prm", four_rows_a_case("count", 2));
  expect_error(kerf({"study", "study.prm", "--row", "9"}), 1, {"--row", "8 rows"});
  expect_error(kerf({"study", "study.prm", "--row", "0"}), 1, {"--row", "1 to 1024"});
  expect_error(kerf({"study", "study.prm", "--row", "1", "--jobs", "2"}), 1, {"--row", "--jobs"});
  write("study.prm", replaced(four_rows_a_case("count", 2), "Unit = J", "Unit = kJ"));
  expect_error(kerf({"study", "study.prm", "--jobs", "2"}), 1, {"study.prm:", "Unit", "unit J"});
}

/// A process that the system ends, as one that takes too much memory, is a row with its reason; the others go on.
TEST_F(StudyJobs, ARowWhoseProcessIsKilledHasFailed) {
  write("study.prm", four_rows_a_case("count", 2));
  const pid_t id = start({"study", "study.prm", "--output", "out", "--jobs", "1", "--threads", "1"});
  const std::string file = "/proc/" + std::to_string(id) + "/task/" + std::to_string(id) + "/children";
  pid_t child = 0;
  while (child == 0)
    std::istringstream(read_text(file)) >> child;
  ::kill(child, SIGKILL);
  int status = 0;
  waitpid(id, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 3) << read_text(folder / "stderr");
  EXPECT_NE(table("out").rows[0].outcome.find("failed: its process ended with exit code 137"), std::string::npos);
  EXPECT_EQ(table("out").rows[1].outcome, "completed");
}

} // namespace
} // namespace kerf::apps::study_jobs_test
