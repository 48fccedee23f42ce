#include "pba/sampling.h"

#include "base/error.h"

#include <cmath>
#include <random>
#include <unordered_map>

namespace kerf::pba {

namespace {

using Inside = std::function<bool(const Vec3&)>;

class Random {
 public:
  explicit Random(const int seed) : engine_(static_cast<std::uint64_t>(seed)) {}

  /// In [0, 1).
  Vec3 point() {
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis)
      p[axis] = static_cast<double>(engine_() >> 11) * 0x1p-53;
    return p;
  }

 private:
  std::mt19937_64 engine_;
};

Points jittered_grid(const Box& box, const Inside& inside, const SamplingOptions& options) {
  Random random(options.seed);
  const double s = options.spacing;
  const Vec3 size = box.upper - box.lower;
  const Vec3 n = (size / s - Vec3::Constant(1e-9)).array().ceil().cwiseMax(1); // a box of n spacings has n, not n + 1
  const Vec3 first = 0.5 * (box.lower + box.upper - s * n) + Vec3::Constant(0.5 * s);
  Points points;
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) {
        const Vec3 shift = options.jitter * (random.point() - Vec3::Constant(0.5));
        const Vec3 p = first + s * (Vec3(i, j, k) + shift);
        if (inside(p))
          points.push_back(p);
      }
  return points;
}

/// Points that keep a distance of `radius`, in cubes that hold at most one of them.
class Darts {
 public:
  Darts(const Box& box, const double radius) : lower_(box.lower), radius_(radius), cell_(radius / std::sqrt(3.0)) {}

  bool is_free(const Vec3& p) const {
    const Index3 c = cube(p);
    for (int k = -2; k <= 2; ++k)
      for (int j = -2; j <= 2; ++j)
        for (int i = -2; i <= 2; ++i) {
          const auto it = at_.find(key({c[0] + i, c[1] + j, c[2] + k}));
          if (it != at_.end() && (points_[it->second] - p).squaredNorm() < radius_ * radius_)
            return false;
        }
    return true;
  }

  void add(const Vec3& p) {
    at_[key(cube(p))] = points_.size();
    points_.push_back(p);
  }

  const Points& points() const { return points_; }

 private:
  Index3 cube(const Vec3& p) const {
    const Vec3 c = ((p - lower_) / cell_).array().floor();
    return {static_cast<int>(c[0]) + 2, static_cast<int>(c[1]) + 2, static_cast<int>(c[2]) + 2};
  }
  static std::uint64_t key(const Index3& c) {
    return static_cast<std::uint64_t>(c[0]) | static_cast<std::uint64_t>(c[1]) << 21 |
           static_cast<std::uint64_t>(c[2]) << 42;
  }

  Vec3 lower_;
  double radius_, cell_;
  Points points_;
  std::unordered_map<std::uint64_t, std::size_t> at_;
};

Points poisson_disk(const Box& box, const Inside& inside, const SamplingOptions& options) {
  constexpr double tries = 60; // darts for each point expected; more find hardly any room
  constexpr double radius =
    0.88; // over the spacing: then about one point a spacing cubed is left (1020 in a box of 1000)
  Random random(options.seed);
  Darts darts(box, radius * options.spacing);
  const Vec3 size = box.upper - box.lower;
  const double n = std::ceil(tries * size.prod() / std::pow(options.spacing, 3));
  for (double dart = 0; dart < n; ++dart) {
    const Vec3 p = box.lower + size.cwiseProduct(random.point());
    if (darts.is_free(p) && inside(p))
      darts.add(p);
  }
  return darts.points();
}

} // namespace

Points sample(const Box& box, const std::function<bool(const Vec3&)>& inside, const SamplingOptions& options) {
  if (!(options.spacing > 0))
    throw ParameterError({.path = "Spacing [m]", .value = to_text(options.spacing), .rule = "must be > 0"});
  if (options.distribution == "jittered grid")
    return jittered_grid(box, inside, options);
  if (options.distribution == "Poisson disk")
    return poisson_disk(box, inside, options);
  throw ParameterError(
    {.path = "Distribution", .value = options.distribution, .rule = "must be one of jittered grid, Poisson disk"});
}

} // namespace kerf::pba
