/// Unseen bodies under random strokes of every tool, while they sag, swing and fall, with every physics: nothing runs
/// away, no energy comes from nothing, no volume is lost, no number is none, and no step is refused. The long run takes
/// all closed meshes of the folder that KERF_GRINDER_MESHES names, and says which it could not use:
///
///   KERF_GRINDER_MESHES=folder ./kerf test -L long -R Grinder
///
/// KERF_GRINDER_CASES: how many (1000). KERF_GRINDER_FIRST_SEED: another choice of them. KERF_GRINDER_KINDS: only kinds of physics whose name holds this.
/// KERF_GRINDER_SET: keys of every scene that are set otherwise, as `kerf run --set` does, separated by semicolons.
/// KERF_GRINDER_FAILURES: a folder for the scenes of cases that fail, which `kerf run` repeats. One case again:
///
///   KERF_GRINDER_CASE=mesh:kind:seed build/release/tests/test_grinder --gtest_filter=Grinder.Repeat

#include "tests/grinder/grinder.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <iostream>
#include <sstream>

namespace kerf::grinder {
namespace {

std::string setting(const char* name, const std::string& otherwise) {
  const char* value = std::getenv(name);
  return value ? value : otherwise;
}

std::filesystem::path mesh_folder() { return setting("KERF_GRINDER_MESHES", KERF_SOURCE_DIR "/params/meshes"); }

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
              << (outcome.refused ? "refused" : outcome.failure ? outcome.failure->reason : "well") << ", "
              << outcome.figures.fastest << " m/s\n";
    harvest.add(one, scene, outcome);
  }
}

void report(const Solids& solids, const Harvest& harvest) {
  std::cout << solids.usable.size() << " meshes; " << solids.refused.size() << " cannot be used\n";
  for (const std::string& refusal : solids.refused)
    std::cout << "not used: " << refusal << '\n';
  std::cout << harvest.summary();
  for (const std::string& failure : harvest.failures())
    ADD_FAILURE() << failure;
}

TEST(Grinder, Short) {
  const Solids solids = solids_in(KERF_SOURCE_DIR "/params/meshes");
  Harvest harvest(setting("KERF_GRINDER_FAILURES", ""));
  grind(solids, 35, {.least_cells = 150, .most_cells = 400, .least_steps = 12, .most_steps = 20}, harvest);
  report(solids, harvest);
}

TEST(Grinder, Long) {
  const Solids solids = solids_in(mesh_folder());
  Harvest harvest(setting("KERF_GRINDER_FAILURES", ""));
  grind(solids, std::stoul(setting("KERF_GRINDER_CASES", "1000")), {}, harvest);
  report(solids, harvest);
}

/// "mesh:kind:seed"
TEST(Grinder, Repeat) {
  const std::string name = setting("KERF_GRINDER_CASE", "");
  if (name.empty())
    GTEST_SKIP() << "KERF_GRINDER_CASE names no case";
  const std::size_t first = name.find(':'), last = name.rfind(':');
  const Solids solids = solids_in(mesh_folder());
  for (const Solid& solid : solids.usable)
    if (solid.name == name.substr(0, first)) {
      const Case one{&solid, &kind_named(name.substr(first + 1, last - first - 1)),
                     static_cast<unsigned>(std::stoul(name.substr(last + 1)))};
      const Scene scene = random_scene(solid, *one.kind, one.seed, {});
      const Outcome outcome = run(scene, changes(), Until::end);
      Harvest harvest(setting("KERF_GRINDER_FAILURES", ""));
      harvest.add(one, scene, outcome);
      std::cout << text(scene);
      if (outcome.failure)
        std::cout << "smallest:\n" << text(shrunk(scene, changes(), outcome.failure->reason));
      report(solids, harvest);
    }
}

} // namespace
} // namespace kerf::grinder
