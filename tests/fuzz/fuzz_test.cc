/// The geometric core under random and degenerate cuts: bodies in any state, sequences of sweeps, and after every
/// release every invariant (invariants.h). A failure prints the shortest case that fails; repeat it with
///
///   KERF_FUZZ_CASE=seed:sweep,sweep,... build/release/tests/test_fuzz --gtest_filter=Fuzz.Repeat
///
/// The long run also cuts every solid mesh of the folder that KERF_FUZZ_MESHES names, and says which it skipped. It
/// does 100,000 sweeps (20,000 with fronts), or as many as KERF_FUZZ_SWEEPS says, from case KERF_FUZZ_FIRST on, so that
/// several processes share them.

#include "base/parallel.h"
#include "tests/fuzz/cases.h"
#include "tests/fuzz/specimens.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <iostream>

namespace kerf::fuzz::fuzz_test {
namespace {

/// Cases on large specimens have seeds from here, and those of the long run from there (and those with fronts,
/// Case::first_seed_with_fronts), so that a seed alone tells which case it is.
constexpr std::uint32_t first_large_seed = 1u << 30, first_long_seed = 1000000;

const char* mesh_folder() { return std::getenv("KERF_FUZZ_MESHES"); }

/// The long run also cuts the meshes of a folder.
Specimens long_specimens() {
  Specimens all = own_specimens();
  if (mesh_folder())
    add_meshes(mesh_folder(), all);
  return all;
}

const Specimens& all_specimens_of(const std::uint32_t seed) {
  if (seed % first_large_seed < first_long_seed) {
    static const Specimens own = own_specimens();
    return own;
  }
  static const Specimens with_folder = long_specimens();
  return with_folder;
}

const std::vector<Specimen>& specimens_of(const std::uint32_t seed) {
  const Specimens& all = all_specimens_of(seed);
  return seed % Case::first_seed_with_fronts < first_large_seed ? all.small : all.large;
}

std::string told(const Case& one) {
  Tally unused;
  const Outcome outcome = run(one, specimens_of(one.seed), unused);
  return outcome.failure.value_or("does not fail") + "\ncase " + to_string(one) + '\n' + outcome.story +
         "repeat: " + (mesh_folder() ? "KERF_FUZZ_MESHES=" + std::string(mesh_folder()) + ' ' : "") +
         "KERF_FUZZ_CASE=" + to_string(one) + " test_fuzz --gtest_filter=Fuzz.Repeat\n";
}

void expect_sound(const Case& one, Tally& tally) {
  const auto& specimens = specimens_of(one.seed);
  if (run(one, specimens, tally).failure)
    ADD_FAILURE() << told(one) << "smallest: " << told(shrunk(one, specimens));
}

/// One thread gives the bits that two give.
void expect_same_bits(const Case& one, Tally& tally) {
  const int n_before = n_threads();
  std::array<Outcome, 2> outcomes;
  for (int n = 1; n <= 2; ++n) {
    set_n_threads(n);
    outcomes[n - 1] = run(one, specimens_of(one.seed), tally);
  }
  set_n_threads(n_before);
  ++tally.n_thread_pairs;
  if (outcomes[0].failure)
    ADD_FAILURE() << told(one) << "smallest: " << told(shrunk(one, specimens_of(one.seed)));
  EXPECT_EQ(outcomes[0].digest, outcomes[1].digest) << "1 and 2 threads differ: " << told(one);
}

void print(const Tally& tally, const double seconds) {
  std::cout << tally.n_cases << " cases, " << tally.n_sweeps << " sweeps (" << tally.n_idle_sweeps << " cut nothing), "
            << tally.n_releases << " releases, " << tally.n_cut_edges << " cut edges (" << tally.n_below_skin
            << " of the skin), " << tally.n_of_skin << " cut segments of the skin (" << tally.n_left_whole
            << " cuts left whole), " << tally.placed.n_placed << " placed vertices (" << tally.placed.n_clamped
            << " clamped), " << tally.n_double_crossings << " double crossings, " << tally.n_masses << " corner masses, "
            << tally.n_thread_pairs << " cases on 1 and 2 threads; at most " << tally.n_most_pieces << " pieces and "
            << tally.n_most_waiting << " waiting cuts\nworst change of volume " << tally.worst_volume
            << ", of volumes by tetrahedra and triangles " << tally.worst_disagreement
            << " of the body; of a corner's mass " << tally.worst_mass << " h^3; of the material in one cell "
            << tally.worst_cell << " h^3; least mass of a copy at a corner " << tally.least_mass << " h^3, of a copy "
            << tally.least_fill << " h^3, of a piece " << tally.least_piece << " h^3; ";
  if (tally.n_steps > 0)
    std::cout << tally.n_steps << " steps of blades, " << tally.n_fronts << " fronts begun, at most "
              << tally.n_most_ties << " ties at a time; ";
  std::cout << seconds << " s" << std::endl;
}

/// Cases from `first_seed` on until that many sweeps are done; every hundredth is large, and run with 1 and 2 threads.
void fuzz(const std::uint32_t first_seed, const std::size_t n_sweeps) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  Tally tally;
  std::size_t n_told = 0;
  constexpr int max_failures = 10;
  for (std::uint32_t seed = first_seed; tally.n_sweeps < n_sweeps; ++seed) {
    if (seed % 100 == 50)
      expect_same_bits(whole_case(first_large_seed + seed), tally);
    else
      expect_sound(whole_case(seed), tally);
    if (testing::Test::HasFailure() &&
        testing::UnitTest::GetInstance()->current_test_info()->result()->total_part_count() >= max_failures)
      break;
    if (tally.n_sweeps / 20000 > n_told) {
      n_told = tally.n_sweeps / 20000;
      print(tally, seconds());
    }
  }
  print(tally, seconds());
  if (first_seed >= Case::first_seed_with_fronts) {
    EXPECT_GT(tally.n_steps, n_sweeps);
    EXPECT_GT(tally.n_fronts, n_sweeps);
    EXPECT_GT(tally.n_most_ties, 0u);
  }
  EXPECT_GT(tally.n_cut_edges, n_sweeps);
  EXPECT_GT(tally.n_below_skin, n_sweeps);
  EXPECT_GT(tally.n_of_skin, n_sweeps);
  EXPECT_GT(tally.n_left_whole, 0u);
  EXPECT_GT(tally.n_masses, n_sweeps);
  EXPECT_GT(tally.n_double_crossings, 0u);
  EXPECT_GT(tally.n_thread_pairs, 0u);
}

void tell_specimens(const Specimens& specimens) {
  std::cout << "bodies:";
  for (const auto* list : {&specimens.small, &specimens.large})
    for (const Specimen& one : *list)
      std::cout << ' ' << one.name << " (" << one.body.grid.n_cells() << " cells);";
  std::cout << '\n';
  for (const std::string& why : specimens.skipped)
    std::cout << "skipped: " << why << '\n' << std::flush;
}

TEST(Fuzz, Short) { fuzz(0, 500); }
TEST(Fuzz, ShortWithFronts) { fuzz(Case::first_seed_with_fronts, 120); }

void fuzz_long(const std::uint32_t first_seed, const std::size_t n_sweeps) {
  tell_specimens(all_specimens_of(first_long_seed));
  const char *const asked = std::getenv("KERF_FUZZ_SWEEPS"), *const first = std::getenv("KERF_FUZZ_FIRST");
  fuzz(first_seed + first_long_seed + (first ? static_cast<std::uint32_t>(std::stoul(first)) : 0),
       asked ? std::stoul(asked) : n_sweeps);
}

TEST(Fuzz, Long) { fuzz_long(0, 100000); }
TEST(Fuzz, LongWithFronts) { fuzz_long(Case::first_seed_with_fronts, 20000); }

/// Sweeps on one curved body at three resolutions. The skin stays where it is, and a vertex on the rim of a cut moves
/// along the cut until its cell has its volume back. So not only the body as a whole, but each cell of the skin keeps
/// the volume of its material to round-off: there is no error left that could have an order in h.
TEST(Fuzz, SkinCellsKeepTheirVolume) {
  for (const double h : {0.4, 0.2, 0.1}) {
    const std::vector<Specimen> one = {fine_sphere(h)};
    Tally tally;
    for (std::uint32_t seed = 500; seed < 503; ++seed)
      EXPECT_EQ(run(whole_case(seed), one, tally).failure, std::nullopt) << "case " << seed;
    std::cout << "h = " << h << " R: " << tally.n_sweeps << " sweeps, " << tally.placed.n_placed
              << " placed vertices; the volume of the skin changes by at most " << tally.worst_volume
              << " of the body, that of one of its cells by " << tally.worst_cell << " h^3\n";
    EXPECT_GT(tally.placed.n_placed, 1000u);
    EXPECT_LT(tally.worst_volume, 1e-12);
    EXPECT_LT(tally.worst_cell, 1e-12);
  }
}

TEST(Fuzz, Repeat) {
  const char* text = std::getenv("KERF_FUZZ_CASE");
  if (!text)
    GTEST_SKIP() << "KERF_FUZZ_CASE names no case";
  const Case one = parse_case(text);
  std::cout << told(one);
  Tally tally;
  expect_sound(one, tally);
}

} // namespace
} // namespace kerf::fuzz::fuzz_test
