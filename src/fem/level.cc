#include "fem/level.h"

#include "base/loan.h"
#include "fem/row_of_floats.h"
#include "grid/cube.h"

#include <Eigen/LU>

#include <algorithm>
#include <utility>

namespace kerf::fem {

namespace {

constexpr std::size_t many_corners = 8192; // corners from which on a second thread pays

using FloatRow = Row<float>;

/// A symmetric block from its two rows.
Mat3 block_of(const FloatRow* const rows) {
  const FloatRow &d = rows[0], &s = rows[1];
  Mat3 B;
  B << d.x, s.x, s.z, s.x, d.y, s.y, s.z, s.y, d.z;
  return B;
}
void put_block(const Mat3& B, FloatRow* const rows) {
  rows[0] = {float(B(0, 0)), float(B(1, 1)), float(B(2, 2))};
  rows[1] = {float(B(0, 1)), float(B(1, 2)), float(B(2, 0))};
}

/// Of a positive block; of its size alone where it is no more than semi-definite.
Mat3 inverse(const Mat3& B) {
  constexpr double singular = 1e-9;
  const double size = B.trace() / 3;
  if (!(size > 0))
    return Mat3::Zero();
  return B.determinant() > singular * size * size * size ? Mat3(B.inverse()) : Mat3(Mat3::Identity() / (3 * size));
}

/// Of a Chebyshev polynomial, small on [lower, upper].
struct ChebyshevSteps {
  int n;
  std::array<ChebyshevStep, Level::most_steps> step;

  ChebyshevSteps(const double lower, const double upper, const int n_steps) : n(n_steps) {
    const double middle = (upper + lower) / 2, half = (upper - lower) / 2, sigma = middle / half;
    double rho = 1 / sigma;
    step[0] = {0, float(1 / middle)};
    for (int k = 1; k < n; ++k) {
      const double next = 1 / (2 * sigma - rho);
      step[k] = {float(next * rho), float(2 * next / half)};
      rho = next;
    }
  }
};
ChebyshevSteps chebyshev_steps(const double bound, const int n) {
  // Of the spectrum's range that the coarse level sees to. Of 1/16, 1/30, 1/50, 1/80 with three steps that with the
  // fewest iterations of a liver while it is cut: 6.6, 6.3, 6.3, 6.7 a step.
  const double part = 1.0 / (10 * n);
  return {part * bound, bound, n};
}

} // namespace

std::vector<GhostLine> lines_of(const std::span<const GhostFace> faces) {
  std::vector<GhostLine> lines;
  for (const GhostFace& f : faces)
    for (int i = 0; i < 4; ++i)
      lines.push_back({f.lower.value, f.upper.value, f.axis, grid::cube::face_vertices[2 * f.axis + 1][i], f.a[i],
                       f.b[i], f.c[i], f.stiffness});
  return lines;
}

namespace {

/// Items in the order in which they come, each under a number: found among the few that are under the same one.
class ItemsByNumber {
 public:
  explicit ItemsByNumber(const std::size_t n_numbers) : last_(n_numbers, none) {}

  /// The item of this number for which is_it(item) holds; else a new one, the next.
  template <class IsIt>
  std::uint32_t find_or_add(const std::uint32_t number, const IsIt& is_it) {
    for (std::uint32_t item = last_[number]; item != none; item = before_[item])
      if (is_it(item))
        return item;
    before_.push_back(last_[number]);
    return last_[number] = static_cast<std::uint32_t>(before_.size() - 1);
  }

