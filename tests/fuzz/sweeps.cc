#include "tests/fuzz/sweeps.h"

#include "grid/cube.h"
#include "tests/fuzz/invariants.h"
#include "tests/fuzz/states.h"
#include "tests/geometry/meshes.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace kerf::fuzz {

namespace cube = grid::cube;
using grid::CopyId;
using grid::NodeId;
using support::uniform;

namespace {

/// A polyline at successive moments.
using Stroke = std::vector<Points>;

class Draw {
 public:
  Draw(const Subject& subject, Random& random) : subject_(subject), random_(random), reach_(reach(subject)) {}

  Points random_line(const int n) {
    Points line;
    for (int i = 0; i < n; ++i)
      line.push_back(random_point(random_, reach_));
    return line;
  }

  /// Straight or bent, moved and turned a little from place to place; every other one starts across the whole body.
  Stroke stroke() {
    Stroke places = {random_line(2 + draw(random_, 3))};
    if (const int axis = draw(random_, 6); axis < 3) {
      places[0].front()[axis] = reach_.lower[axis];
      places[0].back()[axis] = reach_.upper[axis];
    }
    const double length = 0.5 * (reach_.upper - reach_.lower).norm() * uniform(random_, 0.05, 1.5);
    const Vec3 way = length * support::random_direction(random_);
    const int n_steps = 1 + draw(random_, 4);
    for (int k = 0; k < n_steps; ++k) {
      places.push_back(places.back());
      for (Vec3& p : places.back())
        p += (way + 0.1 * length * support::random_vector(random_)) / n_steps;
    }
    return places;
  }

  /// Polylines from node to node, each place another one.
  Stroke through_nodes() {
    Stroke places;
    const int n_places = 2 + draw(random_, 3), n_points = 2 + draw(random_, 3);
    for (int k = 0; k < n_places; ++k) {
      places.emplace_back();
      for (int i = 0; i < n_points; ++i)
        places.back().push_back(at(random_node()));
    }
    return places;
  }

  /// A walk along edges, swept to the walk beside it: every triangle lies in a face, where the body is at rest.
  Stroke along_edges() {
    std::vector<NodeId> walk = {random_node()};
    const int n_steps = 1 + draw(random_, 6);
    for (int i = 0; i < n_steps; ++i)
      walk.push_back(neighbour(walk.back(), draw(random_, 3), 2 * draw(random_, 2) - 1));
    Stroke places(1);
    for (const NodeId node : walk)
      places.back().push_back(at(node));
    const int axis = draw(random_, 3), n_places = 1 + draw(random_, 4);
    for (int k = 0; k < n_places; ++k) {
      places.emplace_back();
      for (NodeId& node : walk) {
        node = neighbour(node, axis, 1);
        places.back().push_back(at(node));
      }
    }
    return places;
  }

  /// A plane through a node, square to an axis but for a tilt and an offset that are nothing, or next to nothing.
  Stroke tangential() {
    const int axis = draw(random_, 3), along = (axis + 1) % 3, across = (axis + 2) % 3;
    constexpr std::array<double, 6> offsets = {0, 0, 0, 1e-17, -1e-14, 1e-9};
    Vec3 lower = reach_.lower, upper = reach_.upper;
    lower[axis] = upper[axis] = at(random_node())[axis] + subject_.grid().h() * offsets[draw(random_, 6)];
    upper[axis] += subject_.grid().h() * offsets[draw(random_, 6)];
    Vec3 side = lower;
    side[along] = upper[along];
    Stroke places(1, {lower, side});
    const int n_places = 1 + draw(random_, 5);
    for (int k = 1; k <= n_places; ++k) {
      places.push_back(places.front());
      for (Vec3& p : places.back())
        p[across] += (upper[across] - lower[across]) * k / n_places;
    }
    return places;
  }

  /// Nothing is swept, or triangles without area.
  Stroke resting() {
    const Points line = draw(random_, 2) ? random_line(3) : Points{at(random_node()), at(random_node())};
    if (draw(random_, 2))
      return {line, line};
    Points shifted = line; // along itself
    for (Vec3& p : shifted)
      p += 0.5 * (line[1] - line[0]);
    return draw(random_, 2) ? Stroke{line, shifted} : Stroke{Points(2, line[0]), Points(2, line[1])};
  }

