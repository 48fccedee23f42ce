// Scenes with the integrator modal: closed forms, what cuts do to frequencies, fields, what is refused.

#include "base/error.h"
#include "tests/scene/trials.h"

namespace kerf::scene::modal_scenes_test {
namespace {

constexpr double E = 1e5, speed = 10; // of waves in a rod of 1000 kg/m^3 [m/s]

/// A bar of 1 x 0.2 x 0.2 m, one step.
std::string modal_bar(const int n_modes, const std::string& inside, const Keys& more = {},
                      const std::string& outside = "", const int n_steps = 1) {
  return steps(1, n_steps) +
         section("Body bar",
                 Keys{"Shape = box", "Sides [m] = 1, 0.2, 0.2", "Cube edge [m] = 0.05", "Integrator = modal"} + more,
                 section("Modal", {key("Modes [1]", n_modes)}) + inside) +
         observe("frequencies, pieces") + outside;
}

double frequency(const Trial& trial, const int i) { return trial.last("frequency " + std::to_string(i)); }

/// j c / (2 L), of a rod that contracts nowhere; half waves of 20 / j cells.
TEST(ModalScene, ARodRingsAlongItsAxis) {
  const std::string along = section("Support sides", box("-1, -1, -1", "1, 1, 1") + Keys{"Hold = yz"});
  for (const std::string backend : {"fem", "mass-spring", "pba"}) {
    SCOPED_TRACE(backend);
    Keys more = {"Backend = " + backend};
    if (backend == "fem")
      more.push_back("Mass = consistent");
    const Trial rod(modal_bar(4, material(E, 0, backend == "fem" ? "small strain" : "corotational") + along, more));
    EXPECT_NEAR(frequency(rod, 1), 0, 1e-5);
    // springs have nu = 1/4, and are as stiff as a solid whose sides are held; points have rough ends
    const double expected = backend == "mass-spring" ? speed / 2 * std::sqrt(1.2) : speed / 2;
    for (int j = 1; j < (backend == "mass-spring" ? 3 : 4); ++j) // of springs, shear comes third
      EXPECT_NEAR(frequency(rod, j + 1), j * expected, (backend == "pba" ? 0.06 : 0.01) * j * expected) << j;
  }
}

/// A bar with a square section bends in two planes alike; six rigid motions have no frequency.
TEST(ModalScene, AFloatingBarHasSixRigidMotionsAndPairs) {
  const Trial bar(modal_bar(9, material(E, 0.3), {"Element = enhanced", "Mass = consistent"}));
  for (int i = 1; i <= 6; ++i)
    EXPECT_LT(frequency(bar, i), 1e-4) << i;
  EXPECT_NEAR(frequency(bar, 8), frequency(bar, 7), 1e-6);
  EXPECT_GT(frequency(bar, 9), 1.02 * frequency(bar, 8));
}

/// At time 1 a plane halves it: two bodies, twelve rigid motions.
TEST(ModalScene, EachPieceHasItsOwn) {
  const Trial bar(modal_bar(13, material(E, 0.3), {},
                            section("Cut surface knife", {"Time [s] = 1", "Shape = plane", "Point [m] = 0.013, 0, 0",
                                                          "Normal [1] = 1, 0.1, 0"}),
                            2));
  EXPECT_EQ(bar.last("pieces"), 2);
  EXPECT_GT(bar.series("frequency 7")[1], 1);
  EXPECT_LT(frequency(bar, 12), 1e-4);
  EXPECT_GT(frequency(bar, 13), 1);
}

/// Linear equations take as many iterations whatever the number of cells (twice as many with blocks alone).
TEST(ModalScene, MultigridSolvesItsEquations) {
  const auto iterations = [](const std::string& edge) {
    std::string text = modal_bar(3, material(E, 0.3) + section("Support wall", box("-1, -1, -1", "-0.45, 1, 1")));
    for (const auto& [from, to] : {std::pair<std::string, std::string>("= 0.05", "= " + edge),
                                   {"frequencies, pieces", "frequencies, solver iterations"}})
      text.replace(text.find(from), from.size(), to);
    return Trial(text).last("solver iterations");
  };
  const double coarse = iterations("0.04"), fine = iterations("0.02");
  RecordProperty("iterations", std::to_string(coarse) + ' ' + std::to_string(fine));
  EXPECT_LT(fine, 1.3 * coarse);
}

/// A cut into a clamped bar makes it softer, not lighter: every frequency falls.
TEST(ModalScene, ACutLowersFrequencies) {
  const std::string wall = section("Support wall", box("-1, -1, -1", "-0.499, 1, 1") + Keys{"Hold at = skin"});
  const Trial bar(
    modal_bar(4, material(E, 0.3) + wall, {"Element = enhanced"},
              section("Cut surface knife", {"Time [s] = 1", "Shape = rectangle", "Point [m] = -0.22, 0, 0.1",
                                            "First side [m] = 0, 0.5, 0", "Second side [m] = 0, 0, 0.2"}),
              2));
  EXPECT_EQ(bar.last("pieces"), 1);
  for (int i = 1; i <= 4; ++i) {
    const auto f = bar.series("frequency " + std::to_string(i));
    EXPECT_LT(f[2], f[1]) << i;
  }
  const auto first = bar.series("frequency 1");
  EXPECT_GT(first[2], 0.3 * first[1]);
  EXPECT_NEAR(first[1], 1.015 * 0.2 * speed / (2 * 3.14159), 0.06 * first[1]); // Euler's beam, 1.8751^2 / sqrt(12)
}

TEST(ModalScene, ShapesAreFields) {
  const Trial bar(modal_bar(
    8, material(E, 0.3), {},
    section("Output", {"Frames every [1] = 1", "Fields = displacement, modes"}) + section("Surface file", {})));
  const output::Frame frame = bar.reader().frame("bar", 1);
  ASSERT_EQ(frame.fields.size(), 9u);
  EXPECT_EQ(frame.fields[8].name, "mode_8");
  double largest = 0;
  for (std::size_t i = 0; i < frame.fields[8].values.size(); i += 3)
    largest = std::max(
      largest, Vec3(frame.fields[8].values[i], frame.fields[8].values[i + 1], frame.fields[8].values[i + 2]).norm());
  EXPECT_NEAR(largest, 1, 1e-5);
  EXPECT_EQ(frame.positions, bar.reader().frame("bar", 0).positions);
}

void expect_refused(const std::string& text, const Keys& words) {
  try {
    const Trial trial(text);
    ADD_FAILURE() << "accepted";
  } catch (const ParameterError& error) {
    for (const std::string& word : words)
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
  }
}

TEST(ModalScene, WhatHasNoModesIsRefused) {
  expect_refused(modal_bar(4, material(E, 0), {"Backend = lattice"}), {"lattice", "moves in time only"});
  expect_refused(modal_bar(4, material(E, 0), {"Backend = pba"}, section("Output", {"Fields = modes"})),
                 {"Fields", "'modes'"});
  expect_refused(modal_bar(0, material(E, 0)), {"Modes [1]"});
  expect_refused(modal_bar(400, material(E, 0) + section("Support all", box("-1, -1, -1", "0.47, 1, 1"))),
                 {"body bar", "400 modes", "Use fewer modes"});
}

} // namespace
} // namespace kerf::scene::modal_scenes_test
