#include "cut/embed.h"

#include "base/error.h"
#include "base/parallel.h"
#include "geometry/box_tree.h"
#include "geometry/normals.h"
#include "geometry/predicates.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <tuple>

namespace kerf::cut {
namespace {

constexpr int index_bits = 20; // the grid's limit
constexpr std::uint64_t max_index = (1u << index_bits) - 1;
constexpr std::size_t triangles_per_chunk = 2048;

/// The largest integer that is not above x: std::floor without the call.
int round_down(const double x) {
  const int i = static_cast<int>(x);
  return i - (x < i);
}

/// An edge of the lattice, stored or not; keys are ordered by axis, then as the grid orders lower nodes: by z, y, x. So
/// crossings of a line along x follow each other, and sorted cut edges are sorted by their ids.
struct LatticeEdge {
  int axis = 0;
  Index3 lower{};

  std::uint64_t key() const {
    std::uint64_t k = axis;
    for (const int d : {2, 1, 0})
      k = k << index_bits | static_cast<std::uint64_t>(lower[d]);
    return k;
  }
};

LatticeEdge edge_of(std::uint64_t key) {
  LatticeEdge edge;
  edge.axis = static_cast<int>(key >> 3 * index_bits);
  for (int& coordinate : edge.lower) {
    coordinate = static_cast<int>(key & ((1u << index_bits) - 1));
    key >>= index_bits;
  }
  return edge;
}

/// Of an edge along x.
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

/// A sum of products of rounded differences whose sign is the exact one's when it is larger than this part of the sum
/// of the products' sizes. J. R. Shewchuk, Adaptive precision floating-point arithmetic and fast robust geometric
/// predicates, 1997, bounds A of orient2d and orient3d: (3 + 16 e) e and (7 + 56 e) e with e = epsilon / 2.
constexpr double safety = 8 * std::numeric_limits<double>::epsilon();

/// Finds where the lattice lines cross one triangle: geometry/predicates.h, which is asked where floating point does
/// not tell the answer.
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
      first[d] = -round_down(-lower[d]);
      last[d] = round_down(upper[d]);
    }
    const Flat flat({va, vb, vc});
    for (int axis = 0; axis < 3; ++axis) {
      const int i = (axis + 1) % 3, j = (axis + 2) % 3;
      Index3 node;
      node[axis] = round_down(lower[axis]);
      for (node[i] = first[i]; node[i] <= last[i]; ++node[i])
        for (node[j] = first[j]; node[j] <= last[j]; ++node[j])
          if (const int side_above = line_crosses(lattice_.position(node), axis, flat); side_above != 0)
            crossings.push_back(crossing(triangle, flat, {axis, node}, last[axis] + 1, side_above));
    }
  }

 private:
  /// Parts of h; lattice coordinates are rounded, and the exact predicates see whatever is close.
  static constexpr double margin = 1e-6;

  /// A triangle, its normal (b-a) x (c-a), and the sizes of the products in that.
  struct Flat {
    std::array<Vec3, 3> corners;
    Vec3 normal, sizes;

    explicit Flat(const std::array<Vec3, 3>& of) : corners(of) {
      const Vec3 u = of[1] - of[0], v = of[2] - of[0];
      for (int x = 0; x < 3; ++x) {
        const int y = (x + 1) % 3, z = (x + 2) % 3;
        const double left = u[y] * v[z], right = u[z] * v[y];
        normal[x] = left - right;
        sizes[x] = std::abs(left) + std::abs(right);
      }
    }
  };

  static int line_crosses(const Vec3& p, const int axis, const Flat& flat) {
    const int i = (axis + 1) % 3, j = (axis + 2) % 3;
    const auto& [a, b, c] = flat.corners;
    const double ai = a[i] - p[i], bi = b[i] - p[i], ci = c[i] - p[i];
    const double aj = a[j] - p[j], bj = b[j] - p[j], cj = c[j] - p[j];
    const std::array<double, 3> left = {ai * bj, bi * cj, ci * aj}, right = {aj * bi, bj * ci, cj * ai};
    int n_above = 0, n_below = 0; // edges with a certain sign
    for (int k = 0; k < 3; ++k) {
      const double difference = left[k] - right[k], doubt = safety * (std::abs(left[k]) + std::abs(right[k]));
      n_above += difference > doubt;
      n_below += -difference > doubt;
    }
    if (n_above > 0 && n_below > 0)
      return 0;
    return n_above == 3 ? 1 : n_below == 3 ? -1 : geometry::line_crosses(p, axis, flat.corners);
  }

  static int side(const Vec3& p, const Flat& flat) {
    const Vec3 w = p - flat.corners[0];
    const double height = flat.normal.dot(w);
    if (std::abs(height) > safety * flat.sizes.dot(w.cwiseAbs()))
      return height > 0 ? 1 : -1;
    return geometry::side(p, flat.corners);
  }

  /// `from` and `end` enclose the triangle along the line.
  Crossing crossing(const std::uint32_t triangle, const Flat& flat, LatticeEdge from, const int end,
                    const int side_above) const {
    Index3 upper = from.lower;
    upper[from.axis] = end;
    const double t =
      geometry::crossing_parameter(lattice_.position(from.lower), lattice_.position(upper), flat.corners);
    const double estimate = from.lower[from.axis] + t * (end - from.lower[from.axis]);

    int& i = from.lower[from.axis];
    i = round_down(estimate);
    while (side(lattice_.position(from.lower), flat) == side_above)
      --i;
    upper[from.axis] = i + 1;
    for (; side(lattice_.position(upper), flat) != side_above; ++upper[from.axis])
      ++i;
    return {from.key(), std::clamp(estimate - i, 0.0, 1.0), triangle};
  }

  const geometry::TriangleMesh& mesh_;
  const grid::Lattice& lattice_;
};

