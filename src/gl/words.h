#pragma once

/// A texture of 32-bit words, read by shaders with texelFetch from a usampler2D.

#include <cstdint>
#include <span>

namespace kerf::gl {

class Words {
 public:
  /// Throws DataError if there is no memory for it.
  Words(int width, int height);
  ~Words();
  Words(const Words&) = delete;
  Words& operator=(const Words&) = delete;

  /// Replaces all words: row 0, row 1, ...; width * height of them.
  void upload(std::span<const std::uint32_t> words) const;

  /// Gives the words to the shaders as texture `unit`.
  void bind(int unit) const;

 private:
  int width_, height_;
  unsigned int id_ = 0;
};

} // namespace kerf::gl
