#include "cut/embed.h"

#include "base/error.h"
#include "base/parallel.h"
#include "geometry/normals.h"
#include "geometry/predicates.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <tuple>

namespace kerf::cut {
namespace {

constexpr int index_bits = 20; // the grid's limit
constexpr std::size_t triangles_per_chunk = 2048;

/// An edge of the lattice, stored or not; ordered by axis, then line by line, then upwards.
struct LatticeEdge {
  int axis = 0;
  Index3 lower{};

  std::uint64_t key() const {
    const int i = (axis + 1) % 3, j = (axis + 2) % 3;
    std::uint64_t k = axis;
    for (const int d : {i, j, axis})
      k = k << index_bits | static_cast<std::uint64_t>(lower[d]);
    return k;
  }
};

LatticeEdge edge_of(std::uint64_t key) {
  LatticeEdge edge;
  edge.axis = static_cast<int>(key >> 3 * index_bits);
  for (const int d : {edge.axis, (edge.axis + 2) % 3, (edge.axis + 1) % 3}) {
    edge.lower[d] = static_cast<int>(key & ((1u << index_bits) - 1));
    key >>= index_bits;
  }
  return edge;
}

std::uint64_t line_of(const std::uint64_t key) { return key >> index_bits; }

struct Crossing {
  std::uint64_t edge; ///< key of the lattice edge
  double t;           ///< from its lower node [1]
  std::uint32_t triangle;

  bool operator<(const Crossing& other) const {
    return std::tie(edge, t, triangle) < std::tie(other.edge, other.t, other.triangle);
  }
};

grid::Lattice lattice_around(const geometry::TriangleMesh& mesh, const double h, const Vec3& offset) {
  if (!(h > 0) || !std::isfinite(h))
    throw ParameterError(Complaint{.path = "Cube edge [m]", .value = std::to_string(h), .rule = "must be > 0"});
  if (!(offset.array().abs() <= 1).all())
    throw ParameterError(Complaint{.path = "Lattice offset [1]", .rule = "each part must be in [-1, 1]"});
  const Box box = geometry::bounding_box(mesh);
  if ((box.upper - box.lower).maxCoeff() / h > (1 << index_bits) - 8)
    throw ParameterError(Complaint{.path = "Cube edge [m]",
                                   .value = std::to_string(h),
                                   .rule = "the body must be smaller than 2^20 cubes",
                                   .remedy = "Use larger cubes"});
  return {box.lower + h * (offset - Vec3::Constant(2)), h};
}

/// Finds where the lattice lines cross one triangle.
class LineCrosser {
 public:
  LineCrosser(const geometry::TriangleMesh& mesh, const grid::Lattice& lattice) : mesh_(mesh), lattice_(lattice) {}

  void add(const std::uint32_t triangle, std::vector<Crossing>& crossings) const {
    const auto [a, b, c] = mesh_.triangles[triangle];
    const Vec3 &va = mesh_.vertices[a], &vb = mesh_.vertices[b], &vc = mesh_.vertices[c];
    const Vec3 lower = ((va.cwiseMin(vb).cwiseMin(vc) - lattice_.origin) / lattice_.h).array() - margin;
    const Vec3 upper = ((va.cwiseMax(vb).cwiseMax(vc) - lattice_.origin) / lattice_.h).array() + margin;
    Index3 first, last; // lattice planes that may meet the triangle, along each axis
    for (int d = 0; d < 3; ++d) {
      first[d] = static_cast<int>(std::ceil(lower[d]));
      last[d] = static_cast<int>(std::floor(upper[d]));
    }
    for (int axis = 0; axis < 3; ++axis) {
      const int i = (axis + 1) % 3, j = (axis + 2) % 3;
      Index3 node;
      node[axis] = static_cast<int>(std::floor(lower[axis]));
      for (node[i] = first[i]; node[i] <= last[i]; ++node[i])
        for (node[j] = first[j]; node[j] <= last[j]; ++node[j])
          add_crossing(triangle, {axis, node}, last[axis] + 1, crossings);
    }
  }

 private:
  /// Parts of h; lattice coordinates are rounded, and the exact predicates see whatever is close.
  static constexpr double margin = 1e-6;

  /// `from` and `end` enclose the triangle along the line.
  void add_crossing(const std::uint32_t triangle, LatticeEdge from, const int end,
                    std::vector<Crossing>& crossings) const {
    const auto corners = geometry::corners(mesh_, triangle);
    const int side_above = geometry::line_crosses(lattice_.position(from.lower), from.axis, corners);
    if (side_above == 0)
      return;
    Index3 upper = from.lower;
    upper[from.axis] = end;
    const double t = geometry::crossing_parameter(lattice_.position(from.lower), lattice_.position(upper), corners);
    const double estimate = from.lower[from.axis] + t * (end - from.lower[from.axis]);

    int& i = from.lower[from.axis];
    i = static_cast<int>(std::floor(estimate));
    while (side_of(from.lower, corners) == side_above)
      --i;
    upper[from.axis] = i + 1;
    for (; side_of(upper, corners) != side_above; ++upper[from.axis])
      ++i;
    crossings.push_back({from.key(), std::clamp(estimate - i, 0.0, 1.0), triangle});
  }

  int side_of(const Index3& node, const std::array<Vec3, 3>& corners) const {
    return geometry::side(lattice_.position(node), corners);
  }

