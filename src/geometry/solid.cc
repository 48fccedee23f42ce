#include "geometry/solid.h"

#include "base/error.h"
#include "base/union_find.h"
#include "geometry/predicates.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace kerf::geometry {
namespace {

/// One side of an edge: corner k of a triangle, where the edge to corner k + 1 starts.
struct EdgeSide {
  std::uint32_t low, high; ///< the edge's vertices
  std::uint32_t triangle;
  std::uint8_t corner;

  auto operator<=>(const EdgeSide&) const = default;
  bool same_edge(const EdgeSide& other) const { return low == other.low && high == other.high; }
};

struct Defects {
  std::size_t n = 0;
  Vec3 first = Vec3::Zero(); ///< where the first one is [m]

  void add(const Vec3& place) {
    if (n++ == 0)
      first = place;
  }
};

std::string to_text(const Vec3& p) {
  std::ostringstream text;
  text << '(' << p[0] << ", " << p[1] << ", " << p[2] << ") m";
  return text.str();
}

[[noreturn]] void reject(const std::string& path, const std::string& rule, const std::string& remedy) {
  const std::string whole_rule = "the mesh must be the skin of a solid, but " + rule;
  throw DataError(Complaint{.file = path, .rule = whole_rule, .remedy = remedy});
}

void require_none(const Defects& defects, const std::string& path, const std::string& what, const std::string& remedy) {
  if (defects.n > 0)
    reject(path, what + ": " + std::to_string(defects.n) + ", the first at " + to_text(defects.first), remedy);
}

Vec3 centroid(const TriangleMesh& mesh, const std::size_t i) {
  const auto [a, b, c] = corners(mesh, i);
  return (a + b + c) / 3;
}

void require_areas(const TriangleMesh& mesh, const std::string& path) {
  Defects degenerate;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    if (const auto triangle = corners(mesh, i); side(triangle[0], triangle) == 0)
      degenerate.add(centroid(mesh, i));
  require_none(degenerate, path, "it has degenerate triangles (without area)",
               "Collapse short edges and remove faces of zero area");
}

std::vector<EdgeSide> sorted_edge_sides(const TriangleMesh& mesh) {
  std::vector<EdgeSide> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i)
    for (std::uint8_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax({mesh.triangles[i][k], mesh.triangles[i][(k + 1) % 3]});
      sides.push_back({low, high, i, k});
    }
  std::sort(sides.begin(), sides.end());
  return sides;
}

void require_two_sides_an_edge(const TriangleMesh& mesh, const std::vector<EdgeSide>& sides, const std::string& path) {
  Defects open, crowded;
  for (auto first = sides.begin(); first != sides.end();) {
    const auto last = std::find_if(first, sides.end(), [&](const EdgeSide& s) { return !s.same_edge(*first); });
    const Vec3 middle = (mesh.vertices[first->low] + mesh.vertices[first->high]) / 2;
    if (last - first == 1)
      open.add(middle);
    else if (last - first > 2)
      crowded.add(middle);
    first = last;
  }
  require_none(crowded, path, "it is not manifold, edges with more than two triangles",
               "Split or remove these triangles");
  require_none(open, path, "it is open, boundary edges with one triangle only",
               "Fill the holes; if vertices coincide along a seam, merge them");
}

/// The corner of a side's triangle that is at `vertex`.
std::uint32_t corner_at(const TriangleMesh& mesh, const EdgeSide& side, const std::uint32_t vertex) {
  const std::uint32_t k = mesh.triangles[side.triangle][side.corner] == vertex ? side.corner : (side.corner + 1) % 3;
  return 3 * side.triangle + k;
}

/// A vertex whose triangles form more than one fan joins surfaces in a point.
void require_one_fan_a_vertex(const TriangleMesh& mesh, const std::vector<EdgeSide>& sides, const std::string& path) {
  UnionFind fans(3 * mesh.triangles.size());
  for (std::size_t i = 0; i < sides.size(); i += 2)
    for (const std::uint32_t vertex : {sides[i].low, sides[i].high})
      fans.unite(corner_at(mesh, sides[i], vertex), corner_at(mesh, sides[i + 1], vertex));
  std::vector<std::uint32_t> n_fans(mesh.vertices.size(), 0);
  Defects pinched;
  for (std::uint32_t corner = 0; corner < 3 * mesh.triangles.size(); ++corner) {
    const std::uint32_t vertex = mesh.triangles[corner / 3][corner % 3];
    if (fans.root(corner) == corner && ++n_fans[vertex] == 2)
      pinched.add(mesh.vertices[vertex]);
  }
  require_none(pinched, path, "it is not manifold, vertices where surfaces touch in a point", "Split these vertices");
}

bool runs_upwards(const TriangleMesh& mesh, const EdgeSide& side) {
  return mesh.triangles[side.triangle][side.corner] == side.low;
}

void flip(Triangle& triangle) { std::swap(triangle[1], triangle[2]); }