/// All crossings in order: dealt out to their rows, where they are few each.
std::vector<Crossing> sorted(const std::vector<std::vector<Crossing>>& parts) {
  std::size_t n = 0;
  std::array<std::uint64_t, 2> end{}; // of y, z
  for (const auto& part : parts) {
    n += part.size();
    for (const Crossing& c : part)
      for (int d = 0; d < 2; ++d)
        end[d] = std::max(end[d], (c.edge >> (d + 1) * index_bits & max_index) + 1);
  }
  const auto row_of = [&](const Crossing& c) {
    const std::uint64_t y = c.edge >> index_bits & max_index, z = c.edge >> 2 * index_bits & max_index;
    return ((c.edge >> 3 * index_bits) * end[1] + z) * end[0] + y;
  };
  std::vector<Crossing> crossings(n);
  if (3 * end[0] * end[1] > 8 * n) { // hardly one crossing a row
    auto next = crossings.begin();
    for (const auto& part : parts)
      next = std::copy(part.begin(), part.end(), next);
    std::sort(crossings.begin(), crossings.end());
    return crossings;
  }
  std::vector<std::uint32_t> place(3 * end[0] * end[1] + 1, 0); // where the row's next one goes
  for (const auto& part : parts)
    for (const Crossing& c : part)
      ++place[row_of(c) + 1];
  for (std::size_t row = 1; row < place.size(); ++row)
    place[row] += place[row - 1];
  for (const auto& part : parts)
    for (const Crossing& c : part)
      crossings[place[row_of(c)]++] = c;
  for (std::size_t row = 0, begin = 0; row + 1 < place.size(); begin = place[row++])
    std::sort(crossings.begin() + begin, crossings.begin() + place[row]);
  return crossings;
}

std::vector<Crossing> sorted_crossings(const geometry::TriangleMesh& mesh, const grid::Lattice& lattice) {
  const LineCrosser crosser(mesh, lattice);
  const std::size_t n = mesh.triangles.size();
  std::vector<std::vector<Crossing>> parts((n + triangles_per_chunk - 1) / triangles_per_chunk);
  parallel_for(parts.size(), [&](const std::size_t k) {
    const std::size_t end = std::min(n, (k + 1) * triangles_per_chunk);
    parts[k].reserve(2 * triangles_per_chunk);
    for (std::size_t i = k * triangles_per_chunk; i < end; ++i)
      crosser.add(static_cast<std::uint32_t>(i), parts[k]);
  });
  return sorted(parts);
}