  const geometry::TriangleMesh& mesh_;
  const grid::Lattice& lattice_;
};

std::vector<Crossing> sorted_crossings(const geometry::TriangleMesh& mesh, const grid::Lattice& lattice) {
  const LineCrosser crosser(mesh, lattice);
  const std::size_t n = mesh.triangles.size();
  std::vector<std::vector<Crossing>> parts((n + triangles_per_chunk - 1) / triangles_per_chunk);
  parallel_for(parts.size(), [&](const std::size_t k) {
    const std::size_t end = std::min(n, (k + 1) * triangles_per_chunk);
    for (std::size_t i = k * triangles_per_chunk; i < end; ++i)
      crosser.add(static_cast<std::uint32_t>(i), parts[k]);
  });
  std::vector<Crossing> crossings;
  for (const auto& part : parts)
    crossings.insert(crossings.end(), part.begin(), part.end());
  std::sort(crossings.begin(), crossings.end());
  return crossings;
}

/// Nodes of x lines between odd and even crossings.
std::vector<Index3> material_nodes(const std::vector<Crossing>& crossings) {
  std::vector<Index3> nodes;
  for (std::size_t k = 0; k < crossings.size() && edge_of(crossings[k].edge).axis == 0; k += 2) {
    if (k + 1 == crossings.size() || line_of(crossings[k].edge) != line_of(crossings[k + 1].edge))
      throw std::logic_error("embed: a line crosses the mesh an odd number of times; the mesh is not closed");
    Index3 node = edge_of(crossings[k].edge).lower;
    const int last = edge_of(crossings[k + 1].edge).lower[0];
    while (++node[0] <= last)
      nodes.push_back(node);
  }
  return nodes;
}

bool is_mixed(const grid::Grid& grid, const grid::EdgeId e) {
  return grid.is_material(grid.ends(e)[0]) != grid.is_material(grid.ends(e)[1]);
}

/// Turns the crossings of each edge into a cut, or into a count.
class Skin {
 public:
  Skin(const geometry::TriangleMesh& mesh, const grid::Grid& grid, Embedding& result)
    : mesh_(mesh),
      grid_(grid),
      result_(result),
      shell_(geometry::shells(mesh)),
      is_lost_(shell_.empty() ? 0 : *std::max_element(shell_.begin(), shell_.end()) + 1, 1) {}

  void add(const std::span<const Crossing> of_edge) {
    const LatticeEdge lattice_edge = edge_of(of_edge.front().edge);
    const auto edge = grid_.find_edge(lattice_edge.lower, lattice_edge.axis);
    if ((of_edge.size() % 2 == 1) != (edge && is_mixed(grid_, *edge)))
      throw std::logic_error("embed: lines along different axes disagree on a node; the mesh is not closed");
    if (of_edge.size() % 2 == 0) {
      ++result_.n_double_crossings;
      return;
    }
    if (of_edge.size() > 1)
      ++result_.n_triple_crossings;
    const Crossing& kept = grid_.is_material(grid_.ends(*edge)[0]) ? of_edge.front() : of_edge.back();
    is_lost_[shell_[kept.triangle]] = 0;
    cuts_.push_back({*edge, kept.t, Vec3::Zero(), grid::skin_label});
    triangles_.push_back(kept.triangle);
  }

  void finish() {
    std::size_t n_mixed = 0;
    for (const grid::EdgeId e : ids<grid::EdgeId>(grid_.n_edges()))
      n_mixed += is_mixed(grid_, e) ? 1 : 0;
    if (n_mixed != cuts_.size())
      throw std::logic_error("embed: an edge of the skin is crossed by nothing; the mesh is not closed");
    find_normals();
    std::sort(cuts_.begin(), cuts_.end(), [](const auto& a, const auto& b) { return a.edge < b.edge; });
    for (const grid::EdgeCut& cut : cuts_)
      result_.cuts.add(cut);
    result_.n_lost_components = std::count(is_lost_.begin(), is_lost_.end(), 1);
  }

 private:
  void find_normals() {
    const geometry::LocalNormals normals(mesh_);
    parallel_for(cuts_.size(), [&](const std::size_t i) {
      constexpr double smoothing = 0.4; // of a cube edge: what is finer than the grid is noise to it
      grid::EdgeCut& cut = cuts_[i];
      Vec3 point = grid_.position(grid_.ends(cut.edge)[0]);
      point[grid_.axis(cut.edge)] += cut.t * grid_.h();
      cut.normal = normals.at(triangles_[i], point, smoothing * grid_.h());
      if (cut.normal.isZero(0)) // rounded away, of a sliver
        cut.normal = Vec3::Unit(grid_.axis(cut.edge));
    });
  }

  const geometry::TriangleMesh& mesh_;
  const grid::Grid& grid_;
  Embedding& result_;
  std::vector<std::uint32_t> shell_;
  std::vector<std::uint8_t> is_lost_;
  std::vector<grid::EdgeCut> cuts_;
  std::vector<std::uint32_t> triangles_; // that made each cut
};

} // namespace

Embedding embed(const geometry::TriangleMesh& mesh, const double h, const Vec3& offset) {
  const grid::Lattice lattice = lattice_around(mesh, h, offset);
  const std::vector<Crossing> crossings = sorted_crossings(mesh, lattice);
  std::vector<Index3> nodes = material_nodes(crossings);
  if (nodes.empty())
    throw DataError(Complaint{.path = "Cube edge [m]",
                              .value = std::to_string(h),
                              .rule = "no lattice node is inside the mesh, it is smaller than a cube",
                              .remedy = "Use smaller cubes, or check the unit of the mesh"});

  grid::Grid grid(lattice, std::move(nodes));
  grid::Cuts cuts(grid);
  Embedding result{std::move(grid), std::move(cuts)};
  Skin skin(mesh, result.grid, result);
  for (auto first = crossings.begin(); first != crossings.end();) {
    const auto last = std::find_if(first, crossings.end(), [&](const Crossing& c) { return c.edge != first->edge; });
    skin.add({first, last});
    first = last;
  }
  skin.finish();
  return result;
}

} // namespace kerf::cut
