// Tables of studies, written and read back.

#include "output/study_file.h"

#include "base/error.h"
#include "output/reader.h"
#include "tests/output/samples.h"

#include <gtest/gtest.h>

#include <fstream>
#include <limits>

namespace kerf::output::study_file_test {
namespace {

StudyTable sample_table(const std::size_t n) {
  StudyTable table{"A title", "the text\n", "m/s", "end of 'speed'", Outcome::running, {}};
  for (std::size_t i = 0; i < n; ++i) {
    StudyRow row;
    row.name = "row " + std::to_string(i);
    row.outcome = i == 1 ? "failed: \xC3\xA9 is no ASCII" : "completed";
    row.value = i == 1 ? std::numeric_limits<double>::quiet_NaN() : 0.1 * double(i);
    row.n_dof = std::int64_t(i) << 40;
    table.rows.push_back(row);
  }
  return table;
}

TEST(StudyFile, ReadsBackWhatWasWritten) {
  const TemporaryFolder folder;
  const StudyTable table = sample_table(3);
  write_study_file(folder / "study.h5", table, sample_info());
  const StudyTable read = read_study_file(folder / "study.h5");
  EXPECT_EQ(std::tie(read.title, read.text, read.unit, read.answer, read.outcome),
            std::tie(table.title, table.text, table.unit, table.answer, table.outcome));
  ASSERT_EQ(read.rows.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(std::tie(read.rows[i].name, read.rows[i].outcome, read.rows[i].n_dof),
              std::tie(table.rows[i].name, table.rows[i].outcome, table.rows[i].n_dof));
  }
  EXPECT_EQ(read.rows[2].value, table.rows[2].value);
  EXPECT_TRUE(std::isnan(read.rows[1].value));
}

TEST(StudyFile, SaysWhatItsColumnsAre) {
  const TemporaryFolder folder;
  write_study_file(folder / "study.h5", sample_table(1), sample_info());
  const Reader reader(folder / "study.h5");
  EXPECT_EQ(reader.info().command_line, sample_info().command_line);
  EXPECT_EQ(reader.attribute("/study/rows/value", "unit"), "m/s");
  EXPECT_EQ(reader.attribute("/study/rows/reference", "unit"), "m/s");
  EXPECT_EQ(reader.attribute("/study/rows/peak_memory", "unit"), "byte");
  for (const char* column : {"name", "h", "dt", "dof", "error", "order", "setup_time", "cpu_time", "outcome"})
    EXPECT_FALSE(reader.attribute(std::string("/study/rows/") + column, "description").empty()) << column;
}

TEST(StudyFile, ReplacesAnEarlierOneOfMoreRows) {
  const TemporaryFolder folder;
  write_study_file(folder / "study.h5", sample_table(5), sample_info());
  write_study_file(folder / "study.h5", sample_table(2), sample_info());
  EXPECT_EQ(read_study_file(folder / "study.h5").rows.size(), 2u);
}

TEST(StudyFile, SaysWhatCannotBeReadOrWritten) {
  const TemporaryFolder folder;
  EXPECT_THROW(write_study_file(folder / "no/folder/study.h5", sample_table(1), sample_info()), DataError);
  EXPECT_THROW(read_study_file(folder / "study.h5"), DataError);
  std::ofstream(folder / "study.h5") << "no HDF5";
  EXPECT_THROW(read_study_file(folder / "study.h5"), DataError);
}

} // namespace
} // namespace kerf::output::study_file_test
