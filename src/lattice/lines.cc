#include "lattice/lines.h"

#include "base/error.h"
#include "base/loan.h"
#include "base/parallel.h"
#include "lattice/kernels.h"

#include <algorithm>

namespace kerf::lattice {

namespace {

constexpr std::size_t worth_points = 4096; // from which on a second thread pays

constexpr std::uint32_t nowhere = grid::NodeId::no_value;

bool is_point(const grid::Solid& solid, const grid::NodeId node) {
  return solid.grid.is_material(node) && !(solid.crumbs.any() && solid.crumbs.holds(solid.complex.real_corner[node]));
}

/// Calls f(axis, lower, upper) for each step of the lattice.
template <class Function>
void for_each_step(const grid::Solid& solid, const Function& f) {
  for (const auto e : ids<grid::EdgeId>(solid.grid.n_edges()))
    if (const auto& [lower, upper] = solid.grid.ends(e);
        !solid.cuts.is_cut(e) && is_point(solid, lower) && is_point(solid, upper))
      f(solid.grid.axis(e), lower, upper);
}

} // namespace

Lines::Lines(const grid::Solid& solid, const int half_width) : half_width_(static_cast<std::size_t>(half_width)) {
  if (half_width < 1)
    throw ParameterError({.path = "Half width [cells]",
                          .value = std::to_string(half_width),
                          .rule = "must be >= 1",
                          .remedy = "A region of no width is a single point and has no stiffness"});
  std::vector<std::uint32_t> point_of(solid.grid.n_nodes(), nowhere);
  for (const auto n : ids<grid::NodeId>(solid.grid.n_nodes()))
    if (is_point(solid, n)) {
      point_of[n.value] = static_cast<std::uint32_t>(nodes_.size());
      nodes_.push_back(n);
    }
  std::array<std::vector<std::uint32_t>, 3> next;
  next.fill(std::vector<std::uint32_t>(n_points(), nowhere));
  for_each_step(solid, [&](const int axis, const grid::NodeId lower, const grid::NodeId upper) {
    next[axis][point_of[lower.value]] = point_of[upper.value];
  });
  for (int axis = 0; axis < 3; ++axis)
    axes_[axis] = lines_through(next[axis]);
}

Lines::Axis Lines::lines_through(const std::vector<std::uint32_t>& next) {
  std::vector<std::uint8_t> is_head(next.size(), 1);
  for (const auto p : next)
    if (p != nowhere)
      is_head[p] = 0;
  Axis lines;
  lines.points.reserve(next.size());
  lines.start.push_back(0);
  for (std::uint32_t head = 0; head < next.size(); ++head)
    if (is_head[head]) {
      for (auto p = head; p != nowhere; p = next[p])
        lines.points.push_back(p);
      lines.longest = std::max<std::size_t>(lines.longest, lines.points.size() - lines.start.back());
      lines.start.push_back(static_cast<std::uint32_t>(lines.points.size()));
    }
  return lines;
}

void Lines::sum_windows_along(const Axis& axis, std::vector<double>& f) const {
  if (n_points() == 0)
    return;
  const std::size_t n_lines = axis.start.size() - 1, width = f.size() / n_points();
  const std::size_t worth = n_points() < worth_points ? n_lines + 1 : 2;
  parallel_ranges(n_lines, worth, [&](const std::size_t first, const std::size_t last) {
    Loan<double> scratch(2 * width * axis.longest);
    sum_windows({first, last, axis.start.data(), axis.points.data()}, half_width_, width, f.data(), scratch->data());
  });
}

void Lines::sum_over_regions(std::vector<double>& f) const {
  for (int axis = 0; axis < 3; ++axis)
    sum_windows_along(axes_[axis], f);
}

void Lines::sum_over_holders(std::vector<double>& f) const {
  for (int axis = 3; axis-- > 0;)
    sum_windows_along(axes_[axis], f);
}

} // namespace kerf::lattice
