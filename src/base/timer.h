#pragma once

/// Where the time of a step goes, stage by stage.

#include <chrono>
#include <map>
#include <string>

namespace kerf {

/// Wall-clock seconds [s] by stage name, summed over the scoped timers that named it.
using Timings = std::map<std::string, double>;

/// Adds the time between construction and destruction to one stage.
class ScopedTimer {
 public:
  ScopedTimer(Timings& timings, const std::string& stage) : seconds_(timings[stage]), start_(Clock::now()) {}
  ~ScopedTimer() { seconds_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
  ScopedTimer(const ScopedTimer&) = delete;
  ScopedTimer& operator=(const ScopedTimer&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& seconds_;
  Clock::time_point start_;
};

} // namespace kerf
