#pragma once

#include <string>

namespace kerf::support {

/// Where the sources of these tests are, without a slash at its end. A function, compiled once, and no macro of every
/// file: compilers' caches serve one checkout with what they compiled for another.
std::string checkout();

} // namespace kerf::support
