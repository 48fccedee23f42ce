// References that deal.II finds for a study: the section Truth.

#include "study/truth.h"

#include "study/grammar.h"
#include "tests/study/study_text.h"
#include "tests/support/checkout.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

namespace kerf::study::truth_test {
namespace {

const std::string corners = "  set Corners [m] = 0, 0, 0; 10, 0, 0; 10, 1, 0; 0, 1, 0\n";
const std::string rest =
  "  set Cells [1] = 10, 2\n"
  "  set Young's modulus [Pa] = 1e5\n"
  "  set Force [N/m^3] = 0, -1, 0\n"
  "  set Point [m] = 10, 0.25, 0\n"
  "  set Axis = y\n"
  "  set Adaptations [1] = 2\n"
  "  subsection Held left\n    set Upper [m] = 0.01, 9, 9\n  end\n";
const std::string crack =
  "  subsection Crack all\n    set Point [m] = 0, 0.5, 0\n    set Normal [1] = 0, 1, 0\n  end\n";

std::string truth(const std::string& body) { return "subsection Truth\n" + body + "end\n"; }

Reference find(const std::string& text, const std::filesystem::path& cache = {}, const TruthAsked& asked = {}) {
  const scene::Section root = scene::parse_scene(scene::scan_scene_text(text, "study.prm"), {truth_grammar()});
  const Reference found = find_truth(root.require("Truth"), asked, cache);
  root.require_all_read();
  return found;
}

/// w L^4 / (8 E I) + shear of a cantilever of nu = 0 under its weight; cut in two, it is bent four times as far.
TEST(Truth, OfABeamAndOfItsHalves) {
  const double bending = 1e4 / (8 * 1e5 / 12), shear = 100 / (2 * 5.0 / 6 * 5e4);
  EXPECT_NEAR(find(truth(corners + rest)).value, -(bending + shear), 2e-3 * bending);
  EXPECT_NEAR(find(truth(corners + rest + crack)).value, -(4 * bending + shear), 8e-3 * bending);
}

TEST(Truth, OfABlock) {
  const std::string block =
    "  set Corners [m] = 0, 0, 0; 1, 0, 0; 1, 2, 0; 0, 2, 0\n  set Heights [m] = 0, 3\n"
    "  set Cells [1] = 1, 2, 3\n  set Young's modulus [Pa] = 100\n"
    "  set Poisson's ratio [1] = 0.25\n  set Point [m] = 1, 1, 3\n  set Adaptations [1] = 0\n"
    "  subsection Held x\n    set Upper [m] = 0.01, 9, 9\n    set Hold = x\n  end\n"
    "  subsection Held y\n    set Upper [m] = 9, 0.01, 9\n    set Hold = y\n  end\n"
    "  subsection Held z\n    set Upper [m] = 9, 9, 0.01\n    set Hold = z\n  end\n"
    "  subsection Pulled top\n    set Lower [m] = -9, -9, 2.99\n    set Traction [N/m^2] = 0, 0, 5\n"
    "  end\n";
  EXPECT_NEAR(find(truth(block)).value, 3 * 5.0 / 100, 1e-12);
  EXPECT_NEAR(find(truth(block + "  set Axis = x\n")).value, -0.25 * 5.0 / 100, 1e-12);
  EXPECT_NEAR(find(truth(block + "  set Minus point [m] = 0, 1, 1\n")).value, 2 * 5.0 / 100, 1e-12);
}

/// Drawn by 5 Pa along z: u = 5 / 100 (-x / 4, -y / 4, z); half of what the traction works is its energy.
TEST(Truth, KnowsPointsEnergyAndFrequency) {
  const std::string block =
    "  set Corners [m] = 0, 0, 0; 1, 0, 0; 1, 2, 0; 0, 2, 0\n  set Heights [m] = 0, 3\n"
    "  set Cells [1] = 1, 2, 3\n  set Young's modulus [Pa] = 100\n  set Density [kg/m^3] = 4\n"
    "  set Poisson's ratio [1] = 0.25\n  set Point [m] = 1, 1, 3\n  set Adaptations [1] = 0\n"
    "  set Degree [1] = 2\n  set Tolerance [1] = 0.05\n"
    "  set Axes of the scene = yxz\n  set Energy factor [1] = 10\n"
    "  subsection Held x\n    set Upper [m] = 0.01, 9, 9\n    set Hold = x\n  end\n"
    "  subsection Held y\n    set Upper [m] = 9, 0.01, 9\n    set Hold = y\n  end\n"
    "  subsection Held z\n    set Upper [m] = 9, 9, 0.01\n    set Hold = z\n  end\n"
    "  subsection Pulled top\n    set Lower [m] = -9, -9, 2.99\n    set Traction [N/m^2] = 0, 0, 5\n  end\n";
  const output::TemporaryFolder cache;
  for (int i = 0; i < 2; ++i) { // the second time from the cache
    const Reference found = find(truth(block), cache / "references", {{Vec3(2, 1, 3), Vec3(1, 0.5, 1)}, true});
    ASSERT_EQ(found.displacements.size(), 2u);
    EXPECT_LT((found.displacements[0] - Vec3(-0.025, -0.0125, 0.15)).norm(), 1e-12);
    EXPECT_LT((found.displacements[1] - Vec3(-0.0125, -0.00625, 0.05)).norm(), 1e-12);
    EXPECT_NEAR(found.energy, 10 * 0.5 * 25.0 / 100 * 6, 1e-10);
    EXPECT_NEAR(found.frequency / (5 / 12.0), 1, 0.03) << "about sqrt(E / rho) / (4 L), contraction's inertia less";
  }
  EXPECT_TRUE(std::isnan(find(truth(block)).frequency)) << "not asked for";
  EXPECT_THROW(find(truth(block), {}, {{Vec3(1, 2, 3)}, false}), ParameterError) << "outside, in the scene's axes";
}

/// In time: a bar that suddenly hangs goes twice as far as it would rest, rho g L^2 / E.
TEST(Truth, OfAMotion) {
  const std::string bar =
    "  set Corners [m] = 0, 0, 0; 1, 0, 0; 1, 0.1, 0; 0, 0.1, 0\n  set Cells [1] = 8, 1\n"
    "  set Young's modulus [Pa] = 1000\n  set Density [kg/m^3] = 1000\n  set Force [N/m^3] = 1, 0, 0\n"
    "  set Point [m] = 1, 0.05, 0\n  set Axis = x\n  set Adaptations [1] = 0\n  set Tolerance [1] = 5e-3\n"
    "  set End time [s] = 2.5\n  set Take = maximum\n"
    "  subsection Held wall\n    set Upper [m] = 0.001, 9, 9\n    set Hold = x\n  end\n"
    "  subsection Held floor\n    set Upper [m] = 9, 0.001, 9\n    set Hold = y\n  end\n";
  const Reference found = find(truth(bar + "  set Time step [s] = 0.01\n"));
  EXPECT_NEAR(found.value, 1e-3, 2e-6);
  EXPECT_NE(found.source.find("time step"), std::string::npos) << found.source;
  EXPECT_THROW(find(truth(bar)), ParameterError) << "an end without a step";
}

/// A penny in a wide block opens as Sneddon's in a body without end: 8 (1 - nu^2) sigma a / (pi E).
TEST(Truth, OfAPenny) {
  const std::string penny =
    "  set Shape = disc in a square\n  set Half width [m] = 8\n  set Radius [m] = 1\n  set Heights [m] = -8, 8\n"
    "  set Cells [1] = 2, 1, 1\n  set Young's modulus [Pa] = 1\n  set Poisson's ratio [1] = 0.3\n"
    "  set Point [m] = 0, 0, 1e-6\n  set Minus point [m] = 0, 0, -1e-6\n  set Degree [1] = 2\n  set Adaptations [1] = "
    "0\n"
    "  set Tolerance [1] = 0.5\n"
    "  subsection Held base\n    set Upper [m] = 9, 9, -7.99\n    set Hold = z\n  end\n"
    "  subsection Pinned a\n    set Point [m] = 0, 8, -8\n    set Hold = x\n  end\n"
    "  subsection Pinned b\n    set Point [m] = 0, -8, -8\n    set Hold = xy\n  end\n"
    "  subsection Pulled top\n    set Lower [m] = -9, -9, 7.99\n    set Traction [N/m^2] = 0, 0, 1\n  end\n"
    "  subsection Crack penny\n    set Point [m] = 0, 0, 0\n    set Radius [m] = 1\n  end\n";
  EXPECT_NEAR(find(truth(penny)).value / (8 * 0.91 / M_PI), 1, 0.05);
  EXPECT_THROW(find(truth(penny + "  set Heights [m] = 1, 8\n")), ParameterError);
  std::string thin = penny;
  thin.replace(thin.find("Cells [1] = 2"), 13, "Cells [1] = 29");
  EXPECT_THROW(find(truth(thin)), ParameterError) << "cells that cannot be curved";
}

/// A bar with a round section under tension; its volume, that of a cylinder, comes in by its weight.
TEST(Truth, OfACylinder) {
  const std::string bar =
    "  set Shape = disc\n  set Radius [m] = 0.5\n  set Heights [m] = 0, 2\n  set Cells [1] = 1, 1\n"
    "  set Young's modulus [Pa] = 100\n  set Degree [1] = 3\n  set Adaptations [1] = 0\n  set Tolerance [1] = 1e-6\n"
    "  subsection Held base\n    set Upper [m] = 9, 9, 0.01\n    set Hold = z\n  end\n"
    "  subsection Pinned a\n    set Point [m] = 0, 0, 0\n    set Hold = xy\n  end\n"
    "  subsection Pinned b\n    set Point [m] = 0.25, 0, 0\n    set Hold = y\n  end\n"
    "  set Point [m] = 0, 0, 2\n";
  const Reference pulled = find(truth(bar + "  subsection Pulled top\n    set Lower [m] = -9, -9, 1.99\n"
                                            "    set Traction [N/m^2] = 0, 0, 5\n  end\n"));
  EXPECT_NEAR(pulled.value, 2 * 5.0 / 100, 1e-12);
  EXPECT_NEAR(pulled.energy, 0.5 * 25.0 / 100 * 2 * M_PI / 4, 1e-5) << "arcs of degree 3";
  EXPECT_NEAR(find(truth(bar + "  set Force [N/m^3] = 0, 0, 3\n")).value, 3 * 4.0 / 200, 1e-12);
  EXPECT_THROW(find(truth(bar)), ParameterError) << "nothing pulls";
  EXPECT_THROW(find(truth(bar + "  set Force [N/m^3] = 0, 0, 3\n  set Axis = x\n")), ParameterError) << "0";
}

TEST(Truth, IsKeptByAHashOfItsSection) {
  const output::TemporaryFolder cache;
  const std::string text = truth(corners + rest);
  const Reference found = find(text, cache / "references");
  std::filesystem::path file;
  for (const auto& entry : std::filesystem::directory_iterator(cache / "references")) {
    EXPECT_TRUE(file.empty()) << "one file";
    file = entry.path();
  }
  EXPECT_EQ(find(text, cache / "references").value, found.value) << "bit by bit";
  EXPECT_EQ(find(text, cache / "references").source, found.source);
  std::ofstream(file) << "42 0 0\nelsewhere\nend\n";
  EXPECT_EQ(find(text, cache / "references").value, 42) << "not solved again";
  EXPECT_NE(find(truth(corners + rest + crack), cache / "references").value, 42) << "another problem";
  std::ofstream(file) << "42 0 0\nelse";
  EXPECT_EQ(find(text, cache / "references").value, found.value) << "half a file does not count";
}

TEST(Truth, RefusesWhatCannotBe) {
  EXPECT_THROW(find(truth("  set Corners [m] = 0, 0, 0; 1, 0, 0; 0, 1, 0; 1, 1, 0\n" + rest)), ParameterError);
  EXPECT_THROW(find(truth("  set Corners [m] = 0, 0, 0; 1, 0, 0; 0, 1, 0\n" + rest)), ParameterError);
  EXPECT_THROW(find(truth(corners + "  set Heights [m] = 2, 1\n" + rest)), ParameterError);
  EXPECT_THROW(find(truth(corners + rest +
                          "  subsection Crack off\n    set Point [m] = 0, 0.3, 0\n"
                          "    set Normal [1] = 0, 1, 0\n  end\n")),
               ParameterError);
  EXPECT_THROW(find(truth(corners + rest + "  subsection Held far\n    set Lower [m] = 99, 99, 99\n  end\n")),
               ParameterError);
  EXPECT_THROW(find(truth(corners + rest + "  set Minus point [m] = 0, 9, 0\n")), ParameterError);
  EXPECT_THROW(find(truth(corners + rest + "  set Tolerance [1] = 1e-12\n")), NumericalError);
}

TEST(Truth, IsTheReferenceOfRowsWithoutAnother) {
  const CubeStudy study;
  const std::string head = "subsection Study\n  set Scene = scene.prm\n  set Answer = largest displacement\n";
  const std::string fem = CubeStudy::variant("fem", "") +
                          "subsection Variant other\n  set Reference = 7\n  set Reference source = a book\nend\n";
  const Plan plan = study.plan(head + "  set Unit = m\nend\n" + truth(corners + rest) + fem);
  EXPECT_NEAR(plan.rows[0].reference.value, -0.1512, 5e-4);
  EXPECT_TRUE(plan.rows[0].reference.source.starts_with("deal.II, degree 4")) << plan.rows[0].reference.source;
  EXPECT_EQ(plan.rows[1].reference.value, 7);
  EXPECT_THROW(study.plan(head + "  set Unit = J\nend\n" + truth(corners + rest) + fem), ParameterError);
  EXPECT_THROW(study.plan(CubeStudy::head() + truth(corners + rest) + fem), ParameterError) << "two references";
}

/// Of the tables' 23.96774, at a hundredth of the length and 1e-4 of the strain.
TEST(Truth, OfTheStudyOfCooksMembrane) {
  const Plan plan = make_plan(scene::read_scene_text(support::checkout() + "/params/studies/cook.prm", {}));
  for (const PlannedRow& row : plan.rows) // the lattice's Poisson's ratio is 0
    EXPECT_NEAR(row.reference.value, row.name.starts_with("lattice") ? 24.8517e-6 : 23.96774e-6, 1e-11) << row.name;
}

} // namespace
} // namespace kerf::study::truth_test