 private:
  static constexpr std::uint32_t none = 0xffffffff;
  Loan<std::uint32_t> last_;
  std::vector<std::uint32_t> before_; // of each item the one before it under its number
};

} // namespace

std::vector<GhostLine> coarsened(const std::span<const GhostLine> fine, const CellsView& cells,
                                 const Coarsening& coarsening) {
  std::vector<GhostLine> lines;
  ItemsByNumber by_lower(coarsening.coarse.n_copies());
  const auto add = [&](const std::uint32_t lower, const std::uint32_t upper, const int axis, const int vertex,
                       const double stiffness) {
    const std::uint32_t i = by_lower.find_or_add(lower, [&](const std::uint32_t line) {
      return lines[line].upper == upper && lines[line].axis == axis && lines[line].vertex == vertex;
    });
    if (i == lines.size()) {
      const std::uint32_t* const below = coarsening.coarse.corners.data() + 8 * std::size_t(lower);
      const std::uint32_t* const above = coarsening.coarse.corners.data() + 8 * std::size_t(upper);
      lines.push_back({lower, upper, axis, vertex, below[vertex ^ 1 << axis], below[vertex], above[vertex], 0});
    }
    lines[i].stiffness += stiffness;
  };
  for (const GhostLine& line : fine) {
    const std::uint32_t lower = coarsening.parent[line.lower], upper = coarsening.parent[line.upper];
    if (lower == upper)
      continue;
    const int j = (line.axis + 1) % 3, k = (line.axis + 2) % 3, bit = 1 << line.axis;
    const auto halves = [&](const int axis) { return (cells.place[line.lower][axis] & 1) + (line.vertex >> axis & 1); };
    for (const int vertex : {bit, bit | 1 << j, bit | 1 << k, bit | 1 << j | 1 << k}) {
      const double weight = 0.25 * ((vertex >> j & 1) != 0 ? halves(j) : 2 - halves(j)) *
                            ((vertex >> k & 1) != 0 ? halves(k) : 2 - halves(k));
      if (weight > 0)
        add(lower, upper, line.axis, vertex, 0.25 * weight * line.stiffness);
    }
  }
  return lines;
}

/// The two corners of a tie are one node, so they lie among the same coarse nodes, which come in the same order; those
/// of crumbs (grid/crumbs.h) among none.
std::vector<Tie> coarsened(const std::span<const Tie> fine, const Coarsening& coarsening) {
  std::vector<Tie> ties;
  ItemsByNumber by_corner(coarsening.coarse.n_corners);
  for (const Tie& tie : fine) {
    std::array<std::uint32_t, 8> of_b;
    std::size_t n = 0, i = 0;
    coarsening.for_each_weight(tie.b, [&](const std::uint32_t corner, float) { of_b[n++] = corner; });
    coarsening.for_each_weight(tie.a, [&](const std::uint32_t corner, const float weight) {
      if (i < n && corner != of_b[i]) {
        const std::uint32_t k =
          by_corner.find_or_add(corner, [&](const std::uint32_t other) { return ties[other].b == of_b[i]; });
        if (k == ties.size())
          ties.push_back({corner, of_b[i], 0});
        ties[k].stiffness += double(weight) * tie.stiffness;
      }
      ++i;
    });
  }
  return ties;
}

void Level::resize() {
  for (auto* const values : {&r_, &d_, &t_})
    values->assign(n_rows(), {});
  mass.resize(n_corners);
  lines_of_product_.clear();
  for (const GhostLine& line : lines)
    lines_of_product_.push_back({line.a, line.b, line.c, float(line.stiffness)});
}

template <class Function>
void Level::for_each_corner(const Function& f) const {
  parallel_for(n_corners, f, many_corners);
}

void Level::make_diagonal() {
  diagonal = std::move(inverse);
  diagonal.assign(2 * n_rows(), {});
  add_diagonal(*batching, elements, diagonal.data());
  add_penalties_to_diagonal();
}

void Level::make_diagonal(std::vector<FloatRow> of_elements) {
  diagonal = std::move(of_elements);
  add_excess_diagonal(*batching, elements, diagonal.data());
  add_penalties_to_diagonal();
}

void Level::add_penalties_to_diagonal() {
  const auto weight = [&](const double alone) { return std::max(1.0, alone / bound); };
  const double of_line = weight(3), of_tie = weight(2); // eigenvalues of one alone
  const auto add = [&](const std::uint32_t corner, const double value) {
    FloatRow& row = diagonal[2 * std::size_t(corner)];
    const auto k = float(value);
    row.x += k;
    row.y += k;
    row.z += k;
  };
  for (const GhostLine& line : lines) {
    add(line.a, of_line * line.stiffness);
    add(line.b, of_line * 4 * line.stiffness);
    add(line.c, of_line * line.stiffness);
  }
  for (const Tie& tie : ties) {
    add(tie.a, of_tie * tie.stiffness);
    add(tie.b, of_tie * tie.stiffness);
  }
}

Mat3 Level::inverse_block(const std::size_t corner) const { return block_of(&inverse[2 * corner]); }
void Level::put_inverse_block(const std::size_t corner, const Mat3& block) { put_block(block, &inverse[2 * corner]); }

void Level::invert_diagonal(const std::function<Mat3(std::uint32_t corner, const Mat3& block)>& inverse_where_held) {
  inverse = std::move(diagonal);
  for_each_corner(
    [&](const std::size_t i) { put_inverse_block(i, inverse_block(i) + double(mass[i]) * Mat3::Identity()); });
  const auto add = [&](const std::uint32_t corner, const Mat3& block) {
    put_inverse_block(corner, inverse_block(corner) + block);
  };
  for (const Spring& spring : springs)
    add(spring.corner, spring.block);
  if (!points.empty() || !clusters.empty())
    clusters = Clusters(points, n_corners);
  clusters.add_bound(points, add);
  Loan<Spring> where_held;
  for (const Spring& one : held)
    where_held->push_back({one.corner, inverse_where_held(one.corner, inverse_block(one.corner))});
  clusters.invert([&](const std::uint32_t corner) { return inverse_block(corner); },
                  [&](const std::uint32_t corner) {
                    const auto it = std::ranges::lower_bound(held, corner, {}, &Spring::corner);
                    return it == held.end() || it->corner != corner ? Mat3(Mat3::Identity()) : it->block;
                  });
  for_each_corner([&](const std::size_t i) { put_inverse_block(i, fem::inverse(inverse_block(i))); });
  for (const Spring& one : *where_held)
    put_inverse_block(one.corner, one.block);
  clusters.for_each(
    [](std::uint32_t) { return Eigen::Vector3f::Zero(); },
    [&](const std::uint32_t corner, const Eigen::Vector3f&) { put_inverse_block(corner, Mat3::Zero()); });
}

/// y += A x but for the masses.
void Level::add_products(const FloatRow* const x, FloatRow* const y) const {
  add_product(*batching, elements, x, y);
  for (const LineOfProduct& line : lines_of_product_) {
    const Four f = line.stiffness * (load(x[line.a]) - 2 * load(x[line.b]) + load(x[line.c]));
    add(y[line.a], f);
    add(y[line.b], -2 * f);
    add(y[line.c], f);
  }
  for (const Tie& tie : ties) {
    const Four f = float(tie.stiffness) * (load(x[tie.a]) - load(x[tie.b]));
    add(y[tie.a], f);
    add(y[tie.b], -f);
  }
  for (std::size_t i = 0; i < points.blocks.size(); ++i) {
    Eigen::Vector3f u = Eigen::Vector3f::Zero();
    const auto for_each = [&](const auto& function) {
      for (std::uint32_t k = points.rows.start[i]; k < points.rows.start[i + 1]; ++k)
        function(points.rows.columns[k], points.rows.values[k]);
    };
    for_each([&](const std::uint32_t corner, const float w) {
      u += w * Eigen::Vector3f(x[corner].x, x[corner].y, x[corner].z);
    });
    const Eigen::Vector3f f = points.blocks[i] * u;
    for_each([&](const std::uint32_t corner, const float w) {
      y[corner].x += w * f.x();
      y[corner].y += w * f.y();
      y[corner].z += w * f.z();
    });
  }
  for (const Spring& spring : springs) {
    FloatRow& row = y[spring.corner];
    const FloatRow& of = x[spring.corner];
    const Eigen::Vector3f f = spring.block.cast<float>() * Eigen::Vector3f(of.x, of.y, of.z);
    row.x += f.x();
    row.y += f.y();
    row.z += f.z();
  }
}

namespace {

/// D^-1 r.
Four product(const FloatRow* const inverse, const Four& r) {
  const Four diagonal = load(inverse[0]), beside = load(inverse[1]); // xy, yz, zx
  return diagonal * r + beside * __builtin_shufflevector(r, r, 1, 2, 0, 3) +
         __builtin_shufflevector(beside, beside, 2, 0, 1, 3) * __builtin_shufflevector(r, r, 2, 0, 1, 3);
}

} // namespace

/// What a step does at the corners of clusters, by their own blocks.
void Level::add_of_clusters(const float after, FloatRow* const x) {
  clusters.for_each(
    [&](const std::uint32_t corner) { return Eigen::Vector3f(r_[corner].x, r_[corner].y, r_[corner].z); },
    [&](const std::uint32_t corner, const Eigen::Vector3f& v) {
      const Four step = {after * v.x(), after * v.y(), after * v.z(), 0};
      add(d_[corner], step);
      add(x[corner], step);
      add(t_[corner], mass[corner] * step);
    });
}

/// r = b - t, d = after D^-1 r, x += d, t = M d for the first step, r -= A d, d = before d + after D^-1 r, x += d for
/// each other one. From zero, x and t are not looked at.
template <bool from_zero>
void Level::take_steps(const FloatRow* const b, FloatRow* const x) {
  const auto [n, step] = chebyshev_steps(bound, n_steps);
  for_each_corner([&](const std::size_t i) {
    const Four left = from_zero ? load(b[i]) : load(b[i]) - load(t_[i]),
               change = step[0].after * product(&inverse[2 * i], left);
    store(r_[i], left);
    store(d_[i], change);
    store(x[i], from_zero ? change : load(x[i]) + change);
    store(t_[i], mass[i] * change);
  });
  add_of_clusters(step[0].after, x);
  for (int k = 1; k < n; ++k) {
    add_products(d_.data(), t_.data());
    const bool is_last = k + 1 == n && clusters.empty();
    for_each_corner([&](const std::size_t i) {
      const Four left = load(r_[i]) - load(t_[i]),
                 change = step[k].before * load(d_[i]) + step[k].after * product(&inverse[2 * i], left);
      add(x[i], change);
      if (is_last)
        return;
      store(r_[i], left);
      store(d_[i], change);
      store(t_[i], mass[i] * change);
    });
    add_of_clusters(step[k].after, x);
  }
}

void Level::smooth_from_zero(const FloatRow* const b, FloatRow* const x) {
  std::fill(x + n_corners, x + n_rows(), FloatRow{});
  take_steps<true>(b, x);
}

void Level::smooth(const FloatRow* const b, FloatRow* const x) {
  multiply(x, t_.data());
  take_steps<false>(b, x);
}

void Level::multiply(const FloatRow* const x, FloatRow* const y) {
  for_each_corner([&](const std::size_t i) { store(y[i], mass[i] * load(x[i])); });
  std::fill(y + n_corners, y + n_rows(), FloatRow{});
  add_products(x, y);
  project(y);
}

void Level::project(FloatRow* const rows) const {
  for (const Spring& one : held) {
    FloatRow& row = rows[one.corner];
    const Eigen::Vector3f v = one.block.cast<float>() * Eigen::Vector3f(row.x, row.y, row.z);
    row = {v.x(), v.y(), v.z()};
  }
}

} // namespace kerf::fem
