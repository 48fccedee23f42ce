#pragma once

/// A number that tells points from others without keeping them: for values that are known of where a body was last.

#include "base/vec.h"

#include <cstddef>
#include <cstdint>

namespace kerf {

/// Of all bits of points and of how many there are, the same for any number of threads. Points that differ in one place
/// never have the same; others are taken for each other as rarely as 64 bits allow, with a probability of 5e-20.
std::uint64_t fingerprint(const Points& points);
/// Of the first `n` of them.
std::uint64_t fingerprint(const Points& points, std::size_t n);

} // namespace kerf
