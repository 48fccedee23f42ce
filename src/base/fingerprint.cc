#include "base/fingerprint.h"

#include "base/loan.h"
#include "base/parallel.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace kerf {

namespace {

constexpr std::size_t block = 4096;     // points a part
constexpr std::size_t worth_blocks = 3; // from which on a second thread pays
constexpr std::size_t n_chains = 8;     // at a time: multiplications do not wait for each other

/// One to one in each of both (the finaliser of MurmurHash3: an odd factor, and shifts that bring high bits down).
std::uint64_t mixed(const std::uint64_t state, const std::uint64_t word) {
  const std::uint64_t product = (state ^ word) * 0xff51afd7ed558ccdULL;
  return product ^ product >> 33;
}

std::uint64_t of_words(const Vec3* const points, const std::size_t n) {
  static_assert(sizeof(Vec3) == 3 * sizeof(std::uint64_t));
  const auto word = [&](const std::size_t i) {
    std::uint64_t bits;
    std::memcpy(&bits, reinterpret_cast<const char*>(points) + i * sizeof bits, sizeof bits);
    return bits;
  };
  std::array<std::uint64_t, n_chains> chains = {1, 2, 3, 4, 5, 6, 7, 8};
  std::size_t i = 0;
  for (; i + n_chains <= 3 * n; i += n_chains)
    for (std::size_t k = 0; k < n_chains; ++k)
      chains[k] = mixed(chains[k], word(i + k));
  for (; i < 3 * n; ++i)
    chains[0] = mixed(chains[0], word(i));
  std::uint64_t all = n;
  for (const std::uint64_t chain : chains)
    all = mixed(all, chain);
  return all;
}

} // namespace

std::uint64_t fingerprint(const Points& points) { return fingerprint(points, points.size()); }

std::uint64_t fingerprint(const Points& points, const std::size_t n) {
  Loan<std::uint64_t> parts((n + block - 1) / block);
  parallel_for(
    parts.size(),
    [&](const std::size_t b) { parts[b] = of_words(points.data() + b * block, std::min(block, n - b * block)); },
    worth_blocks);
  std::uint64_t all = n;
  for (const std::uint64_t part : *parts)
    all = mixed(all, part);
  return all;
}

} // namespace kerf
