#include "visibility/field.h"

#include "pba/kernel.h"
#include "visibility/pair_sights.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kerf::visibility {

namespace {

constexpr std::size_t everything = std::numeric_limits<std::size_t>::max();

double weight(const PairSights& sights, const PairId pair) {
  return pba::weight(sights.sights()[pair], sights.pairs()[pair].support);
}

/// Computed from the whole number, so that neighbouring parts have the same corners.
double part_of_way(const double from, const double to, const int i, const int n) {
  return i == n ? to : from + (to - from) * i / n;
}

} // namespace

std::vector<double> weight_field(const CriterionChoice& choice, const std::span<const Face> cut, const Vec3& from,
                                 const double support, const Plane& plane) {
  std::vector<Pair> pairs;
  for (int j = 0; j < plane.n_v; ++j)
    for (int i = 0; i < plane.n_u; ++i)
      pairs.push_back({from, plane.origin + (i + 0.5) * plane.step_u + (j + 0.5) * plane.step_v, support});
  PairSights sights(make_criterion(choice));
  sights.watch(PairId(0), pairs);
  sights.add_faces(cut);
  sights.update(everything);
  std::vector<double> weights;
  for (const auto pair : ids<PairId>(pairs.size()))
    weights.push_back(weight(sights, pair));
  return weights;
}

std::vector<double> weight_history(const CriterionChoice& choice, const std::span<const std::vector<Face>> parts,
                                   const Pair& pair) {
  PairSights sights(make_criterion(choice));
  sights.watch(PairId(0), {&pair, 1});
  std::vector<double> weights = {weight(sights, PairId(0))};
  for (const std::vector<Face>& part : parts) {
    sights.add_faces(part);
    sights.update(everything);
    weights.push_back(weight(sights, PairId(0)));
  }
  return weights;
}

double largest_jump(const std::span<const double> weights) {
  double largest = 0;
  for (std::size_t i = 1; i < weights.size(); ++i)
    largest = std::max(largest, std::abs(weights[i] - weights[i - 1]));
  return largest;
}

std::vector<Face> strip(const double from_x, const double to_x, const double half_depth, const double height) {
  const Vec3 a(from_x, -half_depth, height), b(to_x, -half_depth, height), c(to_x, half_depth, height),
    d(from_x, half_depth, height);
  return {{a, b, c}, {a, c, d}};
}

std::vector<std::vector<Face>> growing_strip(const double from_x, const double to_x, const int n,
                                             const double half_depth, const double height) {
  std::vector<std::vector<Face>> parts;
  for (int i = 0; i < n; ++i)
    parts.push_back(strip(part_of_way(from_x, to_x, i, n), part_of_way(from_x, to_x, i + 1, n), half_depth, height));
  return parts;
}

std::vector<std::vector<Face>> merging_strips(const double far, const int n, const double half_depth,
                                              const double height) {
  std::vector<std::vector<Face>> parts = growing_strip(-far, 0, n, half_depth, height);
  const std::vector<std::vector<Face>> right = growing_strip(far, 0, n, half_depth, height);
  for (int i = 0; i < n; ++i)
    parts[i].insert(parts[i].end(), right[i].begin(), right[i].end());
  return parts;
}

} // namespace kerf::visibility
