#include "visibility/kernels.h"

namespace kerf::visibility {

namespace {

constexpr int n_faces = 4;           // a batch
constexpr int n_lanes = 2 * n_faces; // each face seen from a, then each seen from b
constexpr int n_rows = 32;
constexpr int n_bounds = 4;    // three edges, and the plane of the disk
constexpr float beyond = 1e6f; // no bound [texels]

/// The corners of a batch of faces, seen from the eye of each lane: [corner][lane].
struct Corners {
  alignas(64) double x[3][n_lanes] = {}, y[3][n_lanes] = {}, w[3][n_lanes] = {};
};

/// What each face of a batch occludes of row y: first + first_slope y <= x <= last + last_slope y [texels], with y from
/// the middle and x from the first texel, for all four bounds: [bound][lane].
struct Bounds {
  alignas(64) float first[n_bounds][n_lanes], first_slope[n_bounds][n_lanes];
  alignas(64) float last[n_bounds][n_lanes], last_slope[n_bounds][n_lanes];
  alignas(64) std::int32_t active[n_lanes];
};

[[gnu::always_inline]] inline void load(const DiskBlock& block, const std::size_t begin, const int n, Corners& c) {
  const double *const m = block.frame, *const to_x = m + 3, *const to_y = m + 6, *const to_z = m + 9;
  for (int f = 0; f < n; ++f) {
    const double* const face = block.faces + 9 * std::size_t(block.which[begin + f]);
    for (int i = 0; i < 3; ++i) {
      const double px = face[3 * i] - m[0], py = face[3 * i + 1] - m[1], pz = face[3 * i + 2] - m[2];
      c.x[i][f] = c.x[i][n_faces + f] = to_x[0] * px + to_x[1] * py + to_x[2] * pz;
      c.y[i][f] = c.y[i][n_faces + f] = to_y[0] * px + to_y[1] * py + to_y[2] * pz;
      const double z = to_z[0] * px + to_z[1] * py + to_z[2] * pz;
      c.w[i][f] = 1 + z;
      c.w[i][n_faces + f] = 1 - z;
    }
  }
}

/// a x + b y + c >= 0 as a bound of x. Where a is next to nothing, all x of a row or none.
[[gnu::always_inline]] inline void set_bound(const double a, const double b, const double c, const double middle,
                                             const int k, const int lane, Bounds& bounds) {
  const double size_a = a < 0 ? -a : a, rest = (b < 0 ? -b : b) + (c < 0 ? -c : c);
  const bool flat = size_a <= 1e-12 * rest;
  const double scale = flat ? -1e12 / rest : -1 / a;
  const float x = float(c * scale + (flat ? 0 : middle)), slope = float(b * scale);
  const bool is_first = flat | (a > 0);
  bounds.first[k][lane] = is_first ? x : -beyond;
  bounds.first_slope[k][lane] = is_first ? slope : 0;
  bounds.last[k][lane] = is_first ? beyond : x;
  bounds.last_slope[k][lane] = is_first ? 0 : slope;
}

[[gnu::always_inline]] inline void find_bounds(const Corners& corners, const double half, const double end,
                                               Bounds& bounds) {
  for (int lane = 0; lane < n_lanes; ++lane) {
    const double x0 = corners.x[0][lane], y0 = corners.y[0][lane], w0 = corners.w[0][lane];
    const double x1 = corners.x[1][lane], y1 = corners.y[1][lane], w1 = corners.w[1][lane];
    const double x2 = corners.x[2][lane], y2 = corners.y[2][lane], w2 = corners.w[2][lane];
    const double ax = y0 * w1 - w0 * y1, ay = w0 * x1 - x0 * w1, az = x0 * y1 - y0 * x1;
    const double bx = y1 * w2 - w1 * y2, by = w1 * x2 - x1 * w2, bz = x1 * y2 - y1 * x2;
    const double cx = y2 * w0 - w2 * y0, cy = w2 * x0 - x2 * w0, cz = x2 * y0 - y2 * x0;
    const double D = x0 * bx + y0 * by + w0 * bz, s = D < 0 ? -1 : 1;
    const double middle = half - 0.5;
    set_bound(s * ax, s * ay, s * az, middle, 0, lane, bounds);
    set_bound(s * bx, s * by, s * bz, middle, 1, lane, bounds);
    set_bound(s * cx, s * cy, s * cz, middle, 2, lane, bounds);
    set_bound(s * (ax + bx + cx), s * (ay + by + cy), s * (az + bz + cz - D / end), middle, 3, lane, bounds);
    const double h0 = half * w0, h1 = half * w1, h2 = half * w2;
    const bool before = (w0 > 0) | (w1 > 0) | (w2 > 0), within = (w0 < end) | (w1 < end) | (w2 < end);
    const bool right = (x0 > h0) & (x1 > h1) & (x2 > h2), left = (-x0 > h0) & (-x1 > h1) & (-x2 > h2);
    const bool above = (y0 > h0) & (y1 > h1) & (y2 > h2), below = (-y0 > h0) & (-y1 > h1) & (-y2 > h2);
    bounds.active[lane] = (D != 0) & before & within & !(right | left | above | below);
  }
}

/// The lowest n bits, n = 0 .. 32.
[[gnu::always_inline]] inline std::uint32_t lowest(const std::int32_t n) { return n > 31 ? ~0u : (1u << (n & 31)) - 1; }

[[gnu::always_inline]] inline void fill(const Bounds& bounds, const int lane, const float half, std::uint32_t* rows) {
  float first[n_bounds], first_slope[n_bounds], last[n_bounds], last_slope[n_bounds];
  for (int k = 0; k < n_bounds; ++k) {
    first[k] = bounds.first[k][lane];
    first_slope[k] = bounds.first_slope[k][lane];
    last[k] = bounds.last[k][lane];
    last_slope[k] = bounds.last_slope[k][lane];
  }
  for (int row = 0; row < n_rows; ++row) {
    const float y = float(row) + 0.5f - half;
    float from = 0, to = 31;
    for (int k = 0; k < n_bounds; ++k) {
      const float a = first[k] + first_slope[k] * y, b = last[k] + last_slope[k] * y;
      from = from > a ? from : a;
      to = to < b ? to : b;
    }
    from = from < 32 ? from : 32;
    to = to > -1 ? to : -1;
    const std::int32_t begin = std::int32_t(from), end = std::int32_t(to);
    rows[row] |= lowest(end + (float(end) <= to)) & ~lowest(begin + (float(begin) < from));
  }
}

} // namespace

__attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"))) void occlude_disk(
  const DiskBlock& block, std::uint32_t* const mask) {
  const double half = 0.5 * block.resolution;
  alignas(64) std::uint32_t rows[n_rows] = {};
  Corners corners;
  Bounds bounds;
  for (std::size_t begin = 0; begin < block.n; begin += n_faces) {
    const int n = block.n - begin < n_faces ? int(block.n - begin) : n_faces;
    load(block, begin, n, corners);
    find_bounds(corners, half, block.end, bounds);
    for (int f = 0; f < n; ++f)
      for (int lane = f; lane < n_lanes; lane += n_faces)
        if (bounds.active[lane])
          fill(bounds, lane, float(half), rows);
  }
  for (int row = 0; row < block.resolution; ++row)
    mask[row] |= rows[row] & block.inside[row];
}

} // namespace kerf::visibility
