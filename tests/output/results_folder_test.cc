// One run at a time, nothing of others deleted, results only replaced where somebody says so.

#include "output/results_folder.h"

#include "base/error.h"
#include "output/checkpoint_file.h"
#include "tests/output/samples.h"

#include <gtest/gtest.h>

#include <sys/resource.h>
#include <csignal>
#include <fstream>

namespace kerf::output::results_folder_test {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream(path) << text;
}

std::string error_of(const fs::path& folder, const Earlier earlier, const std::vector<std::string>& names) {
  try {
    const ResultsFolder claimed(folder, earlier, names);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

const std::vector<std::string> names = {"run.h5", "frames/*.png"};

TEST(ResultsFolder, IsTakenByOneAtATime) {
  const TemporaryFolder folder;
  const auto out = folder / "a/b";
  {
    const ResultsFolder first(out, Earlier::refuse, names);
    write(out / "run.h5", "mine");
    for (const Earlier earlier : {Earlier::refuse, Earlier::replace, Earlier::resume}) {
      EXPECT_NE(error_of(out, earlier, names).find("is in use: process"), std::string::npos);
      EXPECT_THROW(require_claimable(out, earlier), DataError);
    }
    EXPECT_TRUE(fs::exists(out / "run.h5"));
  }
  EXPECT_EQ(error_of(out, Earlier::resume, names), "");
}

TEST(ResultsFolder, AsksBeforeItReplaces) {
  const TemporaryFolder folder;
  const auto out = folder / "out";
  {
    const ResultsFolder claimed(out, Earlier::refuse, names);
    write(out / "run.h5", "old");
    write(out / "frames/000001.png", std::string("\x89PNG tEXtSoftware\0Kerf", 22));
    write(out / "frames/montage.png", "the user's");
    write(out / "notes.txt", "the user's");
  }
  EXPECT_NE(error_of(out, Earlier::refuse, names).find("--force"), std::string::npos);
  EXPECT_THROW(require_claimable(out, Earlier::refuse), ParameterError);
  EXPECT_TRUE(fs::exists(out / "frames/000001.png"));
  EXPECT_EQ(error_of(out, Earlier::resume, names), "");
  EXPECT_TRUE(fs::exists(out / "frames/000001.png"));
  EXPECT_EQ(error_of(out, Earlier::replace, {"run.h5"}), "");
  EXPECT_FALSE(fs::exists(out / "frames/000001.png"));
  EXPECT_FALSE(fs::exists(out / "run.h5"));
  EXPECT_TRUE(fs::exists(out / "frames/montage.png"));
  EXPECT_TRUE(fs::exists(out / "notes.txt"));
}

TEST(ResultsFolder, LeavesNothingInAFolderThatItRefuses) {
  const TemporaryFolder folder;
  const auto out = folder / "out";
  write(out / "run.h5", "the user's");
  EXPECT_NE(error_of(out, Earlier::replace, names).find("is not known to be Kerf's"), std::string::npos);
  EXPECT_FALSE(fs::exists(out / ".kerf"));
  EXPECT_TRUE(fs::exists(out / "run.h5"));
}

/// Else its own files would be strangers to the next run.
TEST(ResultsFolder, IsNotTakenWhereItsListCannotBeWritten) {
  const TemporaryFolder folder;
  const auto out = folder / "out";
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{20, before.rlim_max}; // bytes, as of a disk that is full
  setrlimit(RLIMIT_FSIZE, &small);
  const std::string error = error_of(out, Earlier::refuse, names);
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_NE(error.find(".kerf: cannot be written: "), std::string::npos) << error;
  EXPECT_NE(error.find("Free disk space"), std::string::npos) << error;
  EXPECT_EQ(error_of(out, Earlier::resume, names), "");
  EXPECT_EQ(error_of(out, Earlier::refuse, names), "");
}

TEST(ResultsFolder, LeavesWhatItDoesNotKnow) {
  const TemporaryFolder folder;
  const auto out = folder / "out";
  write(out / "run.h5", "somebody else's");
  for (const Earlier earlier : {Earlier::refuse, Earlier::replace, Earlier::resume})
    EXPECT_NE(error_of(out, earlier, names).find("is not known to be Kerf's"), std::string::npos);
  EXPECT_EQ(fs::file_size(out / "run.h5"), 15u);
}

/// A picture with a frame's name, and without the mark of ours, stays.
TEST(ResultsFolder, LeavesPicturesThatAreNotKerfs) {
  const TemporaryFolder folder;
  const auto out = folder / "out";
  { const ResultsFolder claimed(out, Earlier::refuse, names); }
  write(out / "frames/000099.png", "\x89PNG of somebody else");
  for (const Earlier earlier : {Earlier::replace, Earlier::resume})
    EXPECT_NE(error_of(out, earlier, names).find("it does not carry Kerf's mark"), std::string::npos);
  { const ResultsFolder without_images(out, Earlier::replace, {"run.h5"}); }
  EXPECT_TRUE(fs::exists(out / "frames/000099.png"));
}

TEST(Checkpoint, IsReadBackOrRefused) {
  const TemporaryFolder folder;
  const auto path = folder / "checkpoint";
  EXPECT_FALSE(read_checkpoint(path));
  const Checkpoint written{"1.0 abc", "hash  file", 42, std::vector<std::byte>(10000, std::byte{7})};
  write_checkpoint(path, written);
  EXPECT_FALSE(fs::exists(name_beside(path)));
  const auto read = read_checkpoint(path);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->program, written.program);
  EXPECT_EQ(read->inputs, written.inputs);
  EXPECT_EQ(read->step, 42);
  EXPECT_EQ(read->state, written.state);
  for (const std::size_t at : {std::size_t{0}, std::size_t{30}, std::size_t{5000}, fs::file_size(path) - 1}) {
    write_checkpoint(path, written);
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(at));
    file.put('\x55');
    file.close();
    EXPECT_THROW(read_checkpoint(path), DataError) << at;
  }
  for (const std::size_t n : {0, 4, 100, 9000}) {
    write_checkpoint(path, written);
    fs::resize_file(path, n);
    EXPECT_THROW(read_checkpoint(path), DataError) << n;
  }
}

} // namespace
} // namespace kerf::output::results_folder_test
