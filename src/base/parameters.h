#pragma once

/// How a module says what can be set: it lists its fields once, each with name, default (the field's initial value),
/// rule and text. The scene parser declares, checks and assigns from the same list, and `kerf params` prints it.
///
///     struct Gravity {
///       Vec3 acceleration = {0, 0, -9.81};
///       void describe(Parameters& p) { p.vector("Acceleration [m/s^2]", acceleration, "Gravity, world frame."); }
///     };

#include "base/vec.h"

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace kerf {

/// Which numbers are allowed.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool min_excluded = false, max_excluded = false;

  /// Infinities and NaN are in no range.
  bool contains(double value) const;
  /// "must be > 0", "must be >= 0 and < 0.5", "must be a number".
  std::string rule() const;
};
constexpr Range any_number{};
constexpr Range positive{0, std::numeric_limits<double>::infinity(), true, false};
constexpr Range non_negative{0, std::numeric_limits<double>::infinity(), false, false};

/// One key of a section.
struct Parameter {
  std::string name;     ///< with its unit: "Young's modulus [Pa]"
  std::string fallback; ///< default as text; empty and required means that the scene must write it
  std::string rule;     ///< what must hold, for people
  std::string text;     ///< what it does
  bool required = false;
  bool is_file = false;           ///< names a file that is read
  std::vector<std::string> words; ///< what a choice may be; empty for other keys
  /// Returns what is wrong with the value, or an empty string; does not touch the field.
  std::function<std::string(const std::string& value)> check;
  /// Checks; assigns when nothing is wrong. The struct that was described must still exist.
  std::function<std::string(const std::string& value)> assign;
};

/// The shortest decimal text that reads back as the same number: 0.1, 5e4 as 50000, 1e5, -2.5e-9.
std::string to_text(double value);

/// The keys of one section, in order.
class Parameters {
 public:
  void number(const std::string& name, double& field, const Range& range, const std::string& text);
  void integer(const std::string& name, int& field, const Range& range, const std::string& text);
  /// Yes or no; true and false are read too.
  void boolean(const std::string& name, bool& field, const std::string& text);
  void text(const std::string& name, std::string& field, const std::string& text);
  /// The name of a file that is read; a relative one starts at the file that says it.
  void file(const std::string& name, std::string& field, const std::string& text);
  /// A word out of `words`.
  void choice(const std::string& name, std::string& field, const std::vector<std::string>& words,
              const std::string& text);
  /// Three numbers: x, y, z.
  void vector(const std::string& name, Vec3& field, const std::string& text);
  /// Points separated by semicolons: x, y, z; x, y, z.
  void points(const std::string& name, Points& field, const std::string& text);
  /// Numbers separated by commas, each in range.
  void numbers(const std::string& name, std::vector<double>& field, const Range& range, const std::string& text);

  /// The last key added must be written by the scene.
  void require_last() { list_.back().required = true; }

  const std::vector<Parameter>& list() const { return list_; }

 private:
  using Fault = std::string (*)(const std::string& value);
  /// `parse` turns a text into a T or into nothing, in which case `rule` is broken. `fault` says more of such a text,
  /// or nothing: "is no number".
  template <class T, class Parse>
  Parameter& add(const std::string& name, T& field, const std::string& fallback, const std::string& rule,
                 const std::string& text, const Parse& parse, Fault fault = nullptr);

  std::vector<Parameter> list_;
};

} // namespace kerf
