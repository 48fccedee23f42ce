#include "base/sha256.h"

#include "base/error.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <fstream>
#include <vector>

namespace kerf {

namespace {

constexpr std::size_t block_size = 64;

constexpr std::array<std::uint32_t, 64> constants = {
  0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
  0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
  0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
  0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
  0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
  0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
  0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
  0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

class Hash {
 public:
  /// Any number of whole blocks.
  void take(const std::span<const std::byte> bytes) {
    for (std::size_t i = 0; i + block_size <= bytes.size(); i += block_size)
      take_block(bytes.data() + i);
    n_bytes_ += bytes.size() / block_size * block_size;
  }

  /// What is left of the message, less than a block.
  std::string finish(const std::span<const std::byte> rest) {
    const std::uint64_t n_bits = 8 * (n_bytes_ + rest.size());
    std::vector<std::byte> last(rest.begin(), rest.end());
    last.push_back(std::byte{0x80});
    while (last.size() % block_size != block_size - 8)
      last.push_back(std::byte{0});
    for (int shift = 56; shift >= 0; shift -= 8)
      last.push_back(static_cast<std::byte>(n_bits >> shift & 0xff));
    take(last);
    std::string text;
    for (const std::uint32_t word : state_)
      for (int shift = 28; shift >= 0; shift -= 4)
        text += "0123456789abcdef"[word >> shift & 0xf];
    return text;
  }

 private:
  void take_block(const std::byte* const block) {
    std::array<std::uint32_t, 64> w;
    for (int t = 0; t < 16; ++t)
      w[t] = std::to_integer<std::uint32_t>(block[4 * t]) << 24 |
             std::to_integer<std::uint32_t>(block[4 * t + 1]) << 16 |
             std::to_integer<std::uint32_t>(block[4 * t + 2]) << 8 | std::to_integer<std::uint32_t>(block[4 * t + 3]);
    for (int t = 16; t < 64; ++t)
      w[t] = (std::rotr(w[t - 2], 17) ^ std::rotr(w[t - 2], 19) ^ w[t - 2] >> 10) + w[t - 7] +
             (std::rotr(w[t - 15], 7) ^ std::rotr(w[t - 15], 18) ^ w[t - 15] >> 3) + w[t - 16];
    auto [a, b, c, d, e, f, g, h] = state_;
    for (int t = 0; t < 64; ++t) {
      const std::uint32_t t1 =
        h + (std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25)) + ((e & f) ^ (~e & g)) + constants[t] + w[t];
      const std::uint32_t t2 = (std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22)) + ((a & b) ^ (a & c) ^ (b & c));
      h = g, g = f, f = e, e = d + t1, d = c, c = b, b = a, a = t1 + t2;
    }
    const std::array<std::uint32_t, 8> added = {a, b, c, d, e, f, g, h};
    for (int i = 0; i < 8; ++i)
      state_[i] += added[i];
  }

  std::array<std::uint32_t, 8> state_ = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                         0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::uint64_t n_bytes_ = 0;
};

} // namespace

std::string sha256(const std::span<const std::byte> bytes) {
  Hash hash;
  hash.take(bytes);
  return hash.finish(bytes.subspan(bytes.size() / block_size * block_size));
}

std::string sha256_of_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  Hash hash;
  std::vector<char> piece(1024 * block_size);
  while (in.read(piece.data(), static_cast<std::streamsize>(piece.size())))
    hash.take(std::as_bytes(std::span(piece)));
  if (!in.eof())
    throw DataError(
      Complaint{.file = path.string(), .rule = "cannot be read", .remedy = "Name a file that you may read"});
  const auto rest = std::as_bytes(std::span(piece)).first(static_cast<std::size_t>(in.gcount()));
  hash.take(rest);
  return hash.finish(rest.subspan(rest.size() / block_size * block_size));
}

} // namespace kerf
