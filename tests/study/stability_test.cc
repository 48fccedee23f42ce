// Studies of stability: what they combine, what they call what they see, and the largest step against its closed form.

#include "study/stability.h"

#include "scene/grammar.h"
#include "tests/study/study_text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

namespace kerf::study::stability_test {
namespace {

class BlockStudy {
 public:
  BlockStudy() { std::ofstream(folder_ / "scene.prm") << scene::cube_scene(); }

  static std::string head(const int n_steps) {
    return "subsection Stability\n  set Scene = scene.prm\n  set Steps [1] = " + std::to_string(n_steps) + "\nend\n";
  }
  static std::string change(const std::string& name, const std::vector<std::pair<std::string, std::string>>& cases) {
    std::string text = "subsection Change " + name + "\n";
    for (const auto& [one, set] : cases)
      text += "  subsection Case " + one + "\n" + (set.empty() ? "" : "    set Set = " + set + "\n") + "  end\n";
    return text + "end\n";
  }
  static std::string sweep(const std::string& name, const std::string& changes, const std::string& more = "") {
    return "subsection Sweep " + name + "\n  set Changes = " + changes + "\n" + more + "end\n";
  }

  StabilityPlan plan(const std::string& text) const {
    return make_stability_plan(scene::scan_scene_text(text, (folder_ / "study.prm").string()));
  }
  /// The row of a study with one.
  output::StabilityRow watch_one(const std::string& sets, const int n_steps, const std::string& more = "") const {
    const StabilityPlan one = plan(head(n_steps) + CubeStudy::variant("it", sets) + change("nothing", {{"none", ""}}) +
                                   sweep("one", "nothing", more));
    EXPECT_EQ(one.cases.size(), 1u);
    return watch(one.cases[0], n_steps);
  }
  std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }

 private:
  output::TemporaryFolder folder_;
};

const std::string variants =
  CubeStudy::variant("fem", "Body cube/Backend=fem") + CubeStudy::variant("springs", "Body cube/Backend=mass-spring");
const std::string changes =
  BlockStudy::change("step", {{"short", "Time/Time step [s]=0.001"}, {"long", "Time/Time step [s]=0.1"}}) +
  BlockStudy::change("soft", {{"no", ""}, {"yes", "Body cube/Material/Young's modulus [Pa]=10"}});
const std::string twofold = "Body cube/Initial state/Displacement [m]=0.2*x; 0.2*y; 0.2*z";

TEST(StabilityPlan, ASweepCombinesWhatItNamesAndTakesTheFirstOfTheRest) {
  const BlockStudy study;
  const StabilityPlan plan = study.plan(BlockStudy::head(7) + variants + changes + BlockStudy::sweep("a", "soft") +
                                        BlockStudy::sweep("b", "step, soft", "  set Variants = springs\n"));
  std::vector<std::string> names;
  for (const StabilityCase& one : plan.cases)
    names.push_back(one.sweep + " " + one.variant + " " + one.cases);
  EXPECT_EQ(names,
            (std::vector<std::string>{"a fem no", "a fem yes", "a springs no", "a springs yes", "b springs short, no",
                                      "b springs short, yes", "b springs long, no", "b springs long, yes"}));
  const auto time =
    scene::parse_scene(plan.cases[6].scene, scene::grammar()).require("Time").read<scene::TimeParameters>();
  EXPECT_EQ(time.time_step, 0.1);
  EXPECT_NEAR(time.end_time, 0.7, 1e-12);
}

TEST(StabilityPlan, WhatIsNotThereIsRefusedAtItsLine) {
  const BlockStudy study;
  const auto expect_refused = [&](const std::string& text, const std::string& line) {
    try {
      study.plan(text);
      ADD_FAILURE() << "was accepted: " << line;
    } catch (const ParameterError& error) {
      EXPECT_EQ(error.complaint().line, scene::line_of(text, line)) << error.what();
    }
  };
  const std::string all = BlockStudy::head(7) + variants + changes;
  expect_refused(all + BlockStudy::sweep("a", "colour"), "set Changes");
  expect_refused(all + BlockStudy::sweep("a", "soft", "  set Variants = rubber\n"), "set Variants");
  expect_refused(all + BlockStudy::sweep("a", "soft", "  set Ask = why\n"), "set Ask");
}

TEST(Stability, OutcomesAreWhatTheirWordsSay) {
  const BlockStudy study;
  const auto outcome = [&](const std::string& sets, const int n_steps = 40) {
    return study.watch_one(sets, n_steps).outcome;
  };
  const std::string symplectic = "Body cube/Integrator=symplectic Euler";
  EXPECT_EQ(outcome(twofold), "damped out");
  EXPECT_EQ(outcome(twofold + " | Time/Time step [s]=1e-4"), "stable");
  EXPECT_EQ(outcome("Body cube/Backend=fem"), "stable") << "at rest";
  EXPECT_EQ(outcome(symplectic + " | Time/Time step [s]=1"), "refused");
  const auto beyond = study.watch_one(
    symplectic + " | Body cube/Symplectic Euler/Beyond the stable step=go on | Time/Time step [s]=0.1 | " + twofold,
    40);
  EXPECT_EQ(beyond.outcome, "stopped");
  EXPECT_FALSE(beyond.reason.empty());
  EXPECT_LT(beyond.n_steps, 40);
  EXPECT_EQ(outcome("Body cube/Backend=mass-spring | Body cube/Initial state/Displacement [m]=-2*x; 0; 0"), "not back")
    << "springs know no inside";
}

/// The integrator predicts the step at which the highest frequency is lost; the body is lost there.
TEST(Stability, TheLargestStepIsTheOnePredicted) {
  const BlockStudy study;
  const auto row = study.watch_one(
    "Body cube/Integrator=velocity Verlet | Time/Time step [s]=1e-5 | "
    "Body cube/Velocity Verlet/Beyond the stable step=go on | "
    "Body cube/Initial state/Displacement [m]=1e-4*x; 0; 1e-4*sin(99*x)*y",
    400, "  set Ask = largest step\n");
  EXPECT_NEAR(row.largest_step / row.predicted_step, 1, 0.03);
}

TEST(Stability, TheTableIsReadBackAsItWasWritten) {
  const BlockStudy study;
  const StabilityPlan plan = study.plan(BlockStudy::head(3) + variants + changes + BlockStudy::sweep("a", "soft"));
  const auto written =
    run_stability_study(plan, study / "out", output::sample_info(), output::Earlier::replace, [](const auto&) {});
  const auto read = output::read_stability_file(study / "out/stability.h5");
  ASSERT_EQ(read.rows.size(), 4u);
  EXPECT_EQ(read.outcome, output::Outcome::completed);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(read.rows[i].outcome, written.rows[i].outcome);
    EXPECT_EQ(read.rows[i].cases, written.rows[i].cases);
    EXPECT_EQ(read.rows[i].last_energy, written.rows[i].last_energy);
    EXPECT_TRUE(std::isnan(read.rows[i].largest_step));
  }
  EXPECT_NE(aligned(read).find("springs"), std::string::npos);
}

} // namespace
} // namespace kerf::study::stability_test
