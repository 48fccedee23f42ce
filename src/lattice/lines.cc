#include "lattice/lines.h"

#include "base/error.h"
#include "base/loan.h"
#include "base/parallel.h"
#include "base/sort_unique.h"
#include "lattice/kernels.h"

#include <algorithm>
#include <map>
#include <span>

namespace kerf::lattice {

namespace {

constexpr std::size_t worth_points = 4096; // from which on a second thread pays

constexpr std::uint32_t nowhere = grid::NodeId::no_value;

bool is_point(const grid::Solid& solid, const grid::NodeId node) {
  return solid.grid.is_material(node) && !(solid.crumbs.any() && solid.crumbs.holds(solid.complex.real_corner[node]));
}

/// Calls f(edge, lower, upper) for each step of the lattice.
template <class Function>
void for_each_step(const grid::Solid& solid, const Function& f) {
  for (const auto e : ids<grid::EdgeId>(solid.grid.n_edges()))
    if (const auto& [lower, upper] = solid.grid.ends(e);
        !solid.cuts.is_cut(e) && is_point(solid, lower) && is_point(solid, upper))
      f(e, lower, upper);
}

/// The most that a front has passed of a cell around an edge that lies ahead of it; 0 where none does.
double passed_at(const grid::Solid& solid, const grid::EdgeId edge) {
  double most = 0;
  for (const grid::CellId c : solid.grid.cells(edge))
    if (c.valid())
      if (const grid::Front* const front = solid.cuts.front(c);
          front && (front->ahead >> solid.grid.line(c, edge) & 1) != 0)
        most = std::max(most, front->passed);
  return most;
}

double phi(const double passed, const int half_width) {
  const double r = 1 + 1.8 / half_width;
  return (1 + r) * passed / (1 + r * passed);
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
  std::array<std::vector<Partial>, 3> partial;
  const bool has_fronts = !solid.cuts.fronts().empty();
  for_each_step(solid, [&](const grid::EdgeId edge, const grid::NodeId lower, const grid::NodeId upper) {
    const int axis = solid.grid.axis(edge);
    next[axis][point_of[lower.value]] = point_of[upper.value];
    if (const double passed = has_fronts ? passed_at(solid, edge) : 0; passed > 0)
      partial[axis].push_back({point_of[lower.value], phi(passed, half_width)});
  });
  for (int axis = 0; axis < 3; ++axis) {
    axes_[axis] = lines_through(next[axis]);
    broken_[axis] = broken_lines(axes_[axis], partial[axis]);
  }
}

void Lines::Axis::end_line() {
  longest = std::max<std::size_t>(longest, points.size() - start.back());
  start.push_back(static_cast<std::uint32_t>(points.size()));
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
      lines.end_line();
    }
  return lines;
}

Lines::Broken Lines::broken_lines(const Axis& axis, const std::vector<Partial>& partial) {
  Broken broken;
  if (partial.empty())
    return broken;
  std::map<std::uint32_t, double> by_lower;
  for (const Partial& step : partial)
    by_lower.emplace(step.lower, step.phi);
  const auto phi_above = [&](const std::uint32_t point) {
    const auto found = by_lower.find(point);
    return found == by_lower.end() ? 0 : found->second;
  };
  broken.lines.start.push_back(0);
  for (std::size_t l = 0; l + 1 < axis.start.size(); ++l) {
    const std::span points(axis.points.data() + axis.start[l], axis.start[l + 1] - axis.start[l]);
    std::vector<double> levels = {0};
    for (const std::uint32_t p : points)
      levels.push_back(phi_above(p));
    sort_unique(levels);
    if (levels.size() == 1)
      continue;
    for (std::size_t k = 1; k < levels.size(); ++k)
      for (const std::uint32_t p : points) {
        broken.lines.points.push_back(static_cast<std::uint32_t>(broken.point.size()));
        broken.point.push_back(p);
        broken.weight.push_back(levels[k] - levels[k - 1]);
        if (p == points.back() || phi_above(p) >= levels[k])
          broken.lines.end_line();
      }
    for (const std::uint32_t p : points) {
      broken.whole_point.push_back(p);
      broken.whole_weight.push_back(1 - levels.back());
    }
  }
  return broken;
}

void Lines::sum_windows_along(const int along, std::vector<double>& f) const {
  if (n_points() == 0)
    return;
  const Axis& axis = axes_[along];
  const Broken& broken = broken_[along];
  const std::size_t n_lines = axis.start.size() - 1, width = f.size() / n_points();
  const std::size_t worth = n_points() < worth_points ? n_lines + 1 : 2;
  Loan<double> of_broken(width * broken.point.size());
  if (!broken.point.empty()) {
    for (std::size_t i = 0; i < broken.point.size(); ++i)
      std::copy_n(&f[width * broken.point[i]], width, &of_broken[width * i]);
    Loan<double> scratch(2 * width * broken.lines.longest);
    sum_windows({0, broken.lines.start.size() - 1, broken.lines.start.data(), broken.lines.points.data()}, half_width_,
                width, of_broken->data(), scratch->data());
  }
  parallel_ranges(n_lines, worth, [&](const std::size_t first, const std::size_t last) {
    Loan<double> scratch(2 * width * axis.longest);
    sum_windows({first, last, axis.start.data(), axis.points.data()}, half_width_, width, f.data(), scratch->data());
  });
  for (std::size_t i = 0; i < broken.whole_point.size(); ++i)
    for (std::size_t k = 0; k < width; ++k)
      f[width * broken.whole_point[i] + k] *= broken.whole_weight[i];
  for (std::size_t i = 0; i < broken.point.size(); ++i)
    for (std::size_t k = 0; k < width; ++k)
      f[width * broken.point[i] + k] += broken.weight[i] * of_broken[width * i + k];
}

void Lines::sum_over_regions(std::vector<double>& f) const {
  for (int axis = 0; axis < 3; ++axis)
    sum_windows_along(axis, f);
}

void Lines::sum_over_holders(std::vector<double>& f) const {
  for (int axis = 3; axis-- > 0;)
    sum_windows_along(axis, f);
}

} // namespace kerf::lattice
