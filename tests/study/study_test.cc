// Studies from end to end, with answers that are known.

#include "study/measure.h"
#include "tests/study/study_text.h"

#include "output/reader.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace kerf::study::study_test {
namespace {

const double nan = std::numeric_limits<double>::quiet_NaN();

/// In free fall every integrator has the momentum -m g t to round-off.
TEST(Study, MeasuresFreeFallWithTwoBackends) {
  const CubeStudy study;
  const auto table =
    study.run(CubeStudy::head() + CubeStudy::variant("fem", "Body cube/Integrator=symplectic Euler") +
              CubeStudy::variant("springs", "Body cube/Backend=mass-spring | Body cube/Cube edge [m]=0.025"));
  ASSERT_EQ(table.rows.size(), 2u);
  for (const output::StudyRow& row : table.rows) {
    SCOPED_TRACE(row.name);
    EXPECT_EQ(row.outcome, "completed");
    EXPECT_NEAR(row.value, -8 * 9.81 * 0.05, 1e-9);
    EXPECT_EQ(row.reference, -3.924);
    EXPECT_NEAR(row.error, 0, 1e-9);
    EXPECT_TRUE(std::isnan(row.order));
    EXPECT_EQ(row.dt, 0.01);
    EXPECT_EQ(row.n_steps, 5);
    EXPECT_GT(row.setup_seconds, 0);
    EXPECT_GT(row.stepping_seconds, 0);
    EXPECT_GT(row.cpu_seconds, 0);
    EXPECT_GE(row.peak_memory, 0);
  }
  EXPECT_EQ(table.rows[0].backend, "fem");
  EXPECT_EQ(table.rows[0].integrator, "symplectic Euler");
  EXPECT_EQ(table.rows[0].n_iterations, 0);
  EXPECT_EQ(table.rows[0].h, 0.05);
  EXPECT_EQ(table.rows[0].n_dof, 3 * 6 * 6 * 6);
  EXPECT_EQ(table.rows[1].backend, "mass-spring");
  EXPECT_EQ(table.rows[1].integrator, "implicit Euler");
  EXPECT_GT(table.rows[1].n_iterations, 0);
  EXPECT_EQ(table.rows[1].n_dof, 3 * 10 * 10 * 10);
}

/// v = -g dt n after n steps of symplectic or implicit Euler: the way is g dt^2 n (n + 1) / 2.
TEST(Study, TakesADifferenceOfSeriesAndItsMaximum) {
  const CubeStudy study;
  const auto table = study.run(
    "subsection Study\n"
    "  set Scene  = scene.prm\n"
    "  set Answer = kinetic energy\n"
    "  set Minus  = kinetic energy\n"
    "  set Unit   = J\n"
    "end\n"
    "subsection Variant one\nend\n");
  EXPECT_EQ(table.rows[0].value, 0);
  EXPECT_TRUE(std::isnan(table.rows[0].error)) << "there is no reference";
  EXPECT_EQ(table.answer, "end of 'kinetic energy' minus 'kinetic energy'");
  const auto way = study.run(
    "subsection Study\n"
    "  set Scene  = scene.prm\n"
    "  set Answer = largest displacement\n"
    "  set Take   = maximum\n"
    "  set Unit   = m\n"
    "end\n"
    "subsection Variant one\nend\n");
  EXPECT_NEAR(way.rows[0].value, 9.81 * 1e-4 * 15, 1e-7);
}

TEST(Study, WritesWhatItReturns) {
  const CubeStudy study;
  const std::string text = CubeStudy::head() + CubeStudy::variant("one", "Time/End time [s]=0.02") +
                           "subsection Change grid\n  subsection Case a-1\n  end\n  subsection Case b\n  end\nend\n";
  const auto table = study.run(text);
  const auto read = output::read_study_file(study / "out/study.h5");
  EXPECT_EQ(read.title, "Free fall");
  std::string standalone = text; // with the scene's absolute path
  const std::string written = "Scene            = scene.prm";
  standalone.replace(standalone.find(written), written.size(), "Scene = " + (study / "scene.prm").string());
  EXPECT_EQ(read.text, standalone);
  EXPECT_EQ(read.unit, "kg m/s");
  EXPECT_EQ(read.answer, table.answer);
  EXPECT_EQ(read.outcome, output::Outcome::completed);
  ASSERT_EQ(read.rows.size(), 2u);
  EXPECT_EQ(read.rows[1].name, "one, b");
  const output::StudyRow &a = table.rows[0], &b = read.rows[0];
  EXPECT_EQ(b.name, "one, a-1");
  EXPECT_EQ(b.changes, "Time/End time [s]=0.02");
  EXPECT_EQ(b.reference_source, "-m g t");
  EXPECT_EQ(std::tie(a.name, a.family, a.backend, a.integrator, a.outcome, a.h, a.dt, a.value, a.error),
            std::tie(b.name, b.family, b.backend, b.integrator, b.outcome, b.h, b.dt, b.value, b.error));
  EXPECT_EQ(
    std::tie(a.n_dof, a.n_steps, a.n_iterations, a.setup_seconds, a.stepping_seconds, a.cpu_seconds, a.peak_memory),
    std::tie(b.n_dof, b.n_steps, b.n_iterations, b.setup_seconds, b.stepping_seconds, b.cpu_seconds, b.peak_memory));
  const output::Reader run(study / "out/rows/one+a-1/run.h5");
  EXPECT_EQ(run.outcome(), output::Outcome::completed);
  EXPECT_EQ(run.observable("cube momentum z").back(), a.value);
  EXPECT_NE(run.scene().find("set End time [s] = 0.02 # --set"), std::string::npos);
  const output::Reader file(study / "out/study.h5");
  EXPECT_EQ(file.attribute("/study/rows/value", "unit"), "kg m/s");
  EXPECT_EQ(file.attribute("/study/rows/stepping_time", "unit"), "s");
  EXPECT_EQ(file.info().git_commit, output::sample_info().git_commit);
}

/// Neither what cannot be composed nor what fails on its way ends the study.
TEST(Study, GoesOnAfterFailedRows) {
  const CubeStudy study;
  const auto table =
    study.run(CubeStudy::head() + CubeStudy::variant("no-mesh", "Body cube/Mesh=nowhere.off") +
              CubeStudy::variant("too-long",
                                 "Body cube/Integrator=symplectic Euler | Time/Time step [s]=1 | Time/End time [s]=3") +
              CubeStudy::variant("good", ""));
  ASSERT_EQ(table.rows.size(), 3u);
  EXPECT_TRUE(table.rows[0].outcome.starts_with("failed: ")) << table.rows[0].outcome;
  EXPECT_NE(table.rows[0].outcome.find("nowhere.off"), std::string::npos) << table.rows[0].outcome;
  EXPECT_NE(table.rows[1].outcome.find("stable"), std::string::npos) << table.rows[1].outcome;
  EXPECT_EQ(table.rows[1].n_steps, 0);
  EXPECT_EQ(table.rows[2].outcome, "completed");
  for (int i = 0; i < 2; ++i)
    EXPECT_TRUE(std::isnan(table.rows[i].value) && std::isnan(table.rows[i].error));
  EXPECT_NEAR(table.rows[2].error, 0, 1e-9);
  EXPECT_EQ(table.outcome, output::Outcome::completed);
}

TEST(Study, FailsWhenEveryRowDoes) {
  const CubeStudy study;
  try {
    study.run(CubeStudy::head() + CubeStudy::variant("no-mesh", "Body cube/Mesh=nowhere.off"));
    ADD_FAILURE() << "went on";
  } catch (const NumericalError& error) {
    EXPECT_NE(std::string(error.what()).find("no-mesh"), std::string::npos) << error.what();
  }
  EXPECT_EQ(output::read_study_file(study / "out/study.h5").outcome, output::Outcome::failed);
}

TEST(Study, RefusesAnAnswerThatTheSceneDoesNotGive) {
  const CubeStudy study;
  const auto refuse = [&](const std::string& from, const std::string& to, const std::string& key,
                          const std::string& words) {
    std::string text = CubeStudy::head("  set Body = cube\n") + CubeStudy::variant("one", "");
    text.replace(text.find(from), from.size(), to);
    try {
      study.run(text);
      ADD_FAILURE() << "ran: " << to;
    } catch (const ParameterError& error) {
      EXPECT_EQ(error.complaint().line, scene::line_of(text, to)) << error.what();
      EXPECT_EQ(error.complaint().path, "Study/" + key) << error.what();
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  };
  refuse("= momentum z", "= volume", "Answer", "It records momentum z, largest displacement, kinetic energy");
  refuse("= kg m/s\n", "= m\n", "Unit", "set Unit = kg m/s");
  refuse("Body = cube", "Body = ball", "Body", "no such body");
}

double taken(const std::vector<double>& series, const std::string& how, const double last_part) {
  AnswerParameters asked;
  asked.take = how;
  asked.last_part = last_part;
  return take(series, asked, 0.5);
}

TEST(Take, StandsForASeries) {
  const std::vector<double> series = {5, 1, 2, 3};
  EXPECT_EQ(taken(series, "end", 0.1), 3);
  EXPECT_EQ(taken(series, "maximum", 0.1), 5);
  EXPECT_EQ(taken(series, "minimum", 0.1), 1);
  EXPECT_EQ(taken(series, "mean of the last part", 0.1), 3);
  EXPECT_EQ(taken(series, "mean of the last part", 0.5), 2.5);
  EXPECT_EQ(taken(series, "mean of the last part", 1), 2.75);
  EXPECT_TRUE(std::isnan(taken({}, "end", 0.1)));
}

TEST(Take, FrequencyIsThatOfPassagesThroughTheMean) {
  std::vector<double> series;
  for (int i = 0; i <= 120; ++i)
    series.push_back(3 + std::sin(2 * M_PI * i / 15));
  EXPECT_NEAR(taken(series, "frequency", 1), 1 / (15 * 0.5), 1e-3) << "entries are half a second apart";
  EXPECT_TRUE(std::isnan(taken({1, 2, 3}, "frequency", 1)));
}

output::StudyRow row_of(const std::string& family, const double h, const double error) {
  output::StudyRow row;
  row.name = family;
  row.family = family;
  row.h = h;
  row.error = error;
  row.order = nan;
  return row;
}

TEST(Orders, AreToldWithinAFamily) {
  std::vector<output::StudyRow> rows = {row_of("a", 0.1, 0.4),  row_of("b", 0.1, -0.2), row_of("a", 0.05, 0.1),
                                        row_of("b", 0.05, 0.1), row_of("a", 0.04, nan), row_of("a", 0.025, 0.0125),
                                        row_of("a", 0.025, 0.1)};
  tell_orders(rows);
  EXPECT_NEAR(rows[2].order, 2, 1e-12);
  EXPECT_NEAR(rows[3].order, 1, 1e-12);
  EXPECT_NEAR(rows[5].order, 3, 1e-12);
  for (const int i : {0, 1, 4, 6})
    EXPECT_TRUE(std::isnan(rows[i].order)) << i;
}

TEST(Aligned, SaysWhatIsKnown) {
  output::StudyTable table;
  table.unit = "m";
  table.rows = {row_of("short", 0.1, 0.25), row_of("much longer", 0.05, nan)};
  table.rows[0].value = 12.5;
  table.rows[1].value = nan;
  table.rows[1].outcome = "failed: why";
  const std::string text = aligned(table);
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);)
    lines.push_back(line);
  ASSERT_EQ(lines.size(), 4u);
  const std::size_t end = lines[0].find("value") + 5; // numbers end below the end of their heading
  EXPECT_EQ(lines[1].substr(end - 3, 3), "[m]");
  EXPECT_EQ(lines[2].substr(end - 4, 4), "12.5");
  EXPECT_EQ(lines[3].substr(end - 2, 2), " -");
  EXPECT_NE(lines[2].find("+25.00"), std::string::npos);
  EXPECT_TRUE(lines[3].starts_with("much longer"));
  EXPECT_TRUE(lines[3].ends_with("failed: why"));
}

} // namespace
} // namespace kerf::study::study_test
