// Several scenes at a time: one that fails leaves the others.

#include "output/reader.h"
#include "tests/apps/program.h"

namespace kerf::apps::batch_test {
namespace {

using Batch = Program;

TEST_F(Batch, OneThatFailsLeavesTheOthers) {
  Words words = {"run"};
  for (int i = 0; i < 20; ++i) {
    const std::string name = "scene_" + std::to_string(i) + ".prm";
    write(name, i == 13   ? replaced(cube_scene(), "Young's modulus", "Young modulus")
                : i == 17 ? replaced(cube_scene(), "cube.off", "nothing.off")
                          : cube_scene() + falling_blade());
    words.push_back(name);
  }
  words.insert(words.end(), {"--jobs", "2", "--output", "all", "--set", "Time/End time [s]=0.03"});
  const Result result = kerf(words);
  EXPECT_EQ(result.exit_code, 2); // the worst: a file
  EXPECT_NE(result.err.find("2 of 20 scenes did not complete"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("scene_13.prm: exit code 1: kerf: scene_13.prm:"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("scene_17.prm: exit code 2: kerf: "), std::string::npos) << result.err;
  for (int i = 0; i < 20; ++i) {
    const std::string name = "scene_" + std::to_string(i);
    if (i == 13 || i == 17) {
      EXPECT_FALSE(std::filesystem::exists(folder / "all" / name / "run.h5"));
      continue;
    }
    EXPECT_NE(result.out.find(name + ".prm: completed, results in all/" + name), std::string::npos) << result.out;
    const output::Reader reader(folder / "all" / name / "run.h5");
    EXPECT_EQ(reader.outcome(), output::Outcome::completed);
    EXPECT_EQ(reader.n_steps(), 4u);
  }
  const Result again = kerf({"run", "scene_1.prm", "scene_2.prm", "--output", "all"});
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_NE(again.err.find("2 of 2 scenes did not complete"), std::string::npos) << again.err;
}

} // namespace
} // namespace kerf::apps::batch_test
