#include "base/parameters.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

namespace kerf {
namespace {

std::string trimmed(const std::string& text) {
  const char* const blanks = " \t\r\n";
  const auto first = text.find_first_not_of(blanks);
  if (first == std::string::npos)
    return "";
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// "a, b," has three parts, the last one empty.
std::vector<std::string> split(const std::string& text, const std::string& separators) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (std::size_t end; (end = text.find_first_of(separators, begin)) != std::string::npos; begin = end + 1)
    parts.push_back(trimmed(text.substr(begin, end - begin)));
  parts.push_back(trimmed(text.substr(begin)));
  return parts;
}

/// The whole text must be one number.
template <class T>
std::errc read_whole(const std::string& value, T& number) {
  std::string text = trimmed(value);
  if (text.size() > 1 && text[0] == '+' && text[1] != '-')
    text.erase(0, 1);
  const char* const end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, number);
  return result.ec == std::errc() && result.ptr != end ? std::errc::invalid_argument : result.ec;
}

template <class T>
std::optional<T> parse_whole(const std::string& value) {
  T number{};
  return read_whole(value, number) == std::errc() ? std::optional(number) : std::nullopt;
}

bool has_decimal_comma(std::string text) {
  const auto comma = text.find(',');
  return comma != std::string::npos && parse_whole<double>(text.replace(comma, 1, ".")).has_value();
}

/// Why a text cannot be one number, whatever the rule; empty where it can.
template <class T>
std::string fault_of(const std::string& value) {
  T number{};
  const std::errc error = read_whole(value, number);
  if (trimmed(value).empty())
    return "is empty";
  if (error == std::errc::result_out_of_range)
    return "is beyond what numbers can be";
  if (error != std::errc())
    return std::is_integral_v<T>      ? "is not written as a whole number"
           : has_decimal_comma(value) ? "is no number, as decimals begin with a point"
                                      : "is no number";
  return std::isfinite(static_cast<double>(number)) ? "" : "is no finite number";
}

/// The same of the first number of a list that has one.
std::string fault_of_list(const std::string& value) {
  constexpr std::size_t most = 40; // letters that are repeated
  if (trimmed(value).empty())
    return "is empty";
  for (const auto& part : split(value, ",;"))
    if (const std::string fault = fault_of<double>(part); !fault.empty())
      return (part.empty() || part.size() > most ? "one of them" : "'" + part + "'") + " " + fault;
  return "";
}

std::optional<double> parse_number(const std::string& value, const Range& range) {
  const auto number = parse_whole<double>(value);
  return number && range.contains(*number) ? number : std::nullopt;
}

std::optional<bool> parse_boolean(const std::string& value) {
  const std::string word = trimmed(value);
  if (word == "yes" || word == "true")
    return true;
  if (word == "no" || word == "false")
    return false;
  return std::nullopt;
}

std::optional<std::vector<double>> parse_numbers(const std::string& value, const Range& range) {
  std::vector<double> numbers;
  if (trimmed(value).empty())
    return numbers;
  for (const auto& part : split(value, ",")) {
    const auto number = parse_number(part, range);
    if (!number)
      return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

std::optional<Vec3> parse_vector(const std::string& value) {
  const auto numbers = parse_numbers(value, any_number);
  if (!numbers || numbers->size() != 3)
    return std::nullopt;
  return Vec3((*numbers)[0], (*numbers)[1], (*numbers)[2]);
}

std::optional<Points> parse_points(const std::string& value) {
  Points points;
  if (trimmed(value).empty())
    return points;
  for (const auto& part : split(value, ";")) {
    const auto point = parse_vector(part);
    if (!point)
      return std::nullopt;
    points.push_back(*point);
  }
  return points;
}

template <class Items, class ToText>
std::string joined(const Items& items, const std::string& separator, const ToText& item_text) {
  std::string text;
  for (const auto& item : items)
    text += (text.empty() ? "" : separator) + item_text(item);
  return text;
}

std::string vector_text(const Vec3& v) { return to_text(v[0]) + ", " + to_text(v[1]) + ", " + to_text(v[2]); }

/// "> 0 and < 0.5"; empty when anything goes.
std::string bounds_text(const Range& range) {
  std::string text;
  if (std::isfinite(range.min))
    text = (range.min_excluded ? "> " : ">= ") + to_text(range.min);
  if (std::isfinite(range.max))
    text += (text.empty() ? "" : " and ") + std::string(range.max_excluded ? "< " : "<= ") + to_text(range.max);
  return text;
}

} // namespace

bool Range::contains(const double value) const {
  return std::isfinite(value) && (min_excluded ? value > min : value >= min) &&
         (max_excluded ? value < max : value <= max);
}

std::string Range::rule() const {
  const std::string bounds = bounds_text(*this);
  return bounds.empty() ? "must be a number" : "must be " + bounds;
}

std::string to_text(const double value) {
  char buffer[32];
  std::string text(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
  const auto e = text.find('e');
  if (e == std::string::npos)
    return text;
  // C writes 1e+05 where people write 1e5.
  std::string exponent = text.substr(e + 1);
  const std::string sign = exponent[0] == '-' ? "-" : "";
  exponent.erase(0, std::min(exponent.find_first_not_of("+-0"), exponent.size() - 1));
  return text.substr(0, e + 1) + sign + exponent;
}

template <class T, class Parse>
Parameter& Parameters::add(const std::string& name, T& field, const std::string& fallback, const std::string& rule,
                           const std::string& text, const Parse& parse, const Fault fault) {
  const auto wrong = [rule, fault](const std::string& value) {
    const std::string first = fault ? fault(value) : "";
    return first + (first.empty() ? "" : "; ") + rule;
  };
  Parameter parameter;
  parameter.name = name;
  parameter.fallback = fallback;
  parameter.rule = rule;
  parameter.text = text;
  parameter.check = [parse, wrong](const std::string& value) { return parse(value) ? std::string() : wrong(value); };
  parameter.assign = [parse, wrong, &field](const std::string& value) {
    const auto parsed = parse(value);
    if (!parsed)
      return wrong(value);
    field = *parsed;
    return std::string();
  };
  list_.push_back(std::move(parameter));
  return list_.back();
}

void Parameters::number(const std::string& name, double& field, const Range& range, const std::string& text) {
  add(
    name, field, to_text(field), range.rule(), text, [range](const std::string& v) { return parse_number(v, range); },
    fault_of<double>);
}

void Parameters::integer(const std::string& name, int& field, const Range& range, const std::string& text) {
  const std::string bounds = bounds_text(range);
  add(
    name, field, std::to_string(field), "must be a whole number" + (bounds.empty() ? "" : " " + bounds), text,
    [range](const std::string& v) {
      const auto number = parse_whole<int>(v);
      return number && range.contains(*number) ? number : std::nullopt;
    },
    fault_of<int>);
}

void Parameters::boolean(const std::string& name, bool& field, const std::string& text) {
  add(name, field, field ? "yes" : "no", "must be yes or no", text, parse_boolean);
}

void Parameters::text(const std::string& name, std::string& field, const std::string& text) {
  add(name, field, field, "must be a text", text, [](const std::string& v) { return std::optional(trimmed(v)); });
}

void Parameters::file(const std::string& name, std::string& field, const std::string& text) {
  this->text(name, field, text);
  list_.back().is_file = true;
}

void Parameters::choice(const std::string& name, std::string& field, const std::vector<std::string>& words,
                        const std::string& text) {
  const auto as_it_is = [](const std::string& word) { return word; };
  Parameter& parameter =
    add(name, field, field, "must be one of " + joined(words, ", ", as_it_is), text, [words](const std::string& v) {
      const auto word = trimmed(v);
      return std::find(words.begin(), words.end(), word) != words.end() ? std::optional(word) : std::nullopt;
    });
  parameter.words = words;
}

void Parameters::vector(const std::string& name, Vec3& field, const std::string& text) {
  add(name, field, vector_text(field), "must be three numbers x, y, z, all finite", text, parse_vector, fault_of_list);
}

void Parameters::points(const std::string& name, Points& field, const std::string& text) {
  add(name, field, joined(field, "; ", vector_text), "must be points x, y, z; x, y, z, all finite", text, parse_points,
      fault_of_list);
}

void Parameters::numbers(const std::string& name, std::vector<double>& field, const Range& range,
                         const std::string& text) {
  const std::string bounds = bounds_text(range);
  add(
    name, field, joined(field, ", ", to_text),
    "must be numbers separated by commas" + (bounds.empty() ? "" : ", each " + bounds), text,
    [range](const std::string& v) { return parse_numbers(v, range); }, fault_of_list);
}

} // namespace kerf
