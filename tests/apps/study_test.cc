// `kerf study` from outside: its table, its file, its exit codes.

#include "output/study_file.h"
#include "tests/apps/program.h"

namespace kerf::apps::study_test {
namespace {

std::string study_text() {
  return "subsection Study\n"
         "  set Title            = Free fall of a cube\n"
         "  set Scene            = scene.prm\n"
         "  set Answer           = momentum z\n"
         "  set Unit             = kg m/s\n"
         "  set Reference        = -3.924\n"
         "  set Reference source = -m g t\n"
         "end\n"
         "subsection Variant fem\n"
         "end\n"
         "subsection Variant springs\n"
         "  set Set = Body cube/Backend=mass-spring\n"
         "end\n";
}

class StudyProgram : public Program {
 protected:
  Result study(const std::string& text, const Words& more = {}) const {
    write("scene.prm", cube_scene() +
                         "subsection Gravity\nend\n"
                         "subsection Observables\n  set Names = momentum z\nend\n");
    write("study.prm", text);
    Words words = {"study", "study.prm", "--output", "out", "--force"};
    words.insert(words.end(), more.begin(), more.end());
    return kerf(words);
  }
};

TEST_F(StudyProgram, PrintsAndWritesItsTable) {
  const Result result = study(study_text());
  EXPECT_EQ(result.exit_code, 0) << result.err;
  for (const char* part : {"row 2 of 2: springs: completed", "Free fall of a cube", "value: end of 'momentum z'",
                           "[kg m/s]", "mass-spring", "-3.924", "results in out"})
    EXPECT_NE(result.out.find(part), std::string::npos) << "no '" << part << "' in: " << result.out;
  const auto table = output::read_study_file(folder / "out/study.h5");
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_NEAR(table.rows[1].value, -3.924, 1e-8);
  EXPECT_TRUE(std::filesystem::exists(folder / "out/rows/springs/run.h5"));
}

TEST_F(StudyProgram, TakesChangesOfTheStudyItself) {
  const Result result = study(study_text(), {"--set", "Study/Title=Something else", "--threads", "1"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("\nSomething else\n"), std::string::npos) << result.out;
  const auto table = output::read_study_file(folder / "out/study.h5"); // which holds the study with its changes
  std::filesystem::create_directory(folder / "elsewhere");
  write("elsewhere/stored.prm", table.text);
  ASSERT_EQ(kerf({"study", "elsewhere/stored.prm", "--output", "again"}).exit_code, 0) << read_text(folder / "stderr");
  const auto again = output::read_study_file(folder / "again/study.h5");
  EXPECT_EQ(again.title, "Something else");
  EXPECT_EQ(again.rows[1].value, table.rows[1].value);
}

TEST_F(StudyProgram, RefusesBadStudiesBeforeAnythingIsWritten) {
  const auto refuse = [&](const std::string& from, const std::string& to, const Words& parts) {
    expect_error(study(replaced(study_text(), from, to)), 1, parts);
    EXPECT_FALSE(std::filesystem::exists(folder / "out"));
  };
  refuse("Unit ", "Units", {"study.prm:5: Study/Units", "Did you mean 'Unit'?"});
  refuse("Backend=mass-spring", "Backend=springs", {"study.prm:12: Variant springs/Set", "Body cube/Backend"});
  refuse("subsection Variant springs", "subsection Time", {"study.prm:11: Time", "there is no such section"});
  expect_error(study(replaced(study_text(), "scene.prm", "lost.prm")), 2, {"lost.prm", "cannot be read"});
}

/// A failed row leaves the others; the exit code tells the worst of them.
TEST_F(StudyProgram, TellsFailedRowsByItsExitCode) {
  const std::string no_mesh = replaced(study_text(), "Body cube/Backend=mass-spring", "Body cube/Mesh=lost.off");
  const Result one = study(no_mesh);
  expect_error(one, 3, {"1 of 2 rows have failed", "springs", "lost.off"});
  EXPECT_EQ(output::read_study_file(folder / "out/study.h5").outcome, output::Outcome::completed);
  EXPECT_NE(one.out.find("row 2 of 2: springs: failed: "), std::string::npos) << one.out;
  const Result all = study(replaced(no_mesh, "Variant fem\n", "Variant fem\n  set Set = Body cube/Mesh=lost.off\n"));
  expect_error(all, 3, {"every row of the study has failed", "lost.off"});
}

TEST_F(StudyProgram, SaysThatThereIsNoReference) {
  std::string text = study_text();
  const auto from = text.find("  set Reference ");
  text.erase(from, text.find("end\n") - from);
  const Result result = study(text);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("the study has no reference"), std::string::npos) << result.out;
  EXPECT_EQ(study(study_text()).out.find("has no reference"), std::string::npos);
}

TEST_F(StudyProgram, RefusesAChangeThatNoRowReads) {
  const std::string change =
    "subsection Change spacing\n  set Key = Body cube/Phyxels/Spacing [m]\n  set Values = 0.03 | 0.04\nend\n";
  expect_error(study(study_text() + change), 1, {"Change spacing/Values", "no row reads"});
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

TEST_F(StudyProgram, WritesCsvBesideItsFile) {
  EXPECT_EQ(study(study_text()).exit_code, 0) << read_text(folder / "stderr");
  const std::string csv = read_text(folder / "out/study.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 3) << csv;
  EXPECT_NE(csv.find("\"springs\""), std::string::npos) << csv;
}

TEST_F(StudyProgram, ListsItsKeys) {
  const Result result = kerf({"params", "study"});
  EXPECT_EQ(result.exit_code, 0);
  for (const char* part :
       {"subsection Study", "subsection Variant NAME", "subsection Case NAME", "set Last part [1] = 0.1"})
    EXPECT_NE(result.out.find(part), std::string::npos) << "no '" << part << "' in: " << result.out;
}

} // namespace
} // namespace kerf::apps::study_test
