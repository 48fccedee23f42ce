#include "visibility/paths.h"

#include "base/parallel.h"
#include "geometry/predicates.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kerf::visibility {

namespace {

constexpr std::size_t worth_a_thread = 16;

/// Around all points x with |ax| + |xb| <= length: an ellipsoid of revolution; around the segment if there are none.
Box box_of_paths(const Vec3& a, const Vec3& b, const double length) {
  const Vec3 ab = b - a, middle = 0.5 * a + 0.5 * b;
  const double distance = ab.norm(), major2 = 0.25 * std::max(length, distance) * std::max(length, distance),
               minor2 = major2 - 0.25 * distance * distance;
  const Eigen::Array3d n = ab.array() / (distance > 0 ? distance : 1);
  const Vec3 half = (major2 * n.square() + minor2 * (1 - n.square()).max(0)).sqrt().matrix();
  return {middle - half, middle + half};
}

Box grown(const Box& box, const double by) { return {box.lower.array() - by, box.upper.array() + by}; }

Vec3 nearest(const Vec3& p, const FrontEdge& edge) {
  const Vec3 along = edge.to - edge.from;
  return edge.from + std::clamp((p - edge.from).dot(along) / along.squaredNorm(), 0., 1.) * along;
}

void follow(const CutFaces& cut, std::optional<Front>& front, std::size_t& n_faces) {
  if (front && n_faces == cut.all().size())
    return;
  front.emplace(cut);
  n_faces = cut.all().size();
}

/// A pair that is not crossed stays so unless the face crosses it; the way around changes with everything near it.
bool may_change(const Pair& pair, const pba::Sight& sight, const Face& face) {
  return sight.distance > (pair.b - pair.a).norm() || geometry::crosses(pair.a, pair.b, face);
}

/// The distance of a crossed pair is always longer than s0, even by a bit: may_change() tells it by this.
pba::Sight lengthened(const double s0, const double distance) {
  return {std::max(distance, std::nextafter(s0, std::numeric_limits<double>::infinity())), 1};
}

struct Path {
  double length;
  Vec3 bend; // just outside of the front
};

/// The paths around single edges within the support, shortest first.
std::vector<Path> paths(const Front& front, const Pair& pair) {
  constexpr double outside = 1e-6; // of the edge's length: clear of the edge's own face
  std::vector<Path> found;
  for (const std::uint32_t i : front.near(box_of_paths(pair.a, pair.b, pair.support))) {
    const FrontEdge& edge = front.edges()[i];
    const Vec3 x = bend(pair.a, pair.b, edge.from, edge.to);
    const double length = (x - pair.a).norm() + (pair.b - x).norm();
    if (length < pair.support)
      found.push_back({length, x + outside * edge.length() * edge.outwards});
  }
  std::stable_sort(found.begin(), found.end(), [](const Path& p, const Path& q) { return p.length < q.length; });
  return found;
}

} // namespace

Vec3 bend(const Vec3& a, const Vec3& b, const Vec3& from, const Vec3& to) {
  const Vec3 edge = to - from;
  const double length2 = edge.squaredNorm(), at_a = (a - from).dot(edge) / length2,
               at_b = (b - from).dot(edge) / length2;
  const double from_a = (a - from - at_a * edge).norm(), from_b = (b - from - at_b * edge).norm();
  // Both on the line of the edge: any point between them will do.
  const double at = from_a + from_b > 0 ? (at_a * from_b + at_b * from_a) / (from_a + from_b) : at_a;
  return from + std::clamp(at, 0., 1.) * edge;
}

bool Diffraction::concerns(const Pair& pair, const pba::Sight& sight, const Face& face) const {
  return may_change(pair, sight, face);
}

Box Diffraction::reach(const Pair& pair) const { return box_of_paths(pair.a, pair.b, pair.support); }

pba::Sight Diffraction::sight(const CutFaces& cut, const Pair& pair) const {
  const double s0 = (pair.b - pair.a).norm();
  if (!cut.separates(pair.a, pair.b))
    return {s0, 1};
  for (const auto& [length, bend] : paths(*front_, pair))
    if (!cut.separates(pair.a, bend) && !cut.separates(bend, pair.b))
      return lengthened(s0, std::pow(length / s0, gamma_) * s0);
  return {s0, 0};
}

void Diffraction::look(const CutFaces& cut, const Table<PairId, Pair>& pairs, const std::span<const Work> works,
                       Sights& sights) {
  follow(cut, front_, n_faces_);
  parallel_for(
    works.size(), [&](const std::size_t i) { sights[works[i].pair] = sight(cut, pairs[works[i].pair]); },
    worth_a_thread);
}

bool Transparency::concerns(const Pair& pair, const pba::Sight& sight, const Face& face) const {
  return may_change(pair, sight, face);
}

Box Transparency::reach(const Pair& pair) const {
  return grown({pair.a.cwiseMin(pair.b), pair.a.cwiseMax(pair.b)}, (pair.b - pair.a).norm());
}

pba::Sight Transparency::sight(const CutFaces& cut, const Pair& pair) const {
  const double s0 = (pair.b - pair.a).norm();
  const std::vector<std::uint32_t> faces = cut.crossed(pair.a, pair.b);
  double farthest = 0;
  for (const std::uint32_t face : faces) {
    const double t = geometry::crossing_parameter(pair.a, pair.b, cut.all()[face]);
    const Vec3 x = pair.a + t * (pair.b - pair.a);
    double s_c = s0;
    for (const std::uint32_t i : front_->near(grown({x, x}, s0)))
      if (front_->edges()[i].sheet == front_->sheet(face))
        s_c = std::min(s_c, (nearest(x, front_->edges()[i]) - x).norm());
    farthest = std::max(farthest, s_c);
  }
  if (faces.empty())
    return {s0, 1};
  if (farthest >= s0)
    return {s0, 0};
  return lengthened(s0, s0 + pair.support * std::pow(farthest / s0, gamma_));
}

void Transparency::look(const CutFaces& cut, const Table<PairId, Pair>& pairs, const std::span<const Work> works,
                        Sights& sights) {
  follow(cut, front_, n_faces_);
  parallel_for(
    works.size(), [&](const std::size_t i) { sights[works[i].pair] = sight(cut, pairs[works[i].pair]); },
    worth_a_thread);
}

} // namespace kerf::visibility
