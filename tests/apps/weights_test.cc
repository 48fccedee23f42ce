// `kerf weights`: images, arrays and the table of jumps.

#include "output/h5_array.h"
#include "tests/apps/program.h"
#include "tests/support/checkout.h"

namespace kerf::apps::weights_test {
namespace {

using WeightsCommand = Program;
namespace h5 = output::h5;

/// The thesis' figure with few pixels and parts.
const Words small = {"weights",  support::checkout() + "/params/thesis/fig_2_9.prm",
                     "--output", "out",
                     "--set",    "Weights/Pixels [1]=40",
                     "--set",    "Weights/Parts [1]=40"};
const std::vector<std::string> criteria = {"visibility", "diffraction", "transparency", "extended_visibility"};

TEST_F(WeightsCommand, WritesAnImageAndArraysForEachCriterionAndCut) {
  const Result result = kerf(small);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto root = h5::open_read_only(folder / "out/weights.h5");
  for (const std::string& criterion : criteria) {
    const auto array = [&](const std::string& kind, const std::string& cut) {
      return h5::read_vector<double>(root, "/" + kind + "/" + cut + "_" + criterion);
    };
    for (const std::string cut : {"one_front", "two_fronts"}) {
      const std::string png = read_text(folder / "out" / (cut + "_" + criterion + ".png"));
      EXPECT_TRUE(png.starts_with("\x89PNG")) << cut << criterion;
      const auto field = array("field", cut);
      ASSERT_EQ(field.size(), 1600u);
      EXPECT_EQ(*std::min_element(field.begin(), field.end()), 0);
      EXPECT_NEAR(field[20 * 40 + 20], 1, 0.01) << "at the phyxel";
      const auto history = array("history", cut);
      ASSERT_EQ(history.size(), 41u);
      EXPECT_GT(history.front(), 0);
      EXPECT_EQ(history.back(), 0);
    }
    // Below the cut, right of its front: in sight behind one front, behind the other strip where there are two.
    const std::size_t below = 27 * 40 + 28; // x = 0.425, z = -0.375
    EXPECT_GT(array("field", "one_front")[below], 0.1) << criterion;
    EXPECT_LT(array("field", "two_fronts")[below], 0.98 * array("field", "one_front")[below]) << criterion;
  }
  const auto jump = [&](const std::string& name) {
    return h5::read_vector<double>(root, "/largest_jump/" + name).at(0);
  };
  EXPECT_EQ(jump("one_front_visibility"), 1);
  EXPECT_LT(jump("one_front_extended_visibility"), 0.3);
  EXPECT_GT(jump("two_fronts_diffraction"), 0.9);
  EXPECT_LT(jump("two_fronts_extended_visibility"), 0.3);
  EXPECT_NE(result.out.find("extended visibility"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("1.0000"), std::string::npos) << result.out;
}

TEST_F(WeightsCommand, RefusesWhatMakesNoSense) {
  Words words = small;
  words.insert(words.end(), {"--set", "Weights/Support [m]=0"});
  expect_error(kerf(words), 1, {"Weights/Support [m] = '0'", "must be > 0"});
  write("other.prm", "subsection Weights\n  set Colour = red\nend\n");
  expect_error(kerf({"weights", "other.prm"}), 1, {"other.prm:2: ", "Weights/Colour", "no such key"});
  write("scene.prm", cube_scene());
  expect_error(kerf({"weights", "scene.prm"}), 1, {"scene.prm:1: ", "no such section"});
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

} // namespace
} // namespace kerf::apps::weights_test
