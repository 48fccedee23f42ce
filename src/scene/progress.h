#pragma once

/// How far a run is: a bar that redraws itself in a terminal, a plain line now and then elsewhere. A step that takes
/// long is named while it lasts, by a thread that only waits and writes; so is any other work that has no steps.

#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <string>
#include <thread>

namespace kerf::scene {

enum class ProgressStyle { bar, lines, silent };

/// A bar where the stream is a terminal, else lines.
ProgressStyle progress_style(std::FILE* stream);

class Progress {
 public:
  /// A step is long once nothing was shown for `patience`, and is named that often.
  Progress(int n_steps, double end_time, ProgressStyle style, std::FILE* stream,
           std::chrono::milliseconds patience = std::chrono::seconds(10));

  /// Steps up to this one were taken before; none where it is not called.
  void begin(int step);
  /// A line of its own.
  void say(const std::string& line);
  /// After step `step` at time `time` [s].
  void show(int step, double time);
  /// Ends the bar's line; no step is named any more.
  void finish();

  int n_taken() const { return step_ - first_; }
  /// Of those taken, since construction.
  double steps_per_second() const;

 private:
  using Clock = std::chrono::steady_clock;

  /// Until it is told to stop.
  void name_long_steps(const std::stop_token& stop);
  void name_step(double seconds);

  int n_steps_, step_ = 0, first_ = 0;
  double end_time_;
  ProgressStyle style_;
  std::FILE* stream_;
  std::chrono::milliseconds patience_;
  Clock::time_point start_ = Clock::now(), shown_ = start_, stepped_ = start_;
  bool open_line_ = false;
  std::mutex mutex_; ///< of all that changes after construction
  std::condition_variable_any over_;
  std::jthread waiting_; ///< last: it uses all the others
};

/// Work that may take long, as long as this is there: "Composing the scene has taken 20 s so far".
class LongWork {
 public:
  /// `what`: begins the line.
  LongWork(std::string what, std::FILE* stream, std::chrono::milliseconds patience = std::chrono::seconds(10));

 private:
  std::mutex mutex_;
  std::condition_variable_any over_;
  std::jthread waiting_; ///< last: it uses the others
};

} // namespace kerf::scene
