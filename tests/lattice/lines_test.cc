/// Sums over regions against regions walked step by step.

#include "lattice/lines.h"
#include "base/error.h"
#include "base/parallel.h"
#include "tests/lattice/bodies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace kerf::lattice::lines_test {
namespace {

std::vector<double> random_field(const std::size_t n, const unsigned seed) {
  Draw draw(seed);
  std::vector<double> f(n);
  for (double& value : f)
    value = draw(-1, 1);
  return f;
}

/// Sums over the given sets of points, item by item.
std::vector<double> sums(const std::vector<std::vector<std::uint32_t>>& sets, const std::vector<double>& f) {
  const std::size_t width = f.size() / sets.size();
  std::vector<double> sum(f.size(), 0.0);
  for (std::size_t r = 0; r < sets.size(); ++r)
    for (const auto i : sets[r])
      for (std::size_t k = 0; k < width; ++k)
        sum[width * r + k] += f[width * i + k];
  return sum;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

/// Regions by walking, in numbers of points.
std::vector<std::vector<std::uint32_t>> regions(const Body& body, const Lines& lines, const int w) {
  std::vector<std::vector<std::uint32_t>> sets;
  for (const auto r : lines.nodes()) {
    sets.emplace_back();
    for (const auto n : region(body, r, w))
      sets.back().push_back(std::lower_bound(lines.nodes().begin(), lines.nodes().end(), n) - lines.nodes().begin());
  }
  return sets;
}

std::vector<std::vector<std::uint32_t>> transposed(const std::vector<std::vector<std::uint32_t>>& sets) {
  std::vector<std::vector<std::uint32_t>> holders(sets.size());
  for (std::uint32_t r = 0; r < sets.size(); ++r)
    for (const auto i : sets[r])
      holders[i].push_back(r);
  return holders;
}

void expect_sums_by_definition(const Body& body, const int w, const unsigned seed) {
  const Lines lines(body, w);
  const auto sets = regions(body, lines, w);
  for (const std::size_t width : {12, 6}) {
    const auto f = random_field(width * lines.n_points(), seed);
    auto over_regions = f, over_holders = f;
    lines.sum_over_regions(over_regions);
    lines.sum_over_holders(over_holders);
    EXPECT_LT(largest_difference(over_regions, sums(sets, f)), 1e-12) << "w " << w << ", seed " << seed;
    EXPECT_LT(largest_difference(over_holders, sums(transposed(sets), f)), 1e-12) << "w " << w << ", seed " << seed;
  }
}

TEST(Lines, SumsAreThoseOverTheRegionsOfCutBodies) {
  unsigned seed = 100;
  for (const double probability : {0.0, 0.02, 0.1, 0.3, 0.7, 1.0})
    for (const int w : {1, 2, 3, 5, 8, 1000}) {
      expect_sums_by_definition(cut_block(seed, {13, 4, 6}, probability), w, seed);
      ++seed;
    }
}

/// Lines of every length against every width: what the blocks of the kernel make of ends and starts.
TEST(Lines, EveryLengthAndWidth) {
  for (int length = 1; length <= 30; ++length) {
    Draw draw(1);
    const Body body = fem::make_block({1, 1, length}, 0.1, draw, {0.5, 0.5});
    for (int w = 1; w <= 12; ++w)
      expect_sums_by_definition(body, w, static_cast<unsigned>(100 * length + w));
  }
}

TEST(Lines, RegionsOfAnUncutBlockAreBoxes) {
  Draw draw(2);
  const Body body = fem::make_block({7, 6, 5}, 0.1, draw, {0.5, 0.5});
  for (const int w : {1, 2, 4}) {
    const Lines lines(body, w);
    std::vector<double> n(6 * lines.n_points(), 1.0);
    lines.sum_over_regions(n);
    for (std::size_t r = 0; r < lines.n_points(); ++r) {
      const Index3 at = body.grid.index(lines.nodes()[r]);
      double expected = 1;
      for (int axis = 0; axis < 3; ++axis)
        expected *= std::min(at[axis] + w, 7 - axis) - std::max(at[axis] - w, 1) + 1;
      EXPECT_EQ(n[6 * r], expected);
    }
  }
}

TEST(Lines, NoPointIsReachedTwiceAndNoneInAnotherPiece) {
  const Body body = cut_block(3, {6, 6, 6}, 0.45);
  const grid::Pieces pieces = grid::pieces(body.complex);
  ASSERT_GT(pieces.n_pieces, 5u);
  std::map<grid::NodeId, std::uint32_t> piece;
  for (const auto c : ids<grid::CopyId>(body.complex.n_copies()))
    for (int v = 0; v < 8; ++v)
      if (body.complex.copies[c].nodes >> v & 1)
        piece[body.grid.nodes(body.complex.copies[c].cell)[v]] = pieces.piece[c];
  const Lines lines(body, 3);
  for (const auto r : lines.nodes()) {
    const auto nodes = region(body, r, 3);
    EXPECT_EQ(std::set<grid::NodeId>(nodes.begin(), nodes.end()).size(), nodes.size());
    for (const auto n : nodes)
      EXPECT_EQ(piece.at(n), piece.at(r));
  }
}

/// What makes the ends of a step neighbours.
TEST(Lines, TheEndsOfAStepShareACopy) {
  const Body body = cut_block(4, {6, 6, 6}, 0.3);
  std::set<std::pair<grid::NodeId, grid::NodeId>> together;
  for (const grid::Copy& copy : body.complex.copies)
    for (int a = 0; a < 8; ++a)
      for (int b = 0; b < 8; ++b)
        if ((copy.nodes >> a & 1) && (copy.nodes >> b & 1))
          together.insert({body.grid.nodes(copy.cell)[a], body.grid.nodes(copy.cell)[b]});
  for (const auto e : fem::inner_edges(body))
    EXPECT_TRUE(together.contains({body.grid.ends(e)[0], body.grid.ends(e)[1]}));
}

TEST(Lines, OneAndTwoThreadsGiveTheSameBits) {
  const Body body = cut_block(5, {17, 17, 17}, 0.1);
  std::array<std::vector<double>, 2> f;
  for (const int n : {1, 2}) {
    set_n_threads(n);
    const Lines lines(body, 2);
    f[n - 1] = random_field(12 * lines.n_points(), 6);
    lines.sum_over_regions(f[n - 1]);
  }
  set_n_threads(1);
  EXPECT_EQ(f[0], f[1]);
}

TEST(Lines, RegionsOfNoWidthAreRefused) {
  Draw draw(7);
  const Body body = fem::make_block({2, 2, 2}, 0.1, draw, {0.5, 0.5});
  for (const int w : {0, -1})
    try {
      const Lines lines(body, w);
      FAIL() << w;
    } catch (const ParameterError& error) {
      EXPECT_EQ(error.complaint().path, "Half width [cells]");
      EXPECT_EQ(error.complaint().value, std::to_string(w));
    }
}

/// What a walk of at most w steps along an axis counts from each point to each, with steps that fronts have passed in
/// part.
std::vector<std::map<std::uint32_t, double>> walks(const Body& body, const Lines& lines, const int axis, const int w) {
  const double r = 1 + 1.8 / w;
  const auto phi_of = [&](const grid::EdgeId edge) {
    double most = 0;
    for (const grid::CellId c : body.grid.cells(edge))
      if (const grid::Front* const front = c.valid() ? body.cuts.front(c) : nullptr;
          front && (front->ahead >> body.grid.line(c, edge) & 1) != 0)
        most = std::max(most, (1 + r) * front->passed / (1 + r * front->passed));
    return most;
  };
  const auto number = [&](const grid::NodeId n) {
    return static_cast<std::uint32_t>(std::ranges::lower_bound(lines.nodes(), n) - lines.nodes().begin());
  };
  std::vector<std::map<std::uint32_t, double>> walks;
  for (const auto from : lines.nodes()) {
    auto& found = walks.emplace_back();
    found[number(from)] = 1;
    for (const int sign : {-1, 1}) {
      double most = 0;
      auto at = from;
      for (int i = 0; i < w; ++i) {
        const auto next = step(body, at, axis, sign);
        if (!next)
          break;
        Index3 lower = body.grid.index(std::min(at, *next));
        most = std::max(most, phi_of(*body.grid.find_edge(lower, axis)));
        found[number(*next)] = 1 - most;
        at = *next;
      }
    }
  }
  return walks;
}

/// One axis after the other.
std::vector<double> sums_of_walks(const Body& body, const Lines& lines, const std::array<int, 3>& axes, const int w,
                                  std::vector<double> f) {
  const std::size_t width = f.size() / lines.n_points();
  for (const int axis : axes) {
    std::vector<double> sum(f.size(), 0.0);
    const auto all = walks(body, lines, axis, w);
    for (std::size_t r = 0; r < all.size(); ++r)
      for (const auto& [point, part] : all[r])
        for (std::size_t k = 0; k < width; ++k)
          sum[width * r + k] += part * f[width * point + k];
    f = std::move(sum);
  }
  return f;
}

TEST(Lines, StepsAheadOfFrontsCountInPart) {
  for (const int w : {1, 2, 3, 8})
    for (const double of_cells : {0.05, 0.5}) {
      Body body = cut_block(static_cast<unsigned>(40 + w), {11, 5, 6}, 0.1);
      Draw draw(static_cast<unsigned>(w));
      for (const auto c : ids<grid::CellId>(body.grid.n_cells()))
        if (draw(0, 1) < of_cells) {
          grid::Front front{.cell = c, .ahead = 0, .passed = draw(0.02, 0.999)};
          for (int line = 0; line < grid::cube::n_lines; ++line)
            front.ahead |= grid::Segments(draw(0, 1) < 0.4) << line;
          body.cuts.set(front);
        }
      const Lines lines(body, w);
      for (const std::size_t width : {12, 6}) {
        const auto f = random_field(width * lines.n_points(), 3);
        auto over_regions = f, over_holders = f;
        lines.sum_over_regions(over_regions);
        lines.sum_over_holders(over_holders);
        EXPECT_LT(largest_difference(over_regions, sums_of_walks(body, lines, {0, 1, 2}, w, f)), 1e-11);
        EXPECT_LT(largest_difference(over_holders, sums_of_walks(body, lines, {2, 1, 0}, w, f)), 1e-11);
      }
    }
}

} // namespace
} // namespace kerf::lattice::lines_test
