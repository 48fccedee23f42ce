#include "visibility/front.h"

#include "base/union_find.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <map>
#include <tuple>

namespace kerf::visibility {

namespace {

struct Weld {
  std::vector<Triangle> triangles; // one a face
  std::uint32_t n_vertices = 0;
};

Weld weld(const std::vector<Face>& faces) {
  using Key = std::tuple<double, double, double>;
  std::map<Key, std::uint32_t> vertices;
  Weld welded;
  for (const Face& face : faces) {
    Triangle& t = welded.triangles.emplace_back();
    for (int i = 0; i < 3; ++i)
      t[i] = vertices.try_emplace({face[i][0], face[i][1], face[i][2]}, vertices.size()).first->second;
  }
  welded.n_vertices = static_cast<std::uint32_t>(vertices.size());
  return welded;
}

std::vector<std::uint32_t> sheets(const Weld& welded) {
  UnionFind sets(welded.n_vertices);
  for (const Triangle& t : welded.triangles) {
    sets.unite(t[0], t[1]);
    sets.unite(t[1], t[2]);
  }
  std::vector<std::uint32_t> sheet;
  for (const Triangle& t : welded.triangles)
    sheet.push_back(sets.root(t[0]));
  return sheet;
}

/// An edge of a face: its ends in increasing order, the face, and its first corner there.
using Use = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, int>;

/// All edges, those of faces with the same three corners once, without edges that have no length.
std::vector<Use> uses(const Weld& welded) {
  std::map<Triangle, std::uint32_t> distinct;
  std::vector<Use> found;
  for (std::uint32_t f = 0; f < welded.triangles.size(); ++f) {
    const Triangle& t = welded.triangles[f];
    Triangle sorted = t;
    std::sort(sorted.begin(), sorted.end());
    if (!distinct.try_emplace(sorted, f).second)
      continue;
    for (int i = 0; i < 3; ++i)
      if (const auto [low, high] = std::minmax(t[i], t[(i + 1) % 3]); low != high)
        found.emplace_back(low, high, f, i);
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<Use> border(const std::vector<Use>& all) {
  const auto same = [](const Use& a, const Use& b) {
    return std::get<0>(a) == std::get<0>(b) && std::get<1>(a) == std::get<1>(b);
  };
  std::vector<Use> single;
  for (std::size_t i = 0; i < all.size(); ++i)
    if ((i == 0 || !same(all[i - 1], all[i])) && (i + 1 == all.size() || !same(all[i], all[i + 1])))
      single.push_back(all[i]);
  return single;
}

bool open(const FrontEdge& edge, const Vec3& normal, const CutFaces& cut) {
  const double reach = 1e-6 * edge.length();
  const Vec3 middle = 0.5 * edge.from + 0.5 * edge.to, inside = middle - reach * edge.outwards,
             outside = middle + reach * edge.outwards;
  return !cut.separates(inside + reach * normal, outside) && !cut.separates(outside, inside - reach * normal);
}

std::vector<FrontEdge> open_edges(const CutFaces& cut, const std::vector<std::uint32_t>& sheet) {
  std::vector<FrontEdge> edges;
  for (const auto& [low, high, face, i] : border(uses(weld(cut.all())))) {
    const Face& f = cut.all()[face];
    const Vec3 normal = (f[1] - f[0]).cross(f[2] - f[0]).stableNormalized();
    const Vec3 &from = f[i], &to = f[(i + 1) % 3];
    const FrontEdge edge{from, to, (to - from).cross(normal).stableNormalized(), sheet[face]};
    if (edge.outwards.squaredNorm() > 0.5 && open(edge, normal, cut))
      edges.push_back(edge);
  }
  return edges;
}

std::vector<Box> boxes_of(const std::vector<FrontEdge>& edges) {
  std::vector<Box> boxes;
  for (const FrontEdge& edge : edges)
    boxes.push_back({edge.from.cwiseMin(edge.to), edge.from.cwiseMax(edge.to)});
  return boxes;
}

} // namespace

Front::Front(const CutFaces& cut) : edges_(), sheet_(sheets(weld(cut.all()))), tree_({}) {
  edges_ = open_edges(cut, sheet_);
  tree_ = geometry::BoxTree(boxes_of(edges_));
}

std::vector<std::uint32_t> Front::near(const Box& box) const {
  std::vector<std::uint32_t> found;
  tree_.for_each(box, [&](const std::uint32_t i) { found.push_back(i); });
  std::sort(found.begin(), found.end());
  return found;
}

} // namespace kerf::visibility
