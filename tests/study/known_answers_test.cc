// Rows of the studies in params/studies against their closed forms: the small ones.

#include "study/measure.h"
#include "tests/study/study_text.h"
#include "tests/support/checkout.h"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::study::known_answers_test {
namespace {

/// The error of a row of a study in params/studies.
double error_of(const std::string& study, const std::string& row) {
  const output::TemporaryFolder folder;
  const Plan plan = make_plan(scene::read_scene_text(support::checkout() + "/params/studies/" + study + ".prm", {}));
  for (const PlannedRow& planned : plan.rows)
    if (planned.name == row) {
      const output::StudyRow found =
        measure(plan, planned, folder / "out", output::sample_info(), output::Earlier::replace);
      EXPECT_EQ(found.outcome, "completed") << row;
      return found.error;
    }
  ADD_FAILURE() << study << " has no row " << row;
  return std::nan("");
}

TEST(KnownAnswers, OfABar) {
  EXPECT_NEAR(error_of("bar_backends", "fem-static, 5"), -0.0018, 0.001);
  EXPECT_NEAR(error_of("bar_backends", "pba-static, 5"), -0.127, 0.03);
  EXPECT_NEAR(error_of("bar_backends", "mass-spring-static, 5"), -0.153, 0.03);
  EXPECT_NEAR(error_of("bar_backends", "lattice, 5"), -0.118, 0.03);
}

TEST(KnownAnswers, OfASwingingBar) {
  EXPECT_NEAR(error_of("bar_dynamics", "fem-Newmark, 3"), 0, 0.001);
  EXPECT_NEAR(error_of("bar_dynamics", "fem-symplectic, 3"), 0, 0.001);
  EXPECT_NEAR(error_of("bar_dynamics", "fem-implicit-Euler, 3"), -0.0185, 0.002);
  EXPECT_NEAR(error_of("bar_dynamics", "lattice, 3"), 0.047, 0.01);
}

TEST(KnownAnswers, OfASplitBeam) {
  EXPECT_NEAR(error_of("split_beam", "fem, 1-of-6"), 0, 0.003);
  EXPECT_NEAR(error_of("split_beam", "fem, 2-of-6"), 0, 0.003);
  EXPECT_NEAR(error_of("split_beam", "fem, 3-of-6"), 0, 0.003);
  EXPECT_NEAR(error_of("split_beam", "pba-extended, 2-of-6"), -0.23, 0.05);
}

TEST(KnownAnswers, OfCooksMembrane) {
  EXPECT_NEAR(error_of("cook", "fem, 24"), -0.005, 0.001);
  EXPECT_NEAR(error_of("cook", "mass-spring, 24"), -0.007, 0.002);
}

/// Criteria that leave a bond around the front of a cut hold it closer than those that part what cannot see each other.
TEST(KnownAnswers, OfAPennyShapedCut) {
  EXPECT_NEAR(error_of("penny", "fem, 12"), -0.023, 0.01);
  EXPECT_NEAR(error_of("penny", "pba-visibility, 12"), -0.013, 0.03);
  EXPECT_NEAR(error_of("penny", "pba-extended, 12"), -0.044, 0.03);
  EXPECT_NEAR(error_of("penny", "pba-diffraction, 12"), -0.18, 0.04);
}

/// Which the lag of fronts was not measured on.
TEST(KnownAnswers, OfAnEdgeCrack) {
  EXPECT_NEAR(error_of("edge_crack", "fem, 10"), 0.005, 0.005);
  EXPECT_NEAR(error_of("edge_crack", "pba-visibility, 20"), 0, 0.02);
  EXPECT_NEAR(error_of("edge_crack", "pba-extended, 20"), 0, 0.02);
}

} // namespace
} // namespace kerf::study::known_answers_test
