#include "fem/level.h"

#include "grid/cube.h"

#include <Eigen/LU>

#include <algorithm>
#include <map>
#include <tuple>

namespace kerf::fem {

namespace {

constexpr std::size_t worth = 8192; // corners from which on a second thread pays

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

/// Steps d = before d + after D^-1 r of a Chebyshev polynomial, small on [lower, upper].
struct ChebyshevStep {
  float before, after;
};
constexpr int n_steps = 3;
std::array<ChebyshevStep, n_steps> chebyshev_steps(const double lower, const double upper) {
  const double middle = (upper + lower) / 2, half = (upper - lower) / 2, sigma = middle / half;
  std::array<ChebyshevStep, n_steps> steps;
  double rho = 1 / sigma;
  steps[0] = {0, float(1 / middle)};
  for (int k = 1; k < n_steps; ++k) {
    const double next = 1 / (2 * sigma - rho);
    steps[k] = {float(next * rho), float(2 * next / half)};
    rho = next;
  }
  return steps;
}
std::array<ChebyshevStep, n_steps> chebyshev_steps(const double bound) {
  constexpr double part = 1.0 / 16; // of the spectrum's range that the coarse level sees to
  return chebyshev_steps(part * bound, bound);
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

std::vector<GhostLine> coarsened(const std::span<const GhostLine> fine, const CellsOfLevel& cells,
                                 const Coarsening& coarsening) {
  std::map<std::tuple<std::uint32_t, std::uint32_t, int, int>, double> stiffness; // by copies, axis, vertex
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
        stiffness[{lower, upper, line.axis, vertex}] += 0.25 * weight * line.stiffness;
    }
  }
  std::vector<GhostLine> lines;
  for (const auto& [key, k] : stiffness) {
    const auto& [lower, upper, axis, vertex] = key;
    const std::uint32_t* const below = coarsening.coarse.corners.data() + 8 * std::size_t(lower);
    const std::uint32_t* const above = coarsening.coarse.corners.data() + 8 * std::size_t(upper);
    lines.push_back({lower, upper, axis, vertex, below[vertex ^ 1 << axis], below[vertex], above[vertex], k});
  }
  return lines;
}

void Level::resize() {
  for (auto* const values : {&r, &x, &d, &t})
    values->assign(batching.n_rows(), {});
  mass.resize(n_corners());
}

template <class Function>
void Level::for_each_corner(const Function& f) const {
  parallel_for(n_corners(), f, worth);
}

void Level::make_diagonal() {
  const float penalty = std::max(1.f, float(3 / bound)); // a line alone has the eigenvalue 3
  diagonal.assign(2 * batching.n_rows(), {});
  add_diagonal(batching, elements, diagonal.data());
  const auto add = [&](const std::uint32_t corner, const double value) {
    FloatRow& row = diagonal[2 * std::size_t(corner)];
    const float k = penalty * float(value);
    row.x += k;
    row.y += k;
    row.z += k;
  };
  for (const GhostLine& line : lines) {
    add(line.a, line.stiffness);
    add(line.b, 4 * line.stiffness);
    add(line.c, line.stiffness);
  }
}

Mat3 Level::inverse_block(const std::size_t corner) const { return block_of(&inverse[2 * corner]); }
void Level::put_inverse_block(const std::size_t corner, const Mat3& block) { put_block(block, &inverse[2 * corner]); }

void Level::invert_diagonal(const std::function<Mat3(std::uint32_t corner, const Mat3& block)>& inverse_where_held) {
  inverse.resize(2 * n_corners());
  for_each_corner([&](const std::size_t i) {
    put_inverse_block(i, block_of(&diagonal[2 * i]) + double(mass[i]) * Mat3::Identity());
  });
  const auto add = [&](const std::uint32_t corner, const Mat3& block) {
    put_inverse_block(corner, inverse_block(corner) + block);
  };
  for (const Spring& spring : springs)
    add(spring.corner, spring.block);
  clusters = Clusters(points, n_corners());
  clusters.add_bound(points, add);
  std::map<std::uint32_t, Mat3> free;
  std::vector<Spring> where_held;
  for (const Spring& one : held) {
    free[one.corner] = one.block;
    where_held.push_back({one.corner, inverse_where_held(one.corner, inverse_block(one.corner))});
  }
  clusters.invert([&](const std::uint32_t corner) { return inverse_block(corner); },
                  [&](const std::uint32_t corner) {
                    const auto it = free.find(corner);
                    return it == free.end() ? Mat3(Mat3::Identity()) : it->second;
                  });
  for_each_corner([&](const std::size_t i) { put_inverse_block(i, fem::inverse(inverse_block(i))); });
  for (const Spring& one : where_held)
    put_inverse_block(one.corner, one.block);
  clusters.for_each(
    [](std::uint32_t) { return Eigen::Vector3f::Zero(); },
    [&](const std::uint32_t corner, const Eigen::Vector3f&) { put_inverse_block(corner, Mat3::Zero()); });
}

/// t += A d but for the masses.
void Level::add_products() {
  add_product(batching, elements, d.data(), t.data());
  for (const GhostLine& line : lines) {
    const FloatRow &a = d[line.a], &b = d[line.b], &c = d[line.c];
    const auto k = float(line.stiffness);
    const FloatRow f = {k * (a.x - 2 * b.x + c.x), k * (a.y - 2 * b.y + c.y), k * (a.z - 2 * b.z + c.z)};
    const auto add = [&f](FloatRow& row, const float times) {
      row.x += times * f.x;
      row.y += times * f.y;
      row.z += times * f.z;
    };
    add(t[line.a], 1);
    add(t[line.b], -2);
    add(t[line.c], 1);
  }
  for (std::size_t i = 0; i < points.blocks.size(); ++i) {
    Eigen::Vector3f u = Eigen::Vector3f::Zero();
    const auto for_each = [&](const auto& function) {
      for (std::uint32_t k = points.rows.begin[i]; k < points.rows.begin[i + 1]; ++k)
        function(points.rows.column[k], points.rows.weight[k]);
    };
    for_each([&](const std::uint32_t corner, const float w) {
      u += w * Eigen::Vector3f(d[corner].x, d[corner].y, d[corner].z);
    });
    const Eigen::Vector3f f = points.blocks[i] * u;
    for_each([&](const std::uint32_t corner, const float w) {
      t[corner].x += w * f.x();
      t[corner].y += w * f.y();
      t[corner].z += w * f.z();
    });
  }
  for (const Spring& spring : springs) {
    FloatRow& row = t[spring.corner];
    const FloatRow& of = d[spring.corner];
    const Eigen::Vector3f f = spring.block.cast<float>() * Eigen::Vector3f(of.x, of.y, of.z);
    row.x += f.x();
    row.y += f.y();
    row.z += f.z();
  }
}

namespace {

/// D^-1 r.
FloatRow product(const FloatRow* const inverse, const FloatRow& r) {
  const FloatRow &d = inverse[0], &s = inverse[1];
  return {d.x * r.x + s.x * r.y + s.z * r.z, s.x * r.x + d.y * r.y + s.y * r.z, s.z * r.x + s.y * r.y + d.z * r.z};
}
FloatRow difference(const FloatRow& a, const FloatRow& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
FloatRow sum(const FloatRow& a, const FloatRow& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
FloatRow scaled(const float s, const FloatRow& a) { return {s * a.x, s * a.y, s * a.z}; }

} // namespace

/// What a step does at the corners of clusters, by their own blocks.
void Level::add_of_clusters(const float after) {
  clusters.for_each([&](const std::uint32_t corner) { return Eigen::Vector3f(r[corner].x, r[corner].y, r[corner].z); },
                    [&](const std::uint32_t corner, const Eigen::Vector3f& v) {
                      const FloatRow step = {after * v.x(), after * v.y(), after * v.z()};
                      d[corner] = sum(d[corner], step);
                      x[corner] = sum(x[corner], step);
                      t[corner] = sum(t[corner], scaled(mass[corner], step));
                    });
}

void Level::smooth_from_zero() {
  const auto steps = chebyshev_steps(bound);
  for_each_corner([&](const std::size_t i) {
    d[i] = x[i] = scaled(steps[0].after, product(&inverse[2 * i], r[i]));
    t[i] = scaled(mass[i], d[i]);
  });
  add_of_clusters(steps[0].after);
  for (int k = 1; k < n_steps; ++k) {
    add_products();
    for_each_corner([&](const std::size_t i) {
      r[i] = difference(r[i], t[i]);
      d[i] = sum(scaled(steps[k].before, d[i]), scaled(steps[k].after, product(&inverse[2 * i], r[i])));
      x[i] = sum(x[i], d[i]);
      t[i] = scaled(mass[i], d[i]);
    });
    add_of_clusters(steps[k].after);
  }
  add_products();
  for_each_corner([&](const std::size_t i) { r[i] = difference(r[i], t[i]); });
}

void Level::smooth_after_change() {
  const auto steps = chebyshev_steps(bound);
  for_each_corner([&](const std::size_t i) {
    x[i] = sum(x[i], d[i]);
    t[i] = scaled(mass[i], d[i]);
  });
  for (const ChebyshevStep& step : steps) {
    add_products();
    for_each_corner([&](const std::size_t i) {
      r[i] = difference(r[i], t[i]);
      d[i] = sum(scaled(step.before, d[i]), scaled(step.after, product(&inverse[2 * i], r[i])));
      x[i] = sum(x[i], d[i]);
      t[i] = scaled(mass[i], d[i]);
    });
    add_of_clusters(step.after);
  }
}

} // namespace kerf::fem
