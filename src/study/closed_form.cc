#include "study/closed_form.h"

#include "scene/composing.h"
#include "study/units.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kerf::study {

namespace {

using std::numbers::pi;

struct ClosedFormParameters {
  std::string name;
  double length = 0, thickness = 0, radius = 0, depth = 0, width = 0; ///< [m]
  double young = 0;                                                   ///< [Pa]
  double poisson = 0;                                                 ///< [1]
  double density = 0;                                                 ///< [kg/m^3]
  double weight = 0;                                                  ///< [N/m^3]
  double traction = 0;                                                ///< [N/m^2]
  int layers = 1;
  double factor = 1;
  void describe(Parameters& p);

  double shear_modulus() const { return young / (2 * (1 + poisson)); }
  /// Of a rectangular section (Cowper 1966, J. Appl. Mech. 33, p. 335).
  double shear_coefficient() const { return 10 * (1 + poisson) / (12 + 11 * poisson); }
  double plane_strain_modulus() const { return young / (1 - poisson * poisson); }
};

struct ClosedForm {
  std::string name, unit, formula;
  std::vector<std::string> reads; ///< beside Young's modulus: keys that must not be 0
  bool reads_poisson, reads_layers;
  double (*value)(const ClosedFormParameters& p);
};

/// n layers that slide on each other bend n^2 times as much, and shear as one.
const std::vector<ClosedForm>& closed_forms() {
  static const std::vector<ClosedForm> all = {
    {"pulled bar",
     "m",
     "traction L / E",
     {"Length [m]", "Traction [N/m^2]"},
     false,
     false,
     [](const ClosedFormParameters& p) { return p.traction * p.length / p.young; }},
    {"hanging bar",
     "m",
     "weight L^2 / (2 E)",
     {"Length [m]", "Weight [N/m^3]"},
     false,
     false,
     [](const ClosedFormParameters& p) { return p.weight * p.length * p.length / (2 * p.young); }},
    {"clamped beam under its weight",
     "m",
     "Timoshenko: 3 weight L^4 n^2 / (2 E t^2) + weight L^2 / (2 kappa G)",
     {"Length [m]", "Thickness [m]", "Weight [N/m^3]"},
     true,
     true,
     [](const ClosedFormParameters& p) {
       const double slender = p.layers * p.length / p.thickness, L2 = p.length * p.length;
       return 1.5 * p.weight * L2 * slender * slender / p.young +
              p.weight * L2 / (2 * p.shear_coefficient() * p.shear_modulus());
     }},
    {"clamped beam sheared at its end",
     "m",
     "Timoshenko: 4 traction L^3 n^2 / (E t^2) + traction L / (kappa G)",
     {"Length [m]", "Thickness [m]", "Traction [N/m^2]"},
     true,
     true,
     [](const ClosedFormParameters& p) {
       const double slender = p.layers * p.length / p.thickness;
       return 4 * p.traction * p.length * slender * slender / p.young +
              p.traction * p.length / (p.shear_coefficient() * p.shear_modulus());
     }},
    {"penny-shaped crack",
     "m",
     "opening in its middle, in a body without end: 8 (1 - nu^2) traction a / (pi E) (Sneddon 1946)",
     {"Radius [m]", "Traction [N/m^2]"},
     true,
     false,
     [](const ClosedFormParameters& p) { return 8 * p.traction * p.radius / (pi * p.plane_strain_modulus()); }},
    {"edge crack",
     "m",
     "opening of its mouth in plane strain, 4 traction a V(a / W) (1 - nu^2) / E, good to 1 % (Tada, Paris, Irwin: The "
     "Stress Analysis of Cracks Handbook, 2.10)",
     {"Depth [m]", "Width [m]", "Traction [N/m^2]"},
     true,
     false,
     [](const ClosedFormParameters& p) {
       const double c = std::cos(pi * p.depth / (2 * p.width));
       return 4 * p.traction * p.depth * (1.46 + 3.42 * (1 - c)) / (c * c) / p.plane_strain_modulus();
     }},
    {"tone of a bar along its axis",
     "1/s",
     "the lowest, held at one end: sqrt(E / density) / (4 L)",
     {"Length [m]", "Density [kg/m^3]"},
     false,
     false,
     [](const ClosedFormParameters& p) { return std::sqrt(p.young / p.density) / (4 * p.length); }},
    {"tone of a slender clamped beam",
     "1/s",
     "the lowest, Euler and Bernoulli: 1.8751^2 t sqrt(E / (12 density)) / (2 pi L^2 n)",
     {"Length [m]", "Thickness [m]", "Density [kg/m^3]"},
     false,
     true,
     [](const ClosedFormParameters& p) {
       constexpr double root = 1.875104068711961; // of cos z cosh z = -1
       return root * root * p.thickness / p.layers * std::sqrt(p.young / (12 * p.density)) /
              (2 * pi * p.length * p.length);
     }}};
  return all;
}

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const ClosedForm& form : closed_forms())
    all.push_back(form.name);
  return all;
}

