// References by name: formulas against numbers of the literature, what they need, and what they do not read.

#include "study/closed_form.h"

#include "study/grammar.h"
#include "tests/study/study_text.h"

#include <gtest/gtest.h>

namespace kerf::study::closed_form_test {
namespace {

Reference evaluated(const std::string& name, const std::string& keys, const std::string& unit = "m") {
  const std::string text = "subsection Closed form\n  set Name = " + name + "\n" + keys + "end\n";
  const scene::Section root = scene::parse_scene(scene::scan_scene_text(text, "study.prm"), {closed_form_grammar()});
  return evaluate_closed_form(root.require("Closed form"), unit);
}

void expect_refused(const std::string& name, const std::string& keys, const std::string& words) {
  try {
    evaluated(name, keys);
    ADD_FAILURE() << name << " was evaluated with " << keys;
  } catch (const ParameterError& error) {
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    EXPECT_GT(error.complaint().line, 0);
  }
}

const std::string steel = "  set Young's modulus [Pa] = 2e11\n";
const std::string beam = "  set Young's modulus [Pa] = 1e5\n  set Length [m] = 0.9\n  set Thickness [m] = 0.2\n";

TEST(ClosedForm, Bars) {
  EXPECT_DOUBLE_EQ(evaluated("pulled bar", steel + "  set Length [m] = 3\n  set Traction [N/m^2] = 1e8\n").value,
                   1.5e-3);
  EXPECT_DOUBLE_EQ(evaluated("hanging bar", steel + "  set Length [m] = 100\n  set Weight [N/m^3] = 8e4\n").value,
                   2e-3);
  // Sound runs through steel at 5,000 m/s: once there and back twice a period.
  EXPECT_DOUBLE_EQ(
    evaluated("tone of a bar along its axis", steel + "  set Length [m] = 1\n  set Density [kg/m^3] = 8000\n", "1/s")
      .value,
    1250);
}

/// The frequencies of modes are in Hz.
TEST(ClosedForm, TonesAreInHertzToo) {
  const std::string bar = steel + "  set Length [m] = 1\n  set Density [kg/m^3] = 8000\n";
  EXPECT_DOUBLE_EQ(evaluated("tone of a bar along its axis", bar, "Hz").value, 1250);
}

/// The bar of params/compare, whose bending and shear were worked out by hand: .0246015 + .000972, with nu = 1/4
/// .0011947.
TEST(ClosedForm, BeamsAndTheirLayers) {
  const auto sinks = [](const std::string& more) {
    return evaluated("clamped beam under its weight", beam + "  set Weight [N/m^3] = 100\n" + more).value;
  };
  constexpr double bending = 1.5 * 100 * 0.6561 / (1e5 * 0.04), shear = 0.000972;
  EXPECT_NEAR(sinks(""), bending + shear, 1e-12);
  EXPECT_NEAR(sinks("  set Poisson's ratio [1] = 0.25\n"), bending + 0.00119475, 1e-8);
  EXPECT_NEAR(sinks("  set Layers [1] = 3\n"), 9 * bending + shear, 1e-12);
  EXPECT_NEAR(sinks("  set Factor [1] = -1\n"), -(bending + shear), 1e-12);
  // P L^3 / (3 E I) + P L / (kappa G A), with P = 10 N, I = b t^3 / 12, b = 1 m.
  EXPECT_NEAR(evaluated("clamped beam sheared at its end", beam + "  set Traction [N/m^2] = 50\n").value,
              10 * 0.729 / (3 * 1e5 * 0.008 / 12) + 10 * 0.9 / (5. / 6 * 5e4 * 0.2), 1e-12);
  // 3.516 / (2 pi L^2) sqrt(E I / (rho A)), as handbooks have it.
  EXPECT_NEAR(evaluated("tone of a slender clamped beam", beam + "  set Density [kg/m^3] = 1000\n", "1/s").value,
              3.516 / (2 * 3.14159265 * 0.81) * std::sqrt(1e5 * 0.04 / 12000), 1e-4);
}

TEST(ClosedForm, Cracks) {
  const std::string gel =
    "  set Young's modulus [Pa] = 1e5\n  set Poisson's ratio [1] = 0.25\n  set Traction [N/m^2] = 100\n";
  EXPECT_NEAR(evaluated("penny-shaped crack", gel + "  set Radius [m] = 0.05\n").value, 1.19366e-4, 1e-9);
  // Of a half space 4 x 1.46 sigma a / E' = 5.84; at half the width V = 4.92 (Tada's curve).
  EXPECT_NEAR(evaluated("edge crack", gel + "  set Depth [m] = 0.01\n  set Width [m] = 1e3\n").value,
              5.84 * 100 * 0.01 * 0.9375 / 1e5, 1e-9);
  EXPECT_NEAR(evaluated("edge crack", gel + "  set Depth [m] = 0.1\n  set Width [m] = 0.2\n").value,
              4 * 4.923 * 100 * 0.1 * 0.9375 / 1e5, 1e-6);
  expect_refused("edge crack", gel + "  set Depth [m] = 0.3\n  set Width [m] = 0.2\n", "less than the width");
}

TEST(ClosedForm, SaysWhatItNeedsAndWhatItDoesNotRead) {
  expect_refused("pulled bar", steel + "  set Length [m] = 1\n", "needs this number: traction L / E");
  expect_refused("pulled bar", steel + "  set Length [m] = 1\n  set Traction [N/m^2] = 1\n  set Radius [m] = 1\n",
                 "does not depend on it");
  expect_refused("pulled bar",
                 steel + "  set Length [m] = 1\n  set Traction [N/m^2] = 1\n  set Poisson's ratio [1] = 0.3\n",
                 "does not depend on it");
  expect_refused("hanging bar", steel + "  set Length [m] = 1\n  set Weight [N/m^3] = 1\n  set Layers [1] = 2\n",
                 "does not depend on it");
  expect_refused("hanging bar", steel + "  set Length [m] = 1\n  set Weight [N/m^3] = 1\n  set Factor [1] = 0\n",
                 "is 0");
  expect_refused("tone of a bar along its axis", steel + "  set Length [m] = 1\n  set Density [kg/m^3] = 1\n",
                 "in 1/s, the answer's unit is m");
  expect_refused("bent bar", steel, "must be one of pulled bar, hanging bar");
}

TEST(ClosedForm, IsTheReferenceOfAStudy) {
  const CubeStudy study;
  const std::string head =
    "subsection Study\n  set Scene = scene.prm\n  set Answer = largest displacement\n"
    "  set Unit = m\nend\n";
  const std::string form =
    "subsection Closed form\n  set Name = hanging bar\n  set Length [m] = 2\n"
    "  set Young's modulus [Pa] = 1e4\n  set Weight [N/m^3] = 1e3\nend\n";
  const Plan plan = study.plan(head + form + CubeStudy::variant("fem", ""));
  EXPECT_DOUBLE_EQ(plan.rows[0].reference.value, 0.2);
  EXPECT_EQ(plan.rows[0].reference.source, "closed form, hanging bar: weight L^2 / (2 E)");
  const std::string file = "subsection Reference file\n  set File = a.csv\n  set Column = a\nend\n";
  EXPECT_THROW(study.plan(head + form + file + CubeStudy::variant("fem", "")), ParameterError) << "two";
}

} // namespace
} // namespace kerf::study::closed_form_test
