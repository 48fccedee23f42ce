#include "study/ranges.h"

#include "study/grammar.h"

#include <cmath>
#include <iomanip>
#include <sstream>

namespace kerf::study {

namespace {

using scene::Section;

void require_range(const RangeParameters& p, const Section& change) {
  if (p.range.size() != 2)
    throw change.complaint("Range", "must be two numbers, the first and the last", "Write 'set Range = 0.1, 0.4'");
  if (p.number == 0 || (p.number > 1) == (p.range[0] == p.range[1]))
    throw change.complaint("Number [1]", "the range is empty, or has one number several times",
                           "Write how many numbers it has: 1 where both ends are the same, else at least 2");
  if (p.spacing == "equal ratios" && !(p.range[0] * p.range[1] > 0))
    throw change.complaint("Range", "numbers with equal ratios between them have one sign, and none is 0",
                           "Write ends of one sign, or 'set Spacing = equal steps'");
}

/// Without what rounding adds: 0.03, not 0.030000000000000002.
double rounded(const double value) {
  std::ostringstream text;
  text << std::setprecision(12) << value;
  return std::stod(text.str());
}

/// The ends exactly.
double number_at(const RangeParameters& p, const int i) {
  const double first = p.range[0], last = p.range[1], part = p.number > 1 ? double(i) / (p.number - 1) : 0;
  if (i == 0 || i == p.number - 1)
    return i == 0 ? first : last;
  return rounded(p.spacing == "equal steps" ? first + (last - first) * part : first * std::pow(last / first, part));
}

std::vector<std::string> values_of(const RangeParameters& p, const Section& change) {
  if (!p.values.empty())
    return split(p.values);
  require_range(p, change);
  std::vector<std::string> values;
  for (int i = 0; i < p.number; ++i)
    values.push_back(to_text(number_at(p, i)));
  return values;
}

void require_sense(const RangeParameters& p, const Section& change) {
  for (const char* key : {"Values", "Range", "Number [1]", "Spacing"})
    if (p.key.empty() && change.writes(key))
      throw change.complaint(key, "there is no key that takes them", "Write 'set Key = Section/Key'");
  if (!p.key.empty() && p.values.empty() && p.range.empty())
    throw change.complaint("Key", "it takes no values: the range is empty",
                           "Write 'set Values = ... | ...' or 'set Range = ...'");
  if (!p.values.empty() && (!p.range.empty() || change.writes("Number [1]")))
    throw change.complaint("Range", "there are values too", "Leave out one of them");
}

/// A name that is a part of a folder's: a number may have a '+'.
std::string name_of(const std::string& value, const Section& change) {
  if (value.empty() || value.find_first_not_of(scene::title_characters()) != std::string::npos)
    throw change.complaint(
      "Values", "'" + value + "' cannot be the name of a case, which is letters, digits, '_', '-', '.' and blanks",
      "Write it as a section 'Case NAME' with 'set Set = ...'");
  return value;
}

} // namespace

std::vector<Choice> read_values(const Section& change) {
  const auto p = change.read<RangeParameters>();
  require_sense(p, change);
  std::vector<Choice> choices;
  if (p.key.empty())
    return choices;
  for (const std::string& value : values_of(p, change)) {
    Choice choice{name_of(value, change), &change, p.values.empty() ? "Range" : "Values", {}};
    for (const std::string& key : split(p.key))
      choice.sets.push_back(key + "=" + value);
    choices.push_back(std::move(choice));
  }
  return choices;
}

} // namespace kerf::study