void ClosedFormParameters::describe(Parameters& p) {
  std::string formulas = "The problem.";
  for (const ClosedForm& form : closed_forms())
    formulas += " " + form.name + ": " + form.formula + ", in " + form.unit + ".";
  name = closed_forms().front().name;
  p.choice("Name", name, names(), formulas);
  p.require_last();
  p.number("Length [m]", length, non_negative, "L, of what is free.");
  p.number("Thickness [m]", thickness, non_negative, "t, along the load.");
  p.number("Radius [m]", radius, non_negative, "a, of a crack.");
  p.number("Depth [m]", depth, non_negative, "a, of a crack from an edge.");
  p.number("Width [m]", width, non_negative, "W, of the strip that a crack goes into.");
  p.number("Young's modulus [Pa]", young, positive, "E.");
  p.require_last();
  p.number("Poisson's ratio [1]", poisson, {.min = -1, .max = 0.5, .min_excluded = true}, "nu.");
  p.number("Density [kg/m^3]", density, non_negative, "Of tones.");
  p.number("Weight [N/m^3]", weight, any_number, "Density times gravity.");
  p.number("Traction [N/m^2]", traction, any_number, "Force for each area of the end, or of a crack's faces.");
  p.integer("Layers [1]", layers, {.min = 1}, "n, into which cuts have parted the thickness.");
  p.number("Factor [1]", factor, any_number, "What the formula gives is multiplied by it: -1 for a tip that sinks.");
}

} // namespace

scene::SectionKind closed_form_grammar() {
  return {"Closed form",
          scene::Occurrence::once,
          "A reference by a formula, for all rows that have no other.",
          scene::keys_of<ClosedFormParameters>(),
          {}};
}

Reference evaluate_closed_form(const scene::Section& section, const std::string& unit) {
  const auto p = section.read<ClosedFormParameters>();
  const auto form = std::find_if(closed_forms().begin(), closed_forms().end(),
                                 [&](const ClosedForm& candidate) { return candidate.name == p.name; });
  if (!is_same_unit(form->unit, unit))
    throw section.complaint("Name", "this is a number in " + form->unit + ", the answer's unit is " + unit,
                            "Choose another form, or ask for another answer");
  const std::vector<std::pair<std::string, double>> needed = {
    {"Length [m]", p.length},     {"Thickness [m]", p.thickness},  {"Radius [m]", p.radius},
    {"Depth [m]", p.depth},       {"Width [m]", p.width},          {"Density [kg/m^3]", p.density},
    {"Weight [N/m^3]", p.weight}, {"Traction [N/m^2]", p.traction}};
  const auto require_read = [&](const std::string& key, const bool is_read, const bool is_said) {
    if (!is_read && is_said)
      throw section.complaint(key, "'" + p.name + "' does not depend on it: " + form->formula, "Leave it out");
  };
  for (const auto& [key, value] : needed) {
    const bool is_read = std::find(form->reads.begin(), form->reads.end(), key) != form->reads.end();
    if (is_read && value == 0)
      throw section.complaint(key, "'" + p.name + "' needs this number: " + form->formula, "Say how large it is");
    require_read(key, is_read, value != 0);
  }
  require_read("Poisson's ratio [1]", form->reads_poisson, p.poisson != 0);
  require_read("Layers [1]", form->reads_layers, p.layers != 1);
  if (p.name == "edge crack" && p.depth >= p.width)
    throw section.complaint("Depth [m]", "must be less than the width", "Check both");
  Reference found;
  found.value = p.factor * form->value(p);
  if (found.value == 0)
    throw section.complaint("Factor [1]", "the reference is 0, of which no relative error can be told",
                            "Choose another");
  found.source = "closed form, " + p.name + ": " + form->formula;
  return found;
}

} // namespace kerf::study
