// What a run shows of its progress, in a terminal and elsewhere.

#include "scene/progress.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>

namespace kerf::scene::progress_test {
namespace {

using Stream = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

std::string written(std::FILE* const stream) {
  std::rewind(stream);
  std::string text;
  for (int c; (c = std::fgetc(stream)) != EOF;)
    text += static_cast<char>(c);
  return text;
}

/// What ten steps show that follow each other at once.
std::string ten_steps(const ProgressStyle style) {
  const Stream stream(std::tmpfile(), std::fclose);
  Progress progress(10, 0.5, style, stream.get());
  for (int step = 1; step <= 10; ++step)
    progress.show(step, 0.05 * step);
  EXPECT_GT(progress.steps_per_second(), 0);
  progress.finish();
  return written(stream.get());
}

TEST(Progress, IsABarThatRedrawsItsLine) {
  const std::string text = ten_steps(ProgressStyle::bar);
  EXPECT_TRUE(text.starts_with("\r[")) << text;
  EXPECT_NE(text.find("] step 10/10  t = 0.500/0.500 s"), std::string::npos) << text;
  EXPECT_EQ(text.find('.', 2), text.find("0.500") + 1) << "the last bar is full: " << text;
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);
  EXPECT_EQ(text.back(), '\n');
}

TEST(Progress, IsLinesElsewhere) {
  const std::string text = ten_steps(ProgressStyle::lines);
  EXPECT_TRUE(text.starts_with("step 10/10  t = 0.500/0.500 s")) << text; // ten quick steps are one line
  EXPECT_EQ(text.find('\r'), std::string::npos);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);
}

TEST(Progress, CanBeSilent) { EXPECT_EQ(ten_steps(ProgressStyle::silent), ""); }

/// A step of 200 ms where 20 are long: it is named while it lasts, and not after.
TEST(Progress, ALongStepIsNamed) {
  for (const ProgressStyle style : {ProgressStyle::lines, ProgressStyle::bar, ProgressStyle::silent}) {
    const Stream stream(std::tmpfile(), std::fclose);
    Progress progress(3, 0.3, style, stream.get(), std::chrono::milliseconds(20));
    progress.show(1, 0.1);
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    progress.show(3, 0.3);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    progress.finish();
    const std::string text = written(stream.get());
    EXPECT_EQ(text.find("step 2/3 has taken 0 s so far") != std::string::npos, style != ProgressStyle::silent) << text;
    EXPECT_EQ(text.find("step 4"), std::string::npos) << text;
    EXPECT_EQ(std::count(text.begin(), text.end(), '\r') > 0, style == ProgressStyle::bar);
  }
}

/// Named again and again while it lasts, and not at all where it does not last.
TEST(LongWork, IsNamedWhileItLasts) {
  const Stream stream(std::tmpfile(), std::fclose);
  for (const int duration : {0, 200}) {
    const LongWork work("Composing", stream.get(), std::chrono::milliseconds(20));
    std::this_thread::sleep_for(std::chrono::milliseconds(duration));
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  const std::string text = written(stream.get());
  const auto n = std::count(text.begin(), text.end(), '\n');
  EXPECT_TRUE(n >= 1 && n <= 10) << text;
  EXPECT_TRUE(text.starts_with("Composing has taken 0 s so far\n")) << text;
}

TEST(Progress, ABarThatIsCutShortEndsItsLineOnce) {
  const Stream stream(std::tmpfile(), std::fclose);
  Progress progress(1, 0.1, ProgressStyle::bar, stream.get());
  progress.finish();
  EXPECT_EQ(written(stream.get()), "");
  progress.show(1, 0.1);
  progress.finish();
  progress.finish();
  const std::string text = written(stream.get());
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);
}

TEST(Progress, ATerminalGetsTheBar) {
  const Stream file(std::tmpfile(), std::fclose);
  EXPECT_EQ(progress_style(file.get()), ProgressStyle::lines);

  const int controller = posix_openpt(O_RDWR | O_NOCTTY);
  if (controller < 0 || grantpt(controller) != 0 || unlockpt(controller) != 0)
    GTEST_SKIP() << "no pseudo terminal here";
  const Stream terminal(fopen(ptsname(controller), "r+"), std::fclose);
  ASSERT_TRUE(terminal);
  EXPECT_EQ(progress_style(terminal.get()), ProgressStyle::bar);
  close(controller);
}

} // namespace
} // namespace kerf::scene::progress_test
