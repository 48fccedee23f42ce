#pragma once

/// A checksum that tells whole bytes from torn ones; no protection against anyone who means harm.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace kerf::output {

constexpr std::uint64_t first_checksum = 0xcbf29ce484222325u;

/// In the manner of FNV-1a, eight bytes at a time; goes on from `sum`.
inline std::uint64_t checksum(std::uint64_t sum, const std::span<const std::byte> bytes) {
  for (std::size_t i = 0; i < bytes.size(); i += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, &bytes[i], std::min<std::size_t>(8, bytes.size() - i));
    sum = (sum ^ word) * 0x100000001b3u;
    sum ^= sum >> 29;
  }
  return sum;
}

} // namespace kerf::output
