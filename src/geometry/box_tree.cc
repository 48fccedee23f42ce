#include "geometry/box_tree.h"

#include <algorithm>
#include <numeric>

namespace kerf::geometry {

namespace {

constexpr std::uint32_t boxes_per_leaf = 8;

Vec3 middle(const Box& box) { return 0.5 * box.lower + 0.5 * box.upper; }

void enlarge(Box& box, const Box& by) {
  box.lower = box.lower.cwiseMin(by.lower);
  box.upper = box.upper.cwiseMax(by.upper);
}

} // namespace

Box box_around(const std::span<const Vec3> points) {
  Box box{points.front(), points.front()};
  for (const Vec3& p : points)
    enlarge(box, {p, p});
  return box;
}

bool overlap(const Box& a, const Box& b) {
  return (a.lower.array() <= b.upper.array()).all() && (b.lower.array() <= a.upper.array()).all();
}

BoxTree::BoxTree(std::vector<Box> boxes) : boxes_(std::move(boxes)), order_(boxes_.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  if (!boxes_.empty())
    build(0, static_cast<std::uint32_t>(boxes_.size()));
}

void BoxTree::build(const std::uint32_t begin, const std::uint32_t end) {
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  Box box = boxes_[order_[begin]];
  Box middles{middle(box), middle(box)};
  for (std::uint32_t i = begin; i < end; ++i) {
    const Box& other = boxes_[order_[i]];
    enlarge(box, other);
    enlarge(middles, {middle(other), middle(other)});
  }
  nodes_.push_back({box, begin, end, 0});
  if (end - begin <= boxes_per_leaf)
    return;
  int axis = 0;
  (middles.upper - middles.lower).maxCoeff(&axis);
  const std::uint32_t half = begin + (end - begin) / 2;
  const auto first = order_.begin();
  std::nth_element(first + begin, first + half, first + end, [&](const std::uint32_t a, const std::uint32_t b) {
    return middle(boxes_[a])[axis] < middle(boxes_[b])[axis];
  });
  build(begin, half);
  nodes_[index].upper = static_cast<std::uint32_t>(nodes_.size());
  build(half, end);
}

} // namespace kerf::geometry
