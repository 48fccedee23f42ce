/// Unseen bodies under random strokes of every tool, while they sag, swing and fall, with every physics: nothing runs
/// away, no energy comes from nothing, no volume is lost, no number is none, and no step is refused, but where a body
/// hangs by a thread whatever the step and the element. The long run takes
/// all closed meshes of the folder that KERF_GRINDER_MESHES names, and says which it could not use:
///
///   KERF_GRINDER_MESHES=folder ./kerf test -L long -R Grinder
///
///   KERF_GRINDER_CASES         how many (1000)
///   KERF_GRINDER_FIRST_SEED    another choice of them (0)
///   KERF_GRINDER_KINDS         only kinds of physics whose name holds this ("fem", "neo-Hookean", "lattice", ...)
///   KERF_GRINDER_SET           keys of every scene set otherwise, as by `kerf run --set`, separated by semicolons
///   KERF_GRINDER_FAILURES      a folder for the scenes of cases that fail, which `kerf run` repeats
///
/// One case again, or a scene, or all scenes of a folder; where it is one, the smallest scene found that fails like it:
///
///   KERF_GRINDER_CASE=mesh:kind:seed build/release/tests/test_grinder --gtest_filter=Grinder.Repeat
///   KERF_GRINDER_SCENES=file.prm build/release/tests/test_grinder --gtest_filter=Grinder.Repeat

#include "tests/grinder/grinder.h"
#include "tests/support/checkout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <map>
#include <sstream>

