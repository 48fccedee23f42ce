#include "scene/expression.h"

#include "base/error.h"

#include <deal.II/base/function_parser.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iostream>
#include <memory>
#include <sstream>
#include <vector>

namespace kerf::scene {

namespace {

/// deal.II prints what the parser says to std::cerr before it throws; users get it within our own message.
class WordsOfParser {
 public:
  WordsOfParser() : buffer_(std::cerr.rdbuf(said_.rdbuf())) {}
  ~WordsOfParser() { std::cerr.rdbuf(buffer_); }
  WordsOfParser(const WordsOfParser&) = delete;
  WordsOfParser& operator=(const WordsOfParser&) = delete;

  /// ": " and what is wrong; empty where it has not said.
  std::string what() const {
    const std::string said = said_.str(), before = "Message:  <";
    const auto begin = said.find(before), end = said.find(">\n", begin);
    if (begin == std::string::npos || end == std::string::npos)
      return "";
    std::string words = said.substr(begin + before.size(), end - begin - before.size());
    while (!words.empty() && words.back() == '.')
      words.pop_back();
    return ": " + words;
  }

 private:
  std::ostringstream said_;
  std::streambuf* buffer_;
};

/// Whether there is a '=' that is no part of a comparison.
bool assigns(const std::string& text) {
  for (auto at = text.find('='); at != std::string::npos; at = text.find('=', at + 1)) {
    if (at + 1 < text.size() && text[at + 1] == '=') {
      ++at;
      continue;
    }
    if (at == 0 || std::string("<>!").find(text[at - 1]) == std::string::npos)
      return true;
  }
  return false;
}

/// Whether a comma stands elsewhere than between the arguments of a function: the parser takes what is behind the last.
bool has_loose_comma(const std::string& text) {
  std::vector<bool> is_call; // of the open parentheses
  char before = ' ';
  for (const char c : text) {
    if (c == '(')
      is_call.push_back(std::isalnum(static_cast<unsigned char>(before)) != 0 || before == '_');
    else if (c == ')' && !is_call.empty())
      is_call.pop_back();
    else if (c == ',' && (is_call.empty() || !is_call.back()))
      return true;
    before = c == ' ' ? before : c;
  }
  return false;
}

/// n expressions of some variables: "t", "x, y, z and t", or "x, y, z".
class Expressions {
 public:
  Expressions(const Section& section, const std::string& key, const std::string& text, const int n,
              const std::string& variables)
    : n_(n),
      has_place_(variables != "t"),
      has_time_(variables != "x, y, z"),
      place_(section
               .complaint(key, "",
                          variables == "t"
                            ? "Choose an expression that is finite at all times of the run. " + example()
                            : "Choose an expression that is finite in the whole body")
               .complaint()),
      parser_(std::make_shared<dealii::FunctionParser<3>>(n)) {
    const std::string of = (n == 1 ? "one expression of " : "three expressions of ") + variables;
    const std::string remedy = example();
    const std::string separated = n == 1 ? "" : ", separated by semicolons";
    if (std::count(text.begin(), text.end(), ';') != n - 1)
      throw section.complaint(key, "must be " + of + separated, remedy);
    if (has_loose_comma(text))
      throw section.complaint(key, "must be " + of + separated + ": a comma separates arguments of a function only",
                              "Write decimals with a point, as 0.5, and semicolons between expressions");
    if (assigns(text))
      throw section.complaint(key, "must be " + of + ", which assigns nothing: '=' compares as '=='", remedy);
    const WordsOfParser words;
    try {
      parser_->initialize("x,y,z,t", text, {{"pi", std::acos(-1.0)}}, true);
      if (!has_place_)
        require_no_others<1>("t", text);
      if (!has_time_)
        require_no_others<3>("x,y,z", text);
      for (int i = 0; i < n; ++i) // in a body, the origin may be outside
        has_place_ ? parser_->value(dealii::Point<3>(), static_cast<unsigned>(i)) : (*this)(i, Vec3::Zero(), 0);
    } catch (const dealii::ExceptionBase&) {
      throw section.complaint(key, "must be " + of + " that can be evaluated" + words.what(), remedy);
    }
  }

  double operator()(const int i, const Vec3& X, const double time) const {
    parser_->set_time(time);
    const double value = parser_->value(dealii::Point<3>(X[0], X[1], X[2]), static_cast<unsigned>(i));
    if (!std::isfinite(value)) {
      Complaint complaint = place_;
      complaint.rule = has_place_ ? "must be finite, and is not at x, y, z, t = " + to_text(X[0]) + ", " +
                                      to_text(X[1]) + ", " + to_text(X[2]) + ", " + to_text(time)
                                  : "must be finite, and is not at t = " + to_text(time);
      throw ParameterError(complaint);
    }
    return value;
  }

 private:
  std::string example() const {
    const std::string one = has_time_ ? "sin(2*pi*t)" : "sin(2*pi*x)";
    return n_ == 1 ? "For example: 100*" + one : "For example: 0; 0; 0.01*" + one;
  }
  /// The parser knows x, y, z and t; not every expression may. Throws its exceptions.
  template <int n_variables>
  void require_no_others(const std::string& variables, const std::string& text) const {
    dealii::FunctionParser<n_variables> parser(static_cast<unsigned>(n_));
    parser.initialize(variables, text, {{"pi", std::acos(-1.0)}});
    parser.value(dealii::Point<n_variables>());
  }

  int n_;
  bool has_place_, has_time_;
  Complaint place_; ///< of what is not finite somewhere
  std::shared_ptr<dealii::FunctionParser<3>> parser_;
};

} // namespace

std::function<Vec3(double time)> vector_of_time(const Section& section, const std::string& key,
                                                const std::string& expressions) {
  const Expressions f(section, key, expressions, 3, "t");
  return [f](const double t) { return Vec3(f(0, Vec3::Zero(), t), f(1, Vec3::Zero(), t), f(2, Vec3::Zero(), t)); };
}

std::function<Vec3(const Vec3& X, double time)> vector_of_place(const Section& section, const std::string& key,
                                                                const std::string& expressions) {
  const Expressions f(section, key, expressions, 3, "x, y, z and t");
  return [f](const Vec3& X, const double t) { return Vec3(f(0, X, t), f(1, X, t), f(2, X, t)); };
}

std::function<Vec3(const Vec3& X, double time)> vector_of_rest(const Section& section, const std::string& key,
                                                               const std::string& expressions) {
  const Expressions f(section, key, expressions, 3, "x, y, z");
  return [f](const Vec3& X, const double t) { return Vec3(f(0, X, t), f(1, X, t), f(2, X, t)); };
}

std::function<double(const Vec3& X, double time)> number_of_place(const Section& section, const std::string& key,
                                                                  const std::string& expression) {
  const Expressions f(section, key, expression, 1, "x, y, z and t");
  return [f](const Vec3& X, const double t) { return f(0, X, t); };
}

} // namespace kerf::scene