  /// A polyline that runs through itself, and on to where the next place crosses it again.
  Stroke self_crossing() {
    Stroke places = {random_line(6)};
    const std::size_t n_points = places[0].size();
    places[0][3] = places[0][0];
    const int n_places = 1 + draw(random_, 3);
    for (int k = 0; k < n_places; ++k) {
      Points next = places.back();
      std::rotate(next.begin(), next.begin() + 1 + draw(random_, static_cast<int>(n_points) - 1), next.end());
      places.push_back(next);
    }
    return places;
  }

  /// A blade's own path between key frames, turning.
  cut::BladePath turning() {
    const Points ends = random_line(3);
    cut::Blade blade;
    blade.edge = {Vec3::Zero(), ends[1] - ends[0]};
    const int n_frames = 2 + draw(random_, 3);
    for (int k = 0; k < n_frames; ++k)
      blade.key_frames.push_back({0.7 * k, ends[0] + 0.3 * k * (ends[2] - ends[0]),
                                  uniform(random_, 0, 80) * support::random_direction(random_)});
    cut::check(blade);
    const double start = uniform(random_, -0.5, 0.2);
    cut::BladePath whole; // a blade that turns back crosses some edges twice
    for (const cut::BladePath& path : cut::paths(blade, start, start + uniform(random_, 0.1, 2))) {
      const std::size_t n_shared = whole.lines.empty() ? 0 : 1;
      whole.fractions.insert(whole.fractions.end(), path.fractions.begin() + n_shared, path.fractions.end());
      whole.lines.insert(whole.lines.end(), path.lines.begin() + n_shared, path.lines.end());
    }
    return whole;
  }

  Soup soup() {
    Soup triangles(1 + draw(random_, 30));
    const bool local = draw(random_, 2) == 0;
    for (auto& triangle : triangles) {
      const Vec3 centre = random_point(random_, reach_);
      for (Vec3& p : triangle)
        p =
          local ? Vec3(centre + subject_.grid().h() * support::random_vector(random_)) : random_point(random_, reach_);
    }
    return triangles;
  }

  /// Next to nothing, right on edges: triangles thin as round-off, and tiny ones.
  Soup slivers() {
    Soup triangles;
    const int n = 1 + draw(random_, 20);
    for (int k = 0; k < n; ++k) {
      const NodeId node = random_node();
      const Vec3 p = at(node), q = at(neighbour(node, draw(random_, 3), 1));
      const Vec3 on_edge = p + uniform(random_, 0, 1) * (q - p), way = support::random_vector(random_);
      const double h = subject_.grid().h(), tiny = h * std::pow(10, uniform(random_, -18, -9));
      if (draw(random_, 2))
        triangles.push_back(
          {on_edge - h * way, on_edge + 2 * h * way, on_edge + tiny * support::random_vector(random_)});
      else
        triangles.push_back({on_edge - tiny * way, on_edge + 2 * tiny * support::random_vector(random_),
                             on_edge + tiny * support::random_vector(random_)});
    }
    return triangles;
  }

  /// Current faces of copies: a few of them, or all of one lattice plane.
  Soup in_faces() {
    Soup triangles;
    const int axis = draw(random_, 3), level = subject_.grid().index(random_node())[axis];
    const bool sheet = draw(random_, 2) == 0;
    const auto n_copies = static_cast<int>(subject_.solid.complex.n_copies());
    const int n = sheet ? n_copies : 1 + draw(random_, 12);
    for (int k = 0; k < n; ++k) {
      const CopyId c(sheet ? k : draw(random_, n_copies));
      const auto& grid = subject_.grid();
      if (!sheet || grid.index(grid.nodes(subject_.solid.complex.copies[c].cell)[0])[axis] == level)
        add_face(c, sheet ? 2 * axis : draw(random_, 6), triangles);
    }
    return triangles;
  }