/// Makes neighbours run along their common edge in opposite directions. A triangle and its reverse are two nodes of a
/// graph (the orientation double cover), so a mesh can be oriented when no triangle is joined to its own reverse.
void orient_consistently(TriangleMesh& mesh, const std::vector<EdgeSide>& sides, const std::string& path) {
  const auto n = static_cast<std::uint32_t>(mesh.triangles.size());
  UnionFind orientations(2 * n); // i as it is, i + n reversed
  for (std::size_t k = 0; k < sides.size(); k += 2) {
    const std::uint32_t i = sides[k].triangle, j = sides[k + 1].triangle;
    const bool agree = runs_upwards(mesh, sides[k]) != runs_upwards(mesh, sides[k + 1]);
    orientations.unite(i, agree ? j : j + n);
    orientations.unite(i + n, agree ? j + n : j);
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t as_it_is = orientations.root(i), reversed = orientations.root(i + n);
    if (as_it_is == reversed)
      reject(path, "it is not orientable, a one-sided surface through " + to_text(centroid(mesh, i)),
             "Rebuild the surface so that it has an inside");
    if (reversed < as_it_is)
      flip(mesh.triangles[i]);
  }
}

/// The triangles of each shell.
std::vector<std::vector<std::uint32_t>> triangles_of_shells(const std::vector<std::uint32_t>& shell) {
  std::vector<std::vector<std::uint32_t>> members(*std::max_element(shell.begin(), shell.end()) + 1);
  for (std::uint32_t i = 0; i < shell.size(); ++i)
    members[shell[i]].push_back(i);
  return members;
}

double shell_volume(const TriangleMesh& mesh, const std::vector<std::uint32_t>& triangles) {
  const Vec3 apex = corners(mesh, triangles.front())[0];
  double six_volumes = 0;
  for (const std::uint32_t i : triangles) {
    const auto [a, b, c] = corners(mesh, i);
    six_volumes += (a - apex).cross(b - apex).dot(c - apex);
  }
  return six_volumes / 6;
}

/// Whether an odd number of other shells is around shell s: a ray from its vertex `start` in +x crosses each of those
/// an odd number of times, the rest an even one.
bool is_void(const TriangleMesh& mesh, const std::vector<std::uint32_t>& shell, const std::uint32_t s,
             const Vec3& start, const Box& box) {
  const Vec3 end(box.upper[0] + (box.upper[0] - box.lower[0]), start[1], start[2]);
  std::size_t n_crossings = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (shell[i] == s)
      continue;
    const auto triangle = corners(mesh, i);
    const Vec3 lower = triangle[0].cwiseMin(triangle[1]).cwiseMin(triangle[2]);
    const Vec3 upper = triangle[0].cwiseMax(triangle[1]).cwiseMax(triangle[2]);
    const auto holds = [&](const int axis) { return lower[axis] <= start[axis] && start[axis] <= upper[axis]; };
    if (upper[0] >= start[0] && holds(1) && holds(2))
      n_crossings += crosses(start, end, triangle) ? 1 : 0;
  }
  return n_crossings % 2 == 1;
}

void require_volume(const TriangleMesh& mesh, const std::vector<std::uint32_t>& shell, const std::string& path) {
  const Box box = bounding_box(mesh);
  const double no_volume = 1e-14 * std::pow((box.upper - box.lower).norm(), 3); // round-off of the sum
  for (const auto& triangles : triangles_of_shells(shell))
    if (std::abs(shell_volume(mesh, triangles)) <= no_volume)
      reject(path, "it does not bound a volume: a closed shell without one at " + to_text(centroid(mesh, triangles[0])),
             "Remove the shell or give it a thickness");
}

void orient_outwards(TriangleMesh& mesh, const std::vector<std::uint32_t>& shell) {
  const Box box = bounding_box(mesh);
  const auto members = triangles_of_shells(shell);
  for (std::uint32_t s = 0; s < members.size(); ++s) {
    const bool wants_positive = !is_void(mesh, shell, s, corners(mesh, members[s][0])[0], box);
    if ((shell_volume(mesh, members[s]) > 0) != wants_positive)
      for (const std::uint32_t i : members[s])
        flip(mesh.triangles[i]);
  }
}

void require_no_self_intersection(const TriangleMesh& mesh, const std::string& path) {
  const auto pairs = self_intersections(mesh);
  if (pairs.empty())
    return;
  const auto& [i, j] = pairs.front();
  reject(path,
         "it intersects itself: " + std::to_string(pairs.size()) + " pairs of triangles, the first " +
           std::to_string(i) + " and " + std::to_string(j) + " near " + to_text(centroid(mesh, i)),
         "Repair it with a boolean union or a remesher");
}

} // namespace

TriangleMesh require_solid(TriangleMesh mesh, const std::string& path) {
  if (mesh.vertices.empty() || mesh.triangles.empty())
    reject(path, "it is empty", "Export the mesh again");
  require_areas(mesh, path);
  const std::vector<EdgeSide> sides = sorted_edge_sides(mesh);
  require_two_sides_an_edge(mesh, sides, path);
  require_one_fan_a_vertex(mesh, sides, path);
  orient_consistently(mesh, sides, path);
  const std::vector<std::uint32_t> shell = shells(mesh);
  require_volume(mesh, shell, path);
  require_no_self_intersection(mesh, path);
  orient_outwards(mesh, shell);
  return mesh;
}

} // namespace kerf::geometry
