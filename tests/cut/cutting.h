#pragma once

/// A body at rest that a cutter cuts, with its surface, and what holds of it however it is cut.

#include "cut/cutter.h"
#include "tests/support/placed.h"
#include "tests/support/same.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>

namespace kerf::cut {

using support::Body;

inline Body block() { return support::with_copies(support::with_placed_skin(support::block({9, 9, 9}))); }

/// The body cut by the surfaces one after the other, by a cutter of these fronts.
struct Cutting {
  explicit Cutting(Body whole, const Fronts fronts) : body(std::move(whole)), cutter(9, Release::queued, fronts) {
    cutter.begin(body, grid::rest_positions(body));
    pieces = grid::pieces(body.complex);
    surface = surface::build_surface(body, index);
  }
  void cut(const Shape& shape) { follow(cutter.at_once(body, {"cut", shape, 1}, grid::rest_positions(body))); }
  void step(const Blade& blade, const double t0, const double t1) { step(blade, t0, t1, grid::rest_positions(body)); }
  grid::CutChange step(const Blade& blade, const double t0, const double t1, const Points& x) {
    grid::CutChange change = cutter.step(body, std::span(&blade, 1), t0, t1, x);
    follow(change);
    return change;
  }
  void follow(grid::CutChange&& change) { follow(change); }
  void follow(grid::CutChange& change) {
    surface::place(body, change, {});
    surface::update_surface(body, change, surface, index);
    grid::update_pieces(body, change, pieces);
    const grid::Pieces anew = grid::pieces(body.complex);
    EXPECT_EQ(pieces.n_pieces, anew.n_pieces);
    EXPECT_TRUE(std::ranges::equal(pieces.piece, anew.piece));
  }

  Body body;
  Cutter cutter;
  surface::SurfaceIndex index;
  surface::Surface surface;
  grid::Pieces pieces;
};

inline bool is_closed(const surface::Surface& s) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (const auto& t : s.triangles)
    for (int i = 0; i < 3; ++i) {
      const auto a = t[i], b = t[(i + 1) % 3];
      balance[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  return std::all_of(balance.begin(), balance.end(), [](const auto& edge) { return edge.second == 0; });
}

inline double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

/// Built anew from what is cut, body and surface are the same.
inline void expect_as_built(const Cutting& cutting) {
  Body anew = cutting.body;
  anew.complex = grid::build_complex(anew);
  const auto names = support::renaming(cutting.body.complex, anew.complex);
  ASSERT_TRUE(names);
  EXPECT_TRUE(support::is_same(cutting.surface, surface::build_surface(anew), *names));
}

/// Pieces, mass and a closed surface as those of a body that is cut the same way without fronts in its cells.
inline void expect_alike(const Cutting& with, const Cutting& without) {
  ASSERT_EQ(grid::n_pieces(with.body.complex), grid::n_pieces(without.body.complex));
  const double volume = sum(support::octant_volumes(with.body));
  EXPECT_NEAR(volume, sum(support::octant_volumes(without.body)), 1e-9);
  EXPECT_NEAR(volume, surface::enclosed_volume(with.surface.rest, with.surface.triangles), 1e-9);
  EXPECT_TRUE(is_closed(with.surface));
}

} // namespace kerf::cut