  NamedSweep surface() {
    const Vec3 centre = draw(random_, 2) ? at(random_node()) : random_point(random_, reach_);
    const Vec3 direction = draw(random_, 2) ? Vec3(Vec3::Unit(draw(random_, 3))) : support::random_direction(random_);
    const double radius = subject_.grid().h() * (draw(random_, 2) ? 1 + draw(random_, 4) : uniform(random_, 0.01, 6));
    switch (draw(random_, 6)) {
      case 0:
        return by("plane", cut::Plane{centre, direction}, Extent::closed);
      case 1:
        return by("sphere", cut::Sphere{centre, radius}, Extent::closed);
      case 2:
        return by("cylinder", cut::Cylinder{centre, direction, radius, 1.5 * radius}, Extent::closed);
      case 3:
        return by("disc", cut::Disc{centre, direction, radius}, Extent::open);
      case 4: {
        const Vec3 side = radius * direction.unitOrthogonal();
        return by("rectangle", cut::Rectangle{centre, side, 1.5 * direction.cross(side)}, Extent::open);
      }
      default:
        return mesh(centre, radius);
    }
  }

  /// Closed, open, or twice on itself.
  NamedSweep mesh(const Vec3& centre, const double radius) {
    const Vec3 half = Vec3::Constant(radius);
    auto mesh =
      draw(random_, 2) ? geometry::sphere_mesh(radius, centre, 1) : geometry::box_mesh(centre - half, centre + half);
    switch (draw(random_, 4)) {
      case 0:
        mesh.triangles.resize(1 + draw(random_, static_cast<int>(mesh.triangles.size())));
        return by("open mesh", mesh, Extent::open);
      case 1:
        return by("mesh twice on itself", geometry::together(mesh, geometry::inside_out(mesh)), Extent::closed);
      default:
        return by("closed mesh", mesh, Extent::closed);
    }
  }

 private:
  NodeId random_node() {
    while (true)
      if (const NodeId node(draw(random_, static_cast<int>(subject_.grid().n_nodes())));
          subject_.grid().is_material(node))
        return node;
  }

  /// Where the material of a node is now.
  Vec3 at(const NodeId node) const { return subject_.x[subject_.solid.complex.real_corner[node].value]; }

  /// The next material node along an axis; the node itself at the skin.
  NodeId neighbour(const NodeId node, const int axis, const int step) const {
    Index3 i = subject_.grid().index(node);
    i[axis] += step;
    const auto next = subject_.grid().find_node(i);
    return next && subject_.grid().is_material(*next) ? *next : node;
  }

  static NamedSweep by(const std::string& name, const cut::Shape& shape, const Extent extent) {
    const cut::CutSurface surface{name, shape};
    cut::check(surface);
    return {name, surface, extent};
  }

  void add_face(const CopyId c, const int face, Soup& triangles) const {
    std::array<Vec3, 4> p;
    for (int k = 0; k < 4; ++k)
      p[k] = subject_.x[subject_.solid.complex.copies[c].corners[cube::face_vertices[face][k]].value];
    triangles.push_back({p[0], p[1], p[3]});
    triangles.push_back({p[0], p[3], p[2]});
  }

  const Subject& subject_;
  Random& random_;
  Box reach_;
};

/// Met as it is, or in relative motion.
Sweep swept(const Stroke& places, Random& random) {
  if (draw(random, 2) == 0) {
    Soup strip;
    for (std::size_t k = 1; k < places.size(); ++k)
      cut::add_strip(places[k - 1], places[k], strip);
    return strip;
  }
  cut::BladePath path;
  for (std::size_t k = 0; k < places.size(); ++k) {
    path.fractions.push_back(static_cast<double>(k) / static_cast<double>(places.size() - 1));
    path.lines.push_back(places[k]);
  }
  return path;
}

/// There and back in one sweep: a soup that is met twice has no border.
NamedSweep there_and_back(const NamedSweep& last) {
  const std::string name = "there and back " + last.name;
  if (const auto* soup = std::get_if<Soup>(&last.sweep)) {
    Soup twice = *soup;
    for (const auto& [a, b, c] : *soup)
      twice.push_back({c, b, a});
    return {name, twice, Extent::closed};
  }
  if (const auto* path = std::get_if<cut::BladePath>(&last.sweep)) {
    cut::BladePath twice;
    const std::size_t n = path->lines.size();
    for (std::size_t k = 0; k + 1 < 2 * n; ++k) {
      twice.fractions.push_back(static_cast<double>(k) / static_cast<double>(2 * n - 2));
      twice.lines.push_back(path->lines[k < n ? k : 2 * n - 2 - k]);
    }
    return {name, twice, Extent::open}; // each edge sees it in a motion of its own
  }
  return last;
}

/// The way back, as a sweep of its own.
Sweep reversed(Sweep sweep) {
  if (auto* soup = std::get_if<Soup>(&sweep))
    std::reverse(soup->begin(), soup->end());
  if (auto* path = std::get_if<cut::BladePath>(&sweep))
    std::reverse(path->lines.begin(), path->lines.end());
  return sweep;
}

std::optional<NamedSweep> after(const std::optional<NamedSweep>& last, const int choice) {
  if (!last)
    return std::nullopt;
  const std::string& name = last->name;
  switch (choice) {
    case 0:
      return NamedSweep{"again " + name, last->sweep, last->extent};
    case 1:
      return NamedSweep{"back " + name, reversed(last->sweep), last->extent};
    case 2:
      return there_and_back(*last);
    default:
      return std::nullopt;
  }
}

} // namespace

