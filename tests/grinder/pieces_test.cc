/// The same strokes cut the same pieces, whatever law, time step and Newton iterations move the body, for as long as it
/// moves the same to a tenth of a cube. What is compared is the number of pieces with at least eight material nodes. A
/// cell is cut at two edges at most in a step, and what is left of it in the next ones (thesis §2.4.3): so pieces may
/// come up to two steps later with the longer step.
///
///   KERF_GRINDER_MESHES=folder ./kerf test -L long -R SamePieces

#include "grid/complex.h"
#include "scene/compose.h"
#include "scene/run.h"
#include "tests/grinder/cases.h"
#include "tests/support/checkout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <map>
#include <sstream>

namespace kerf::grinder::pieces_test {
namespace {

constexpr double same_motion = 0.1;  // of a cube
constexpr std::size_t most_late = 2; // steps

/// How a run differs from the first.
struct Variant {
  std::string name;
  std::vector<std::string> changes;
  int n_substeps = 1;
};

const std::vector<Variant>& variants() {
  static const std::vector<Variant> all = {
    {"neo-Hookean", {"Body solid/Material/Law=neo-Hookean"}},
    {"St. Venant-Kirchhoff", {"Body solid/Material/Law=St. Venant-Kirchhoff"}},
    {"20 Newton iterations", {"Body solid/Implicit Euler/Newton iterations [1]=20"}},
    {"half the time step", {}, 2},
  };
  return all;
}

/// The piece of each material node, pieces numbered by their first nodes.
std::vector<std::uint32_t> parts(const scene::Body& body) {
  const grid::CellComplex& complex = body.solid.complex;
  const grid::Pieces pieces = grid::pieces(complex);
  std::vector<std::uint32_t> of_corner(complex.n_corners(), 0), parts;
  for (const auto c : ids<grid::CopyId>(complex.n_copies()))
    for (const auto corner : complex.copies[c].corners)
      of_corner[corner.value] = pieces.piece[c];
  std::map<std::uint32_t, std::uint32_t> numbers;
  for (const auto n : ids<grid::NodeId>(complex.real_corner.size()))
    if (const auto corner = complex.real_corner[n]; corner.valid())
      parts.push_back(
        numbers.try_emplace(of_corner[corner.value], static_cast<std::uint32_t>(numbers.size())).first->second);
  return parts;
}

/// Pieces of at least so many nodes: what is smaller is a matter of less than a tenth of a cube.
std::size_t n_large(const std::vector<std::uint32_t>& parts) {
  constexpr std::ptrdiff_t least = 8;
  std::map<std::uint32_t, std::ptrdiff_t> sizes;
  for (const auto part : parts)
    ++sizes[part];
  return static_cast<std::size_t>(std::ranges::count_if(sizes, [](const auto& s) { return s.second >= least; }));
}

/// By how far the corners of the uncut body are apart [m].
double apart(const scene::Body& a, const scene::Body& b, const std::size_t n_corners) {
  double most = 0;
  for (std::size_t i = 0; i < n_corners; ++i)
    most = std::max(most, (a.state.x[i] - b.state.x[i]).norm());
  return most;
}

struct Comparison {
  int n_steps = 0, n_cuts = 0; ///< with the same motion before
  std::string difference;      ///< where pieces are not the same
  std::size_t n_pieces = 0;
};

/// Whether one run has as many pieces now as the other has, or had a few steps ago.
bool follows(const std::vector<std::size_t>& one, const std::vector<std::size_t>& other) {
  const auto first = other.end() - static_cast<std::ptrdiff_t>(std::min(other.size(), most_late + 1));
  const auto [least, most] = std::minmax_element(first, other.end());
  return *least <= one.back() && one.back() <= *most;
}

Comparison compare(const Scene& scene, const Variant& variant) {
  std::vector<std::string> changes = variant.changes;
  const double dt = number_of(scene, "Time step [s]").value_or(1);
  changes.push_back("Time/Time step [s]=" + std::to_string(dt / variant.n_substeps));
  scene::World first = scene::compose(scene::scan_scene_text(text(scene), scene.file, {})),
               other = scene::compose(scene::scan_scene_text(text(scene), scene.file, changes));
  scene::Body &a = first.bodies.at(0), &b = other.bodies.at(0);
  const std::size_t n_corners = a.state.x.size();
  Timings timings;
  Comparison result;
  std::vector<std::size_t> of_first, of_other; // how many pieces, by step
  for (int step = 1; step <= first.n_steps; ++step) {
    if (apart(a, b, n_corners) > same_motion * a.solid.grid.h())
      break;
    const int n_recuts = a.n_recuts;
    scene::advance(first, step, timings);
    for (int k = 1; k <= variant.n_substeps; ++k)
      scene::advance(other, variant.n_substeps * (step - 1) + k, timings);
    ++result.n_steps;
    result.n_cuts += a.n_recuts - n_recuts;
    of_first.push_back(n_large(parts(a)));
    of_other.push_back(n_large(parts(b)));
    result.n_pieces = of_first.back();
    if (!follows(of_first, of_other) && !follows(of_other, of_first)) {
      result.difference = "step " + std::to_string(step) + ": " + std::to_string(of_first.back()) + " and " +
                          std::to_string(of_other.back()) + " pieces";
      break;
    }
  }
  return result;
}

/// Held bodies that sag by less than a tenth of a cube, and strokes through them.
Scene stiff_scene(const Solid& solid, const unsigned seed) {
  constexpr Size size{.least_cells = 150, .most_cells = 300, .least_steps = 12, .most_steps = 16};
  return with_number(random_scene(solid, kinds().front(), seed, size), "Young's modulus [Pa]", 1e7);
}

void expect_same_pieces(const Solids& solids, const unsigned n_seeds) {
  int n_cuts = 0, n_divided = 0;
  for (const Solid& solid : solids.usable)
    for (unsigned seed = 0; seed < n_seeds; ++seed) {
      const Scene scene = stiff_scene(solid, seed);
      for (const Variant& variant : variants()) {
        const Comparison found = compare(scene, variant);
        n_cuts += found.n_cuts;
        n_divided += found.n_pieces > 1 ? 1 : 0;
        EXPECT_EQ(found.difference, "") << solid.name << ", seed " << seed << ", " << variant.name << ": "
                                        << scene.story;
      }
    }
  std::cout << n_cuts << " cuts compared, " << n_divided << " runs with more than one piece\n";
  EXPECT_GT(n_cuts, static_cast<int>(solids.usable.size()));
  EXPECT_GT(n_divided, 0);
}

TEST(SamePieces, WhateverMovesTheBody) {
  Solids solids = solids_in(support::checkout() + "/params/meshes");
  const std::vector<std::string> names = {"apple", "bar", "cube", "pear"};
  std::erase_if(solids.usable, [&](const Solid& solid) { return std::ranges::count(names, solid.name) == 0; });
  expect_same_pieces(solids, 3);
}

TEST(SamePieces, Long) {
  const char* const folder = std::getenv("KERF_GRINDER_MESHES");
  expect_same_pieces(solids_in(folder ? folder : support::checkout() + "/params/meshes"), 4);
}

} // namespace
} // namespace kerf::grinder::pieces_test
