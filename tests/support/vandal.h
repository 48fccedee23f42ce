#pragma once

/// Damages files, the same way for the same seed.

#include <algorithm>
#include <random>
#include <string>
#include <vector>

namespace kerf::support {

/// Damages bytes as editors, disks and people do.
class Vandal {
 public:
  explicit Vandal(const unsigned seed) : random_(seed) {}

  std::string damaged(std::string text) {
    for (int n = 1 + below(3); n > 0; --n)
      text = damaged_once(std::move(text));
    return text;
  }

 private:
  int below(const std::size_t n) { return static_cast<int>(random_() % std::max<std::size_t>(1, n)); }

  std::string damaged_once(std::string text) {
    static const std::vector<std::string> words = {
      "nan", "-1",   "1e309", "inf",      "subsection",         "end\n",        "set ", "=",
      ";",   "#",    "\\",    "\xff\xfe", std::string(1, '\0'), "999999999999", "0",    "\xef\xbb\xbf",
      "x=3", "-nan", "\n",    "3 0 0 0\n"};
    const auto at = static_cast<std::size_t>(below(text.size() + 1)), n = static_cast<std::size_t>(1 + below(40));
    switch (below(7)) {
      case 0:
        return text.substr(0, at);
      case 1:
        return text.erase(std::min(at, text.size()), n);
      case 2:
        return text.insert(at, text.substr(std::min(at, text.size()), n));
      case 3:
        return text.insert(at, words[static_cast<std::size_t>(below(words.size()))]);
      case 4:
        return text.insert(at, std::string(1000000, 'k'));
      default:
        for (std::size_t i = at; i < std::min(at + n / 8 + 1, text.size()); ++i)
          text[i] = static_cast<char>(random_());
        return text;
    }
  }

  std::mt19937 random_;
};

} // namespace kerf::support