NamedSweep random_sweep(const Subject& subject, const std::optional<NamedSweep>& last, Random& random) {
  if (auto repeated = after(last, draw(random, 16)))
    return *repeated;
  Draw drawn(subject, random);
  switch (draw(random, 13)) {
    case 0:
      return {"through nodes", swept(drawn.through_nodes(), random)};
    case 1:
      return {"along edges", swept(drawn.along_edges(), random)};
    case 2:
      return {"tangential", swept(drawn.tangential(), random)};
    case 3:
      return {"of zero length", swept(drawn.resting(), random)};
    case 4:
      return {"self-crossing", swept(drawn.self_crossing(), random)};
    case 5:
      return {"turning", drawn.turning()};
    case 6:
      return {"soup", drawn.soup()};
    case 7:
      return {"in faces", drawn.in_faces()};
    case 8:
      return {"slivers", drawn.slivers()};
    case 9:
    case 10:
      return drawn.surface();
    default:
      return {"stroke", swept(drawn.stroke(), random)};
  }
}

NamedSweep random_surface(const Subject& subject, Random& random) { return Draw(subject, random).surface(); }

namespace {

cut::SweepCuts meet(const Subject& subject, const Sweep& sweep, const grid::CutLabel label,
                    const cut::EdgeBoxes* const boxes) {
  const auto met = [&](const auto& by) {
    using By = std::decay_t<decltype(by)>;
    if constexpr (std::is_same_v<By, cut::CutSurface>) {
      cut::CutSurface labelled = by;
      labelled.label = label;
      return cut::cut_edges(labelled, subject.solid, subject.x, boxes);
    } else if constexpr (std::is_same_v<By, cut::BladePath>) {
      return cut::cut_edges(by, subject.solid, subject.cutter.stands_at(), subject.x, label, boxes);
    } else {
      return cut::cut_edges(by, subject.solid, subject.x, label, boxes);
    }
  };
  return std::visit(met, sweep);
}

bool is_same(const grid::EdgeCut& a, const grid::EdgeCut& b) {
  return a.edge == b.edge && a.t == b.t && a.normal == b.normal && a.label == b.label;
}
bool is_same_of_skin(const grid::SkinCut& a, const grid::SkinCut& b) {
  return a.segment == b.segment && a.t == b.t && a.normal == b.normal && a.label == b.label;
}

} // namespace

cut::SweepCuts meet(Subject& subject, const Sweep& sweep, const grid::CutLabel label) {
  if (std::holds_alternative<cut::CutSurface>(sweep))
    subject.boxes.fit(subject.x);
  else
    subject.boxes.fit(subject.cutter.stands_at(), subject.x);
  const auto found = meet(subject, sweep, label, &subject.boxes), all = meet(subject, sweep, label, nullptr);
  if (found.n_double_crossings != all.n_double_crossings || !std::ranges::equal(found.cuts, all.cuts, is_same) ||
      !std::ranges::equal(found.of_skin, all.of_skin, is_same_of_skin))
    throw Violation("among the boxes " + std::to_string(found.cuts.size()) + " edges and " +
                    std::to_string(found.of_skin.size()) + " segments of the skin are cut and " +
                    std::to_string(found.n_double_crossings) + " crossed twice, among all " +
                    std::to_string(all.cuts.size()) + ", " + std::to_string(all.of_skin.size()) + " and " +
                    std::to_string(all.n_double_crossings));
  return found;
}

} // namespace kerf::fuzz
