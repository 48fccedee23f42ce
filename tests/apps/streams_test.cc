// What stdin, stdout and stderr may be where somebody else starts the program: closed, a pipe that nobody reads, a full
// disk.

#include "output/reader.h"
#include "tests/apps/program.h"

#include <csignal>

namespace kerf::apps::streams_test {
namespace {

class Streams : public Program {
 protected:
  output::Outcome outcome() const { return output::Reader(folder / "out/run.h5").outcome(); }
};

TEST_F(Streams, APipeThatNobodyReadsEndsNoRun) {
  const std::string unread = "mkfifo pipe && { : <pipe & } && exec >pipe && wait";
  const Result result = run(cube_scene() + falling_blade(), {}, unread);
  EXPECT_EQ(result.signal, 0);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(outcome(), output::Outcome::completed);
}

TEST_F(Streams, WhatCouldNotBeSaidIsTold) {
  const Words parts = {"stdout", "No space left on device"};
  expect_error(kerf({"params"}, "exec >/dev/full"), 2, parts);
  expect_error(run(cube_scene(), {}, "exec >/dev/full"), 2, parts);
  EXPECT_EQ(outcome(), output::Outcome::completed);
}

/// No file of results may become stdin, stdout or stderr.
TEST_F(Streams, AreOpenWhereTheyWereClosed) {
  const Result result =
    run(replaced(cube_scene(), "= 0.05\nend", "= 60\nend"), {},
        "exec <&- >&- 2>&- && { \"$0\" \"$@\" & p=$!; while kill -0 $p && [ ! -s out/run.h5 ]; do sleep 0.01; done; "
        "for n in 0 1 2; do readlink /proc/$p/fd/$n; done >streams; kill -TERM $p; wait $p; exit; }");
  EXPECT_EQ(read_text(folder / "streams"), "/dev/null\n/dev/null\n/dev/null\n");
  EXPECT_EQ(result.exit_code, 128 + SIGTERM);
  EXPECT_EQ(outcome(), output::Outcome::interrupted);
}

} // namespace
} // namespace kerf::apps::streams_test
