#include "scene/expression.h"

#include "base/error.h"

#include <deal.II/base/function_parser.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>

namespace kerf::scene {

namespace {

/// deal.II prints what the parser says to std::cerr before it throws; users get our own message instead.
class SilentErrors {
 public:
  SilentErrors() : buffer_(std::cerr.rdbuf(nullptr)) {}
  ~SilentErrors() { std::cerr.rdbuf(buffer_); }
  SilentErrors(const SilentErrors&) = delete;
  SilentErrors& operator=(const SilentErrors&) = delete;

 private:
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

/// n expressions of some variables, the last of which is the time.
class Expressions {
 public:
  Expressions(const Section& section, const std::string& key, const std::string& text, const int n,
              const std::string& variables)
    : n_(n),
      has_place_(variables != "t"),
      place_(section.complaint(key, "", "Choose an expression that is finite in the whole body").complaint()),
      parser_(std::make_shared<dealii::FunctionParser<3>>(n)) {
    const std::string of = (n == 1 ? "one expression of " : "three expressions of ") + variables;
    const std::string remedy = n == 1 ? "For example: 100*sin(2*pi*t)" : "For example: 0; 0; 0.01*sin(2*pi*t)";
    const std::string separated = n == 1 ? "" : ", separated by semicolons";
    if (std::count(text.begin(), text.end(), ';') != n - 1)
      throw section.complaint(key, "must be " + of + separated, remedy);
    if (assigns(text))
      throw section.complaint(key, "must be " + of + ", which assigns nothing: '=' compares as '=='", remedy);
    try {
      const SilentErrors silent;
      parser_->initialize("x,y,z,t", text, {{"pi", std::acos(-1.0)}}, true);
      if (!has_place_)
        require_no_place(section, key, text, of, remedy);
      for (int i = 0; i < n; ++i)
        if (!std::isfinite((*this)(i, Vec3::Zero(), 0)) && !has_place_)
          throw section.complaint(key, "must be finite at t = 0", remedy);
    } catch (const dealii::ExceptionBase&) {
      throw section.complaint(key, "must be " + of + " that can be evaluated", remedy);
    }
  }

  double operator()(const int i, const Vec3& X, const double time) const {
    parser_->set_time(time);
    const double value = parser_->value(dealii::Point<3>(X[0], X[1], X[2]), static_cast<unsigned>(i));
    if (has_place_ && !std::isfinite(value)) {
      Complaint complaint = place_;
      complaint.rule = "must be finite, and is not at x, y, z, t = " + to_text(X[0]) + ", " + to_text(X[1]) + ", " +
                       to_text(X[2]) + ", " + to_text(time);
      throw ParameterError(complaint);
    }
    return value;
  }

 private:
  /// The parser knows x, y and z; an expression of time must not.
  void require_no_place(const Section& section, const std::string& key, const std::string& text, const std::string& of,
                        const std::string& remedy) const {
    dealii::FunctionParser<1> parser(static_cast<unsigned>(n_));
    try {
      parser.initialize("t", text, {{"pi", std::acos(-1.0)}});
      parser.value(dealii::Point<1>(0));
    } catch (const dealii::ExceptionBase&) {
      throw section.complaint(key, "must be " + of + " that can be evaluated", remedy);
    }
  }

  int n_;
  bool has_place_;
  Complaint place_; ///< of what is not finite only somewhere
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

std::function<double(const Vec3& X, double time)> number_of_place(const Section& section, const std::string& key,
                                                                  const std::string& expression) {
  const Expressions f(section, key, expression, 1, "x, y, z and t");
  return [f](const Vec3& X, const double t) { return f(0, X, t); };
}

} // namespace kerf::scene
