#pragma once

/// How far a run is: a bar that redraws itself in a terminal, a plain line now and then elsewhere.

#include <chrono>
#include <cstdio>

namespace kerf::scene {

enum class ProgressStyle { bar, lines, silent };

/// A bar where the stream is a terminal, else lines.
ProgressStyle progress_style(std::FILE* stream);

class Progress {
 public:
  Progress(int n_steps, double end_time, ProgressStyle style, std::FILE* stream);

  /// After step `step` at time `time` [s].
  void show(int step, double time);
  /// Ends the bar's line.
  void finish();

  /// Steps per second since construction.
  double steps_per_second() const;

 private:
  using Clock = std::chrono::steady_clock;

  int n_steps_, step_ = 0;
  double end_time_;
  ProgressStyle style_;
  std::FILE* stream_;
  Clock::time_point start_ = Clock::now(), shown_ = start_;
  bool open_line_ = false;
};

} // namespace kerf::scene