/// Nodes of x lines between odd and even crossings.
std::vector<grid::NodeRun> material_runs(const std::vector<Crossing>& crossings) {
  std::vector<grid::NodeRun> runs;
  for (std::size_t k = 0; k < crossings.size() && edge_of(crossings[k].edge).axis == 0; k += 2) {
    if (k + 1 == crossings.size() || line_of(crossings[k].edge) != line_of(crossings[k + 1].edge))
      throw std::logic_error("embed: a line crosses the mesh an odd number of times; the mesh is not closed");
    const auto [before_first, y, z] = edge_of(crossings[k].edge).lower;
    const int last = edge_of(crossings[k + 1].edge).lower[0];
    if (before_first < last)
      runs.push_back({before_first + 1, last, y, z});
  }
  return runs;
}

/// Turns the crossings of each edge into a cut, or into a count.
class Skin {
 public:
  Skin(const geometry::TriangleMesh& mesh, Embedding& result)
    : mesh_(mesh),
      result_(result),
      shell_(geometry::shells(mesh)),
      is_lost_(shell_.empty() ? 0 : *std::max_element(shell_.begin(), shell_.end()) + 1, 1) {}

  /// Walks through the edges between a material and an empty node and the crossings, both sorted: every such edge is
  /// crossed an odd number of times, and no other.
  void add(const std::vector<Crossing>& crossings) {
    const grid::Grid& grid = result_.solid.grid;
    auto next = crossings.begin();
    const std::vector<grid::EdgeId> edges = grid.skin_edges();
    cuts_.reserve(edges.size());
    triangles_.reserve(edges.size());
    for (const grid::EdgeId e : edges) {
      const std::uint64_t key = LatticeEdge{grid.axis(e), grid.index(grid.ends(e)[0])}.key();
      next = count_even(next, crossings.end(), key);
      const auto last = end_of_edge(next, crossings.end());
      if (next == last || next->edge != key || (last - next) % 2 == 0)
        throw std::logic_error("embed: lines along different axes disagree on a node; the mesh is not closed");
      add_cut(e, {next, last});
      next = last;
    }
    count_even(next, crossings.end(), std::numeric_limits<std::uint64_t>::max());
  }

  void finish() {
    find_normals();
    result_.solid.cuts.reserve(cuts_.size() + cuts_.size() / 8); // some room for blades
    for (const grid::EdgeCut& cut : cuts_)
      result_.solid.cuts.add(result_.solid.grid, cut);
    result_.n_components = is_lost_.size();
    result_.n_lost_components = std::count(is_lost_.begin(), is_lost_.end(), 1);
  }

 private:
  using Place = std::vector<Crossing>::const_iterator;

  static Place end_of_edge(const Place first, const Place end) {
    return std::find_if(first, end, [&](const Crossing& c) { return c.edge != first->edge; });
  }

  /// Counts the edges before `key`, which must be crossed an even number of times; returns what follows them.
  Place count_even(Place next, const Place end, const std::uint64_t key) {
    while (next != end && next->edge < key) {
      const Place last = end_of_edge(next, end);
      if ((last - next) % 2 != 0)
        throw std::logic_error("embed: lines along different axes disagree on a node; the mesh is not closed");
      const auto lower = result_.solid.grid.find_node(edge_of(next->edge).lower);
      ++(lower && result_.solid.grid.is_material(*lower) ? result_.n_thin_gaps : result_.n_thin_walls);
      next = last;
    }
    return next;
  }

  void add_cut(const grid::EdgeId edge, const std::span<const Crossing> of_edge) {
    if (of_edge.size() > 1)
      ++result_.n_triple_crossings;
    const grid::Grid& grid = result_.solid.grid;
    const Crossing& kept = grid.is_material(grid.ends(edge)[0]) ? of_edge.front() : of_edge.back();
    is_lost_[shell_[kept.triangle]] = 0;
    cuts_.push_back({edge, kept.t, Vec3::Zero(), grid::skin_label});
    triangles_.push_back(kept.triangle);
  }

