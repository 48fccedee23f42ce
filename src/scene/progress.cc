#include "scene/progress.h"

#include <algorithm>
#include <utility>

#include <unistd.h>

namespace kerf::scene {

ProgressStyle progress_style(std::FILE* const stream) {
  return isatty(fileno(stream)) != 0 ? ProgressStyle::bar : ProgressStyle::lines;
}

Progress::Progress(const int n_steps, const double end_time, const ProgressStyle style, std::FILE* const stream,
                   const std::chrono::milliseconds patience)
  : n_steps_(n_steps), end_time_(end_time), style_(style), stream_(stream), patience_(patience) {
  if (style_ != ProgressStyle::silent)
    waiting_ = std::jthread([this](const std::stop_token& stop) { name_long_steps(stop); });
}

void Progress::name_long_steps(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  for (auto named = start_; !stop.stop_requested();) {
    over_.wait_until(lock, stop, std::max(named, stepped_) + patience_, [] { return false; });
    const auto now = Clock::now();
    if (stop.stop_requested() || step_ == n_steps_ || now - std::max(named, stepped_) < patience_)
      continue;
    named = now;
    name_step(std::chrono::duration<double>(now - stepped_).count());
  }
}

void Progress::name_step(const double seconds) {
  const bool is_bar = style_ == ProgressStyle::bar;
  std::fprintf(stream_, is_bar ? "\rstep %d/%d has taken %.0f s so far%40s" : "step %d/%d has taken %.0f s so far%s\n",
               step_ + 1, n_steps_, seconds, "");
  open_line_ = is_bar;
  std::fflush(stream_);
}

double Progress::steps_per_second() const {
  const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
  return seconds > 0 ? n_taken() / seconds : 0;
}

void Progress::begin(const int step) {
  const std::lock_guard lock(mutex_);
  step_ = first_ = step;
}

void Progress::say(const std::string& line) {
  const std::lock_guard lock(mutex_);
  if (style_ == ProgressStyle::silent)
    return;
  std::fprintf(stream_, "%s\n", line.c_str());
  std::fflush(stream_);
}

void Progress::show(const int step, const double time) {
  const std::lock_guard lock(mutex_);
  step_ = step;
  if (style_ == ProgressStyle::silent)
    return;
  const auto now = stepped_ = Clock::now();
  const auto pause = style_ == ProgressStyle::bar ? std::chrono::milliseconds(100) : std::chrono::milliseconds(5000);
  if (now - shown_ < pause && step != n_steps_)
    return;
  shown_ = now;
  constexpr int width = 32;
  const int full = static_cast<int>(static_cast<long>(width) * step / n_steps_);
  const std::string bar = std::string(full, '#') + std::string(width - full, '.');
  if (style_ == ProgressStyle::bar)
    std::fprintf(stream_, "\r[%s] step %d/%d  t = %.3f/%.3f s  %.1f steps/s   ", bar.c_str(), step, n_steps_, time,
                 end_time_, steps_per_second());
  else
    std::fprintf(stream_, "step %d/%d  t = %.3f/%.3f s  %.1f steps/s\n", step, n_steps_, time, end_time_,
                 steps_per_second());
  open_line_ = style_ == ProgressStyle::bar;
  std::fflush(stream_);
}

void Progress::finish() {
  waiting_ = {}; // which ends the thread
  if (open_line_)
    std::fprintf(stream_, "\n");
  open_line_ = false;
}

LongWork::LongWork(std::string what, std::FILE* const stream, const std::chrono::milliseconds patience)
  : waiting_([this, what = std::move(what), stream, patience](const std::stop_token& stop) {
      std::unique_lock lock(mutex_);
      const auto start = std::chrono::steady_clock::now();
      for (auto due = start + patience; !stop.stop_requested(); due += patience)
        if (over_.wait_until(lock, stop, due, [] { return false; }); !stop.stop_requested()) {
          const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
          std::fprintf(stream, "%s has taken %.0f s so far\n", what.c_str(), seconds.count());
          std::fflush(stream);
        }
    }) {}

} // namespace kerf::scene
