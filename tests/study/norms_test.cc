// What a study asks of its rows beside one number: more of them, displacements at points, repetitions; and what rows
// are measured by.

#include "output/reader.h"
#include "study/measure.h"
#include "tests/study/study_text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace kerf::study::norms_test {
namespace {

const double nan = std::numeric_limits<double>::quiet_NaN();
const std::string fem = CubeStudy::variant("fem", "");
const std::string halves = fem + CubeStudy::variant("half", "Gravity/Acceleration [m/s^2]=0, 0, -4.905");

std::string read_text(const std::filesystem::path& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(Repetitions, GiveMediansAndSpreads) {
  const CubeStudy study;
  const auto table = study.run(CubeStudy::head("  set Repetitions = 3\n") + fem);
  const output::StudyRow& row = table.rows[0];
  EXPECT_EQ(row.outcome, "completed");
  EXPECT_EQ(row.n_repetitions, 3);
  for (const double spread : {row.setup_spread, row.stepping_spread, row.cpu_spread})
    EXPECT_GE(spread, 0);
  EXPECT_GT(row.setup_spread + row.stepping_spread + row.cpu_spread, 0) << "no two runs take the same time";
  for (const char* run : {"run.h5", "2/run.h5", "3/run.h5"})
    EXPECT_TRUE(std::filesystem::exists(study / "out/rows/fem" / run)) << run;
  EXPECT_EQ(output::read_study_file(study / "out/study.h5").rows[0].cpu_spread, row.cpu_spread);
  EXPECT_NE(aligned(table).find("CPU +-"), std::string::npos);
}

output::StudyRow run_of(const double value, const double seconds) {
  output::StudyRow row;
  row.value = value;
  row.outcome = "completed";
  row.setup_seconds = row.stepping_seconds = row.cpu_seconds = seconds;
  row.peak_memory = 1e6 * seconds;
  return row;
}

TEST(Repetitions, AreTakenTogether) {
  const output::StudyRow odd = together({run_of(1, 3), run_of(1, 7), run_of(1, 4)});
  EXPECT_EQ(odd.outcome, "completed");
  EXPECT_EQ(odd.cpu_seconds, 4);
  EXPECT_EQ(odd.stepping_spread, 4);
  EXPECT_EQ(odd.peak_memory, 7e6);
  EXPECT_EQ(together({run_of(nan, 1), run_of(nan, 2)}).setup_seconds, 1.5);
  EXPECT_EQ(together({run_of(nan, 1), run_of(nan, 2)}).outcome, "completed") << "what both do not know is the same";
}

/// By the last bit.
TEST(Repetitions, ThatDifferAreAFailure) {
  const double other = std::nextafter(1, 2);
  EXPECT_NE(together({run_of(1, 1), run_of(1, 1), run_of(other, 1)}).outcome.find("failed: repetition 3 has other"),
            std::string::npos);
  std::vector<output::StudyRow> runs = {run_of(1, 1), run_of(1, 1)};
  runs[0].displacements = {0, 0, 1};
  runs[1].displacements = {0, 0, -1};
  EXPECT_NE(together(runs).outcome, "completed");
  runs = {run_of(1, 1), run_of(1, 1)};
  runs[1].outcome = "failed: why";
  EXPECT_EQ(together(runs).outcome, "failed: repetition 2 has failed: why");
}

/// The way of symplectic and implicit Euler in free fall: g dt^2 n (n + 1) / 2, 0.014715 m after five steps.
TEST(Norms, AreAskedBesideTheAnswer) {
  const CubeStudy study;
  const auto table = study.run(CubeStudy::head() + fem +
                               "subsection Norm way of the fall\n  set Answer = largest displacement\n  set Unit = m\n"
                               "  set Reference = 0.0147\n  set Reference source = by hand\nend\n"
                               "subsection Norm energy\n  set Answer = kinetic energy\n  set Unit = J\nend\n");
  const auto read = output::read_study_file(study / "out/study.h5");
  for (const output::StudyTable& one : {table, read}) {
    ASSERT_EQ(one.norms.size(), 2u);
    EXPECT_EQ(one.norms[0].name, "way_of_the_fall");
    EXPECT_EQ(one.norms[0].unit, "m");
    EXPECT_EQ(one.norms[1].answer, "end of 'kinetic energy'");
    const auto& values = one.rows[0].norms;
    EXPECT_NEAR(values[0].value, 0.014715, 1e-7);
    EXPECT_NEAR(values[0].error, 0.014715 / 0.0147 - 1, 1e-5);
    EXPECT_NEAR(values[1].value, 8 * 0.4905 * 0.4905 / 2, 1e-6);
    EXPECT_TRUE(std::isnan(values[1].error)) << "it has no reference";
  }
  const output::Reader file(study / "out/study.h5");
  EXPECT_EQ(file.attribute("/study/rows/value_way_of_the_fall", "unit"), "m");
  EXPECT_NE(aligned(table).find("way_of_the_fall"), std::string::npos);
}

/// A row that falls half as far differs by half at each point; the row that others are measured by says nothing of
/// itself.
TEST(Points, AreComparedWithThoseOfARow) {
  const CubeStudy study;
  const std::string points =
    "subsection Points\n  set Points [m] = 0, 0, 0\n  set Box [m] = -0.05, 0, 0; 0.05, 0.02, 0\n"
    "  set Counts [1] = 3, 2, 1\nend\n";
  std::string head = CubeStudy::head("  set Reference row = fem\n");
  const auto without = head.find("  set Reference        =");
  head.erase(without, head.find("  set Reference row") - without);
  const auto table = study.run(head + points + halves);
  ASSERT_EQ(table.points.size(), 7u);
  EXPECT_EQ(table.points[1], Vec3(-0.05, 0, 0));
  EXPECT_EQ(table.points[5], Vec3(0, 0.02, 0));
  const output::StudyRow &whole = table.rows[0], &half = table.rows[1];
  EXPECT_NEAR(half.error_l2, 0.5, 1e-9);
  EXPECT_NEAR(half.error_max, 0.5, 1e-9);
  EXPECT_NEAR(half.error, -0.5, 1e-9);
  EXPECT_EQ(half.reference_source, "the row fem");
  for (const double error : {whole.error, whole.error_l2, whole.error_max})
    EXPECT_TRUE(std::isnan(error));
  const auto read = output::read_study_file(study / "out/study.h5");
  EXPECT_EQ(read.points, table.points);
  EXPECT_EQ(read.rows[1].displacements, half.displacements);
  EXPECT_EQ(read.rows[1].reference_displacements, whole.displacements);
  EXPECT_NEAR(half.displacements[2], -0.014715 / 2, 1e-7);
  EXPECT_EQ(read.rows[1].error_max, half.error_max);
}

TEST(Csv, HoldsTheRowsToTheLastDigit) {
  const CubeStudy study;
  const auto table = study.run(CubeStudy::head() + fem + CubeStudy::variant("no-mesh", "Body cube/Mesh=nowhere.off"));
  std::istringstream in(read_text(study / "out/study.csv"));
  std::string head, first, second;
  std::getline(in, head) && std::getline(in, first) && std::getline(in, second);
  EXPECT_NE(head.find("\"value [kg m/s]\",\"reference [kg m/s]\""), std::string::npos) << head;
  EXPECT_EQ(std::count(head.begin(), head.end(), ','), std::count(first.begin(), first.end(), ',')) << first;
  EXPECT_NE(first.find("," + to_text(table.rows[0].value) + ","), std::string::npos) << first;
  EXPECT_TRUE(first.ends_with("\"completed\"")) << first;
  EXPECT_NE(second.find(",,"), std::string::npos) << "its value is not known: " << second;
  EXPECT_NE(second.find("\"failed: "), std::string::npos) << second;
}

output::StudyRow row_of(const std::string& name, const std::string& family, const double h, const double value) {
  output::StudyRow row = run_of(value, 1);
  row.name = name;
  row.family = family;
  row.h = h;
  row.reference = nan;
  return row;
}

TEST(ReferenceRow, FinestIsThatOfTheFamily) {
  std::vector<output::StudyRow> rows = {row_of("a, 1", "a", 0.1, 2), row_of("a, 2", "a", 0.05, 4),
                                        row_of("b, 1", "b", 0.1, 5), row_of("b, 2", "b", 0.01, 10),
                                        row_of("a, 3", "a", 0.01, 0)};
  rows[4].outcome = "failed: why";
  rows[2].reference = 20; // which it has been given
  tell_references("finest", rows);
  EXPECT_EQ(rows[0].error, -0.5);
  EXPECT_TRUE(std::isnan(rows[1].error));
  EXPECT_EQ(rows[2].error, -0.75);
  EXPECT_TRUE(std::isnan(rows[3].error));
  EXPECT_EQ(rows[0].reference_source, "the row a, 2");
  tell_references("b, 2", rows);
  EXPECT_EQ(rows[1].error, 4.0 / 10 - 1);
  EXPECT_EQ(rows[0].error, -0.5) << "what is known stays";
}

/// Where cubes are the same, the finest row is that of the shortest step, and orders are in time.
TEST(ReferenceRow, IsTheOneWithTheShortestStepWhereCubesAreTheSame) {
  std::vector<output::StudyRow> rows = {row_of("coarse", "a", 0.1, 1.4), row_of("fine", "a", 0.1, 1.1),
                                        row_of("finest", "a", 0.1, 1)};
  for (const int k : {0, 1, 2})
    rows[k].dt = std::pow(0.25, k);
  tell_references("finest", rows);
  tell_orders(rows);
  EXPECT_DOUBLE_EQ(rows[0].error, 1.4 - 1);
  EXPECT_EQ(rows[1].reference_source, "the row finest");
  EXPECT_NEAR(rows[1].order, 1, 1e-12);
}

} // namespace
} // namespace kerf::study::norms_test
