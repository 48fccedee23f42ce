// What a study may say, and what it is told when it says something else.

#include "study/measure.h"
#include "study/stability_plan.h"
#include "tests/study/study_text.h"
#include "tests/support/checkout.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace kerf::study::plan_test {
namespace {

const std::string fem = CubeStudy::variant("fem", "");

/// The study is refused at the first line that holds `line`, and the message holds all the words.
void expect_refused(const std::string& text, const std::string& line, const std::vector<std::string>& words) {
  SCOPED_TRACE(text);
  const CubeStudy study;
  try {
    study.plan(text);
    ADD_FAILURE() << "was accepted";
  } catch (const ParameterError& error) {
    const std::string message = error.what();
    EXPECT_EQ(error.complaint().line, scene::line_of(text, line)) << message;
    EXPECT_TRUE(error.complaint().file.ends_with("study.prm")) << message;
    EXPECT_FALSE(error.complaint().remedy.empty()) << message;
    for (const std::string& word : words)
      EXPECT_NE(message.find(word), std::string::npos) << "no '" << word << "' in: " << message;
  }
}

std::vector<std::string> names(const Plan& plan) {
  std::vector<std::string> all;
  for (const PlannedRow& row : plan.rows)
    all.push_back(row.name);
  return all;
}

TEST(Plan, EveryVariantInEveryCaseOfEveryChange) {
  const CubeStudy study;
  const Plan plan = study.plan(CubeStudy::head("  set Order over = grid\n") + fem +
                               CubeStudy::variant("springs", "Body cube/Backend=mass-spring") +
                               "subsection Change grid\n"
                               "  subsection Case coarse\n  end\n"
                               "  subsection Case fine\n    set Set = Body cube/Cube edge [m]=0.025\n  end\nend\n"
                               "subsection Change step\n"
                               "  subsection Case long\n  end\n"
                               "  subsection Case short\n"
                               "    set Set = Time/Time step [s]=0.005 | Time/End time [s]=0.1\n"
                               "    set Reference = -7.848\n    set Reference source = twice as long\n  end\nend\n");
  EXPECT_EQ(names(plan),
            (std::vector<std::string>{"fem, coarse, long", "fem, coarse, short", "fem, fine, long", "fem, fine, short",
                                      "springs, coarse, long", "springs, coarse, short", "springs, fine, long",
                                      "springs, fine, short"}));
  const PlannedRow& last = plan.rows.back();
  EXPECT_EQ(last.family, "springs, short");
  EXPECT_EQ(last.overrides, (std::vector<std::string>{"Body cube/Backend=mass-spring", "Body cube/Cube edge [m]=0.025",
                                                      "Time/Time step [s]=0.005", "Time/End time [s]=0.1"}));
  EXPECT_EQ(last.reference.value, -7.848);
  EXPECT_EQ(last.reference.source, "twice as long");
  EXPECT_EQ(plan.rows[0].reference.value, -3.924);
  scene::SceneText text = last.scene;
  EXPECT_EQ(text.root.find_section("Time")->find_key("Time step [s]")->value, "0.005");
}

TEST(Plan, LeavesImagesAndSurfaceFilesOut) {
  const CubeStudy study;
  std::ofstream(study / "scene.prm", std::ios::app) << "subsection Surface file\nend\n"
                                                       "subsection Images\n  set Eye [m] = 1, 1, 1\n"
                                                       "  set Target [m] = 0, 0, 0\nend\n";
  Plan plan = study.plan(CubeStudy::head() + fem);
  EXPECT_EQ(plan.rows[0].scene.root.find_section("Images"), nullptr);
  EXPECT_EQ(plan.rows[0].scene.root.find_section("Surface file"), nullptr);
  EXPECT_NE(plan.rows[0].scene.root.find_section("Observables"), nullptr);
}

TEST(Plan, RefusesAMisspeltStudy) {
  expect_refused("subsection Studdy\nend\n", "Studdy", {"Did you mean 'Study'"});
  expect_refused(CubeStudy::head("  set Tak = end\n") + fem, "Tak", {"Study/Tak", "Did you mean 'Take'"});
  expect_refused(CubeStudy::head("  set Take = median\n") + fem, "median", {"'median'"});
  expect_refused(CubeStudy::head("  set Last part [1] = 0\n") + fem, "Last part", {"must be > 0"});
  expect_refused("subsection Study\n  set Scene = scene.prm\nend\n" + fem, "Study", {"Study/Answer"});
}

TEST(Plan, RefusesAStudyOfNothing) {
  const CubeStudy study;
  EXPECT_THROW(study.plan(CubeStudy::head()), ParameterError);
  EXPECT_THROW(study.plan(fem), ParameterError);
  expect_refused(CubeStudy::head() + fem + "subsection Change grid\nend\n", "Change", {"Change grid/Case"});
  std::filesystem::remove(study / "scene.prm");
  EXPECT_THROW(study.plan(CubeStudy::head() + fem), DataError);
}

TEST(Plan, RefusesReferencesWithoutSourceAndTheOtherWayRound) {
  const std::string variant = "subsection Variant one\n";
  expect_refused(CubeStudy::head() + variant + "  set Reference = 4\nend\n", "Reference = 4", {"source"});
  expect_refused(CubeStudy::head() + variant + "  set Reference source = a book\nend\n", "a book", {"no reference"});
}

TEST(Plan, RefusesAnOrderOverNoChange) {
  expect_refused(CubeStudy::head("  set Order over = grid\n") + fem, "Order over", {"Change grid"});
}

TEST(Plan, TellsAWrongChangeOfTheSceneAtItsLine) {
  const auto refuse = [](const std::string& set, const std::vector<std::string>& words) {
    expect_refused(CubeStudy::head() + fem + CubeStudy::variant("bad", set), "Set = " + set, words);
  };
  refuse("Body cube/Backand=pba", {"Variant bad/Set", "Body cube/Backand", "Did you mean 'Backend'"});
  refuse("Body cube/Backend=pbx", {"Body cube/Backend=pbx", "must be one of fem"});
  refuse("Body cube/Backend", {"Section/Key=value"});
  refuse("Time/End time [s]=1 | Boddy cube/Backend=pba", {"in 'Boddy cube/Backend=pba'", "there is no such section"});
  refuse("Time/End time [s]=1 | | Body cube/Backend=pba", {"between two '|'"});
  refuse("Time/End time [s]=1 |", {"before or after"});
  expect_refused(
    CubeStudy::head() + fem + "subsection Change grid\n  subsection Case a\n    set Set = A/B=1\n  end\nend\n", "A/B=1",
    {"Change grid/Case a/Set", "in 'A/B=1'"});
}

std::string change(const std::string& keys) { return "subsection Change grid\n" + keys + "end\n"; }

TEST(Plan, ValuesAndRangesAreCases) {
  const CubeStudy study;
  const auto planned = [&](const std::string& keys) {
    return names(study.plan(CubeStudy::head() + fem + change(keys)));
  };
  EXPECT_EQ(planned("  set Key = Body cube/Integrator\n  set Values = implicit Euler | generalised alpha\n"),
            (std::vector<std::string>{"fem, implicit Euler", "fem, generalised alpha"}));
  const std::string edge = "  set Key = Body cube/Cube edge [m]\n";
  EXPECT_EQ(planned(edge + "  set Range = 0.05, 0.02\n  set Number [1] = 4\n"),
            (std::vector<std::string>{"fem, 0.05", "fem, 0.04", "fem, 0.03", "fem, 0.02"}));
  EXPECT_EQ(planned(edge + "  set Range = 0.08, 0.02\n  set Number [1] = 3\n  set Spacing = equal ratios\n"),
            (std::vector<std::string>{"fem, 0.08", "fem, 0.04", "fem, 0.02"}));
  EXPECT_EQ(
    planned(edge +
            "  set Values = 0.05\n  subsection Case fine one\n    set Set = Body cube/Cube edge [m]=0.01\n  end\n"),
    (std::vector<std::string>{"fem, fine one", "fem, 0.05"}));
  const Plan both = study.plan(CubeStudy::head() + fem +
                               change("  set Key = Time/Time step [s] | Time/End time [s]\n  set Values = 0.01\n"));
  EXPECT_EQ(both.rows[0].overrides, (std::vector<std::string>{"Time/Time step [s]=0.01", "Time/End time [s]=0.01"}));
}

TEST(Plan, RefusesRangesWithoutSense) {
  const auto refuse = [](const std::string& keys, const std::string& line, const std::string& words) {
    expect_refused(CubeStudy::head() + fem + change(keys), line, {words});
  };
  const std::string edge = "  set Key = Body cube/Cube edge [m]\n";
  refuse(edge, "Key = Body", "the range is empty");
  refuse(edge + "  set Range = 0.05, 0.02\n", "Change grid", "the range is empty");
  refuse(edge + "  set Range = 0.05, 0.02\n  set Number [1] = 1\n", "Number", "the range is empty");
  refuse(edge + "  set Range = 0.05, 0.05\n  set Number [1] = 3\n", "Number", "one number several times");
  refuse(edge + "  set Range = 0.05\n  set Number [1] = 3\n", "Range", "two numbers");
  refuse(edge + "  set Range = 0, 1\n  set Number [1] = 3\n  set Spacing = equal ratios\n", "Range", "one sign");
  refuse(edge + "  set Range = 0.05, 0.02\n  set Values = 1\n", "Range", "there are values too");
  refuse("  set Values = 1 | 2\n", "Values", "no key that takes them");
  refuse(edge + "  set Values = 0.05 | | 0.02\n", "Values", "name of a case");
  refuse(edge + "  set Values = 0.05 | 0.05\n", "Change grid", "two cases '0.05'");
  refuse(edge + "  set Values = 50 mm\n", "Values", "50 mm");
}

/// What no backend, integrator or material of any row reads.
TEST(Plan, RefusesChangesThatNoRowReads) {
  const CubeStudy study;
  const std::string spacing = change("  set Key = Body cube/Phyxels/Spacing [m]\n  set Values = 0.03\n");
  try {
    require_changes_read(study.plan(CubeStudy::head() + fem + spacing));
    ADD_FAILURE() << "was accepted";
  } catch (const ParameterError& error) {
    EXPECT_NE(std::string(error.what()).find("Change grid/Values"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("no row reads"), std::string::npos) << error.what();
    EXPECT_GT(error.complaint().line, 8);
  }
  EXPECT_NO_THROW(require_changes_read(
    study.plan(CubeStudy::head() + fem + CubeStudy::variant("pba", "Body cube/Backend=pba") + spacing)))
    << "one row reads it; the other fails with its reason";
  const std::string element = change("  set Key = Body cube/Element\n  set Values = trilinear | enhanced\n");
  const auto with = [&](const std::string& backend) {
    return study.plan(CubeStudy::head() + CubeStudy::variant(backend, "Body cube/Backend=" + backend) + element);
  };
  EXPECT_THROW(require_changes_read(with("pba")), ParameterError);
  EXPECT_NO_THROW(require_changes_read(with("fem")));
  EXPECT_NO_THROW(
    require_changes_read(study.plan(CubeStudy::head() + fem +
                                    change("  set Key = Body cube/Mesh\n  subsection Case lost\n"
                                           "    set Set = Body cube/Mesh=lost.off\n  end\n  set Values = x.off\n"))))
    << "a row's own fault is told by the row";
}

TEST(Plan, RefusesMixedUnitsAndReferencesOfNothing) {
  const std::string norm =
    "subsection Norm energy\n  set Answer = kinetic energy\n  set Unit = N\n  set Truth = elastic energy\nend\n";
  expect_refused(CubeStudy::head() + fem + norm, "Unit = N", {"has the unit J"});
  expect_refused(CubeStudy::head() + fem + "subsection Points\n  set Points [m] = 0, 0, 0\nend\n", "Points",
                 {"no reference knows"});
  expect_refused(CubeStudy::head("  set Reference row = fem, 7\n") + fem, "Reference row", {"no such row", "'fem'"});
  expect_refused(CubeStudy::head("  set Reference row = finest\n") + fem, "Reference row", {"Order over"});
  const std::string row = CubeStudy::head("  set Reference row = fem\n") + fem;
  expect_refused(row + "subsection Points\n  set Counts [1] = 2, 2, 2\nend\n", "Points", {"two corners"});
  expect_refused(row + "subsection Points\nend\n", "Points", {"no points"});
}

TEST(Plan, KnowsWhetherThereIsAReference) {
  const CubeStudy study;
  const std::string none =
    "subsection Study\n  set Scene = scene.prm\n  set Answer = momentum z\n  set Unit = kg m/s\nend\n";
  EXPECT_FALSE(has_reference(study.plan(none + fem)));
  EXPECT_TRUE(has_reference(study.plan(CubeStudy::head() + fem)));
  EXPECT_TRUE(
    has_reference(study.plan(none + "subsection Variant one\n  set Reference = 1\n  set Reference source = b\nend\n")));
}

/// A mistake of the scene itself is told at the scene's own line.
TEST(Plan, TellsAWrongSceneAtItsLine) {
  const CubeStudy study;
  std::ofstream(study / "scene.prm") << "subsection Tyme\nend\n";
  try {
    study.plan(CubeStudy::head() + fem);
    ADD_FAILURE() << "was accepted";
  } catch (const ParameterError& error) {
    EXPECT_TRUE(error.complaint().file.ends_with("scene.prm")) << error.what();
    EXPECT_EQ(error.complaint().line, 1);
  }
}

TEST(Plan, OfEveryStudyInParams) {
  std::size_t n = 0;
  for (const auto& entry : std::filesystem::directory_iterator(support::checkout() + "/params/studies")) {
    SCOPED_TRACE(entry.path().string());
    const scene::SceneText text = scene::read_scene_text(entry.path().string(), {});
    EXPECT_GE(is_stability_study(text) ? make_stability_plan(text).cases.size() : make_plan(text).rows.size(), 4u);
    ++n;
  }
  EXPECT_GE(n, 5u);
}

} // namespace
} // namespace kerf::study::plan_test
