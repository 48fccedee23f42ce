#include "scene/expression.h"

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

} // namespace

std::function<Vec3(double time)> displacement_of_time(const Section& section, const std::string& expressions) {
  constexpr const char* key = "Displacement [m]";
  constexpr const char* remedy = "For example: 0; 0; 0.01*sin(2*pi*t)";
  if (std::count(expressions.begin(), expressions.end(), ';') != 2)
    throw section.complaint(key, "must be three expressions of t, separated by semicolons", remedy);
  const auto parser = std::make_shared<dealii::FunctionParser<1>>(3);
  const auto evaluate = [parser](const double time) {
    const dealii::Point<1> t(time);
    return Vec3(parser->value(t, 0), parser->value(t, 1), parser->value(t, 2));
  };
  try {
    const SilentErrors silent;
    parser->initialize("t", expressions, {{"pi", std::acos(-1.0)}});
    if (!evaluate(0).allFinite())
      throw section.complaint(key, "must be finite at t = 0", remedy);
  } catch (const dealii::ExceptionBase&) {
    throw section.complaint(key, "must be three expressions of t that can be evaluated", remedy);
  }
  return evaluate;
}

} // namespace kerf::scene
