#include "scene/text_suggest.h"

#include <algorithm>
#include <cctype>
#include <numeric>

namespace kerf::scene {
namespace {

std::string lower(std::string text) {
  for (char& c : text)
    c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// "Density [kg/m^3]" -> "Density".
std::string without_unit(const std::string& name) {
  const std::string bare = name.substr(0, name.find('['));
  return bare.substr(0, bare.find_last_not_of(' ') + 1);
}

} // namespace

int edit_distance(const std::string& a, const std::string& b) {
  const std::string s = lower(a), t = lower(b);
  std::vector<int> row(t.size() + 1), before = row, two_before = row; // distances of s[0..i) to every t[0..j)
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 1; i <= s.size(); ++i) {
    two_before.swap(before);
    before.swap(row);
    row[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= t.size(); ++j) {
      const int substituted = before[j - 1] + (s[i - 1] == t[j - 1] ? 0 : 1);
      row[j] = std::min({substituted, before[j] + 1, row[j - 1] + 1});
      if (i > 1 && j > 1 && s[i - 1] == t[j - 2] && s[i - 2] == t[j - 1])
        row[j] = std::min(row[j], two_before[j - 2] + 1);
    }
  }
  return row.back();
}

std::optional<std::string> nearest(const std::string& word, const std::vector<std::string>& names) {
  constexpr std::size_t longest = 200; // letters; nobody misspells more
  if (word.size() > longest)
    return std::nullopt;
  // A third of the letters may be wrong; of short words at most two, and never all of them.
  const std::string bare = without_unit(word);
  const int length = static_cast<int>(bare.size());
  int best = std::max(std::min(2, length - 1), length / 3) + 1;
  int best_whole = 0; // between names that differ in their unit only
  std::optional<std::string> found;
  for (const auto& name : names) {
    const int distance = edit_distance(bare, without_unit(name)), whole = edit_distance(word, name);
    if (distance < best || (found && distance == best && whole < best_whole)) {
      best = distance;
      best_whole = whole;
      found = name;
    }
  }
  return found;
}

std::string suggestion(const std::string& word, const std::vector<std::string>& names, const std::string& if_none) {
  if (const auto name = nearest(word, names))
    return "Did you mean '" + *name + "'?";
  std::string list;
  for (const auto& name : names)
    list += (list.empty() ? "Allowed are '" : ", '") + name + "'";
  return list.empty() ? if_none : list;
}

} // namespace kerf::scene
