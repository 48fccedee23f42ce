#pragma once

/// A case: a body in a state, and a sequence of sweeps. Everything follows from its seed; each sweep draws from a
/// generator of its own, so that a case can be repeated with some of its sweeps left out.

#include "tests/fuzz/subject.h"

#include <optional>

namespace kerf::fuzz {

struct Case {
  std::uint32_t seed = 0;
  std::vector<std::uint32_t> sweeps; ///< which of the seed's sweeps are done, in this order

  /// Cuts may end inside cells (cut::Fronts), and blades come in steps (strokes.h).
  bool has_fronts() const { return seed >= first_seed_with_fronts; }
  static constexpr std::uint32_t first_seed_with_fronts = 1u << 31;
};

/// The case with all the sweeps of its seed, 1 to 12.
Case whole_case(std::uint32_t seed);

/// "12" or "12:0,3,4"; throws std::invalid_argument.
Case parse_case(const std::string& text);
std::string to_string(const Case& one);

struct Outcome {
  std::optional<std::string> failure;
  std::size_t n_done = 0;   ///< sweeps begun
  std::string story;        ///< what was done, line by line
  std::uint64_t digest = 0; ///< of all that came out, bit by bit
};

/// Sees what is left of a body after each sweep.
using Judge = std::function<void(const grid::Solid&, bool is_last)>;

/// Draws a specimen and runs the case on it. Whatever is thrown is a failure, by `judge` too.
Outcome run(const Case& one, const std::vector<Specimen>& specimens, Tally& tally, const Judge& judge = {});

/// The shortest prefix that fails, and of it what is needed: sweeps are left out one by one while the case still fails.
Case shrunk(Case failing, const std::vector<Specimen>& specimens);

} // namespace kerf::fuzz