  void find_normals() {
    const grid::Grid& grid = result_.solid.grid;
    const geometry::LocalNormals normals(mesh_);
    parallel_ranges(cuts_.size(), 2, [&](const std::size_t begin, const std::size_t end) {
      constexpr double smoothing = 0.4; // of a cube edge: what is finer than the grid is noise to it
      geometry::LocalNormals::Marks marks(normals);
      for (std::size_t i = begin; i < end; ++i) {
        grid::EdgeCut& cut = cuts_[i];
        Vec3 point = grid.position(grid.ends(cut.edge)[0]);
        point[grid.axis(cut.edge)] += cut.t * grid.h();
        cut.normal = normals.at(triangles_[i], point, smoothing * grid.h(), marks);
        if (cut.normal.isZero(0)) // rounded away, of a sliver
          cut.normal = Vec3::Unit(grid.axis(cut.edge));
      }
    });
  }

  const geometry::TriangleMesh& mesh_;
  Embedding& result_;
  std::vector<std::uint32_t> shell_;
  std::vector<std::uint8_t> is_lost_;
  std::vector<grid::EdgeCut> cuts_;      // ordered by edge
  std::vector<std::uint32_t> triangles_; // that made each cut
};

} // namespace

Embedding embed(const geometry::TriangleMesh& mesh, const double h, const Vec3& offset) {
  const grid::Lattice lattice = lattice_around(mesh, h, offset);
  const std::vector<Crossing> crossings = sorted_crossings(mesh, lattice);
  const std::vector<grid::NodeRun> material = material_runs(crossings);
  if (material.empty())
    throw DataError(Complaint{.path = "Cube edge [m]",
                              .value = std::to_string(h),
                              .rule = "no lattice node is inside the mesh, it is smaller than a cube",
                              .remedy = "Use smaller cubes, or check the unit of the mesh"});

  grid::Grid grid = grid::Grid::from_runs(lattice, material);
  grid::Cuts cuts(grid);
  Embedding result{{std::move(grid), std::move(cuts)}};
  Skin skin(mesh, result);
  skin.add(crossings);
  skin.finish();
  return result;
}

std::size_t n_severed_cells(const geometry::TriangleMesh& mesh, const grid::Solid& solid) {
  std::optional<geometry::BoxTree> tree; // where it is needed
  const auto meets_mesh = [&](const std::array<Vec3, 2>& way) {
    if (!tree) {
      std::vector<Box> boxes;
      for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
        boxes.push_back(geometry::box_around(corners(mesh, i)));
      tree.emplace(std::move(boxes));
    }
    bool meets = false;
    tree->for_each(geometry::box_around(way), [&](const std::uint32_t i) {
      meets = meets || geometry::crosses(way[0], way[1], corners(mesh, i));
    });
    return meets;
  };
  const auto is_severed = [&](const grid::CellId c) {
    const auto at = solid.grid.nodes(c);
    for (const grid::CopyId one : solid.complex.copies_of(c))
      for (grid::CopyId other = solid.complex.copies[one].next; other.valid(); other = solid.complex.copies[other].next)
        for (int v = 0; v < grid::cube::n_vertices; ++v)
          for (int w = 0; w < grid::cube::n_vertices; ++w)
            if ((solid.complex.copies[one].nodes >> v & 1) != 0 && (solid.complex.copies[other].nodes >> w & 1) != 0 &&
                !meets_mesh({solid.grid.position(at[v]), solid.grid.position(at[w])}))
              return true;
    return false;
  };
  std::size_t n = 0;
  for (const auto c : ids<grid::CellId>(solid.grid.n_cells()))
    if (solid.complex.copies[solid.complex.first_copy[c]].next.valid() && is_severed(c))
      ++n;
  return n;
}

} // namespace kerf::cut
