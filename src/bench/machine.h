#pragma once

/// What this machine does at most, measured: the scale of all other figures.

#include <functional>
#include <vector>

namespace kerf::bench {

struct Machine {
  double flops;     ///< additions and multiplications a second in double precision, on the threads that are set
  double bandwidth; ///< bytes a second from and to memory
};

/// Takes about half a second.
Machine measure_machine();

/// Seconds of a call, of several.
struct Sample {
  double median, spread; ///< [s]; distance of the quartiles over the median [1]
};
Sample sample_of(std::vector<double> seconds);

/// Times a call on the clock: so many samples, each of as many calls as take `least` seconds.
Sample timed(const std::function<void()>& call, int n_samples, double least);

} // namespace kerf::bench