namespace kerf::grinder::grinder_test {
namespace {

std::string setting(const char* name, const std::string& otherwise) {
  const char* value = std::getenv(name);
  return value ? value : otherwise;
}

std::filesystem::path mesh_folder() { return setting("KERF_GRINDER_MESHES", support::checkout() + "/params/meshes"); }

/// "Section/Key=value;Section/Key=value"
std::vector<std::string> changes() {
  std::vector<std::string> all;
  std::istringstream text(setting("KERF_GRINDER_SET", ""));
  for (std::string one; std::getline(text, one, ';');)
    all.push_back(one);
  return all;
}

std::vector<const Kind*> wanted_kinds() {
  std::vector<const Kind*> wanted;
  for (const Kind& kind : kinds())
    if (kind.name.find(setting("KERF_GRINDER_KINDS", "")) != std::string::npos)
      wanted.push_back(&kind);
  return wanted;
}

/// Mesh after mesh, with one kind after another.
void grind(const Solids& solids, const std::size_t n_cases, const Size& size, Harvest& harvest) {
  const auto some = wanted_kinds();
  const auto first_seed = static_cast<unsigned>(std::stoul(setting("KERF_GRINDER_FIRST_SEED", "0")));
  ASSERT_FALSE(solids.usable.empty());
  ASSERT_FALSE(some.empty());
  for (std::size_t i = 0; i < n_cases; ++i) {
    const std::size_t round = i / solids.usable.size();
    const Case one{&solids.usable[i % solids.usable.size()], some[(i + round) % some.size()],
                   first_seed + static_cast<unsigned>(round)};
    std::cout << name_of(one) << std::flush;
    const Scene scene = random_scene(*one.solid, *one.kind, one.seed, size);
    const auto start = std::chrono::steady_clock::now();
    const Outcome outcome = run(scene, changes(), Until::end);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::cout << ' ' << outcome.n_cells << " cells, " << outcome.n_steps << " steps, " << seconds << " s: "
              << (outcome.refused   ? "refused"
                  : outcome.failure ? outcome.failure->reason
                                    : "well")
              << ", " << outcome.figures.fastest << " m/s, stretched " << outcome.figures.stretch << " times\n";
    harvest.add(name_of(one), one.kind->name, scene, changes(), outcome);
  }
}

void report(const Solids& solids, const Harvest& harvest) {
  std::cout << solids.usable.size() << " meshes; " << solids.refused.size() << " cannot be used\n";
  for (const std::string& refusal : solids.refused)
    std::cout << "not used: " << refusal << '\n';
  std::cout << harvest.summary();
  EXPECT_LE(10 * harvest.n_refused(), harvest.n_cases()) << "scenes that are refused test nothing";
  for (const std::string& failure : harvest.failures())
    ADD_FAILURE() << failure;
}

constexpr Size short_ones{.least_cells = 100, .most_cells = 250, .least_steps = 12, .most_steps = 20};

/// On six meshes.
TEST(Grinder, Short) {
  Solids solids = solids_in(support::checkout() + "/params/meshes");
  const std::vector<std::string> names = {"apple", "ball", "bar", "cube", "liver_25k", "pear"};
  std::erase_if(solids.usable, [&](const Solid& solid) { return std::ranges::count(names, solid.name) == 0; });
  Harvest harvest(setting("KERF_GRINDER_FAILURES", ""));
  grind(solids, 28, short_ones, harvest);
  report(solids, harvest);
}

/// A soft ball that swings fast for its steps: one solution a step gave it 1.1 % of its energy.
TEST(Grinder, ASwingingBallGainsNoEnergy) {
  Solids solids = solids_in(support::checkout() + "/params/meshes");
  std::erase_if(solids.usable, [](const Solid& solid) { return solid.name != "ball"; });
  Harvest harvest("");
  for (const Kind& kind : kinds())
    if (kind.name.starts_with("fem")) {
      const Scene scene = random_scene(solids.usable.at(0), kind, 0, short_ones);
      harvest.add(kind.name, kind.name, scene, {}, run(scene, {}, Until::end));
    }
  report(solids, harvest);
}

/// Half cut through, its light corners took up what the bar's vibrations have, and ran away from the sixth step on.
TEST(Grinder, LightCornersDoNotRing) {
  Solids solids = solids_in(support::checkout() + "/params/meshes");
  std::erase_if(solids.usable, [](const Solid& solid) { return solid.name != "bar"; });
  Harvest harvest("");
  const Kind& kind = kind_named("fem-trilinear-Newmark");
  Scene scene = random_scene(solids.usable.at(0), kind, 4, short_ones);
  const double dt = number_of(scene, "Time step [s]").value_or(0), end = 9 * dt;
  std::erase_if(scene.sections, [&](const std::string& section) {
    return is_tool(section) && number_of({{section}, {}}, "Time [s]").value_or(0) >= end - dt;
  });
  scene = with_number(scene, "End time [s]", end);
  harvest.add(kind.name, kind.name, scene, {}, run(scene, {}, Until::end));
  report(solids, harvest);
}

TEST(Grinder, Long) {
  const Solids solids = solids_in(mesh_folder());
  Harvest harvest(setting("KERF_GRINDER_FAILURES", ""));
  grind(solids, std::stoul(setting("KERF_GRINDER_CASES", "1000")), {}, harvest);
  report(solids, harvest);
}

/// "mesh:kind:seed"
Scene scene_named(const std::string& name) {
  const std::size_t first = name.find(':'), last = name.rfind(':');
  for (const Solid& solid : solids_in(mesh_folder()).usable)
    if (solid.name == name.substr(0, first))
      return random_scene(solid, kind_named(name.substr(first + 1, last - first - 1)),
                          static_cast<unsigned>(std::stoul(name.substr(last + 1))), {});
  throw std::out_of_range("no mesh that can be used is called " + name.substr(0, first));
}

/// The scenes that a file or folder holds, by name.
std::map<std::string, Scene> scenes_in(const std::filesystem::path& path) {
  std::map<std::string, Scene> scenes;
  if (!std::filesystem::is_directory(path))
    return {{path.stem().string(), read_scene(path)}};
  for (const auto& entry : std::filesystem::directory_iterator(path))
    if (entry.path().extension() == ".prm")
      scenes[entry.path().stem().string()] = read_scene(entry.path());
  return scenes;
}

/// The smallest scene found that fails like this one: printed, and kept beside the others.
void shrink(const std::string& name, const Scene& scene, const std::string& reason) {
  const Scene least = shrunk(scene, changes(), reason);
  Harvest harvest(setting("KERF_GRINDER_FAILURES", ""));
  harvest.add(name + ".least", "smallest", least, changes(), run(least, changes(), Until::end));
  std::cout << harvest.failures().at(0) << '\n' << text(least);
}

TEST(Grinder, Repeat) {
  const std::string name = setting("KERF_GRINDER_CASE", ""), path = setting("KERF_GRINDER_SCENES", "");
  if (name.empty() && path.empty())
    GTEST_SKIP() << "neither KERF_GRINDER_CASE nor KERF_GRINDER_SCENES names one";
  const auto scenes = path.empty() ? std::map<std::string, Scene>{{name, scene_named(name)}} : scenes_in(path);
  Harvest harvest(setting("KERF_GRINDER_FAILURES", ""));
  for (const auto& [which, scene] : scenes) {
    const Outcome outcome = run(scene, changes(), Until::end);
    std::cout << which << ": " << (outcome.failure ? outcome.failure->reason : "well") << '\n' << std::flush;
    harvest.add(which, "repeated", scene, changes(), outcome);
    if (!harvest.failures().empty() && scenes.size() == 1)
      shrink(which, scene, outcome.failure->reason);
  }
  report({}, harvest);
}

} // namespace
} // namespace kerf::grinder::grinder_test
