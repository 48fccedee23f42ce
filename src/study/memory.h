#pragma once

namespace kerf::study {

/// What happens to the memory of this process from construction on.
class PeakMemory {
 public:
  PeakMemory();

  /// Most memory that the process has had in RAM, beyond what it had at first [byte]; NaN where the system does not
  /// tell (Linux does: /proc/self/status, whose peak /proc/self/clear_refs resets).
  double beyond_start() const;

 private:
  double start_;
};

} // namespace kerf::study
