#include "study/memory.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

#include <malloc.h>

namespace kerf::study {

namespace {

/// A line of /proc/self/status, in kB there [byte].
double status_of_process(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (double kilobytes = 0; word == name + ":" && status >> kilobytes)
      return 1024 * kilobytes;
  return std::numeric_limits<double>::quiet_NaN();
}

} // namespace

PeakMemory::PeakMemory() {
  malloc_trim(0); // what was given back before does not count
  std::ofstream("/proc/self/clear_refs") << "5";
  start_ = status_of_process("VmRSS");
}

double PeakMemory::beyond_start() const { return std::max(status_of_process("VmHWM") - start_, 0.0); }

} // namespace kerf::study
