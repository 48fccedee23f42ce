#include "tests/compare/grind.h"

#include "cut/target.h"
#include "grid/followed.h"
#include "grid/locate.h"

#include <Eigen/Geometry>

#include <cmath>

namespace kerf::scene {

namespace {

constexpr double dt = 0.002;   // [s]
constexpr double speed = 0.05; // of the corners at first, one deviation an axis [m/s]

World free_cube(const std::string& backend) {
  return world_of(cube_scene() + falling_blade(),
                  {"Body cube/Cube edge [m]=0.04", "Body cube/Backend=" + backend, "Time/Time step [s]=0.002"});
}

std::vector<grid::EdgeId> edges_that_hold(const Body& body) {
  std::vector<grid::EdgeId> edges;
  for (const grid::CellId c : ids<grid::CellId>(body.solid.grid.n_cells()))
    for (const grid::EdgeId e : body.solid.grid.edges(c))
      if (const auto [a, b] = body.solid.grid.ends(e);
          !body.solid.cuts.is_cut(e) && body.solid.grid.is_material(a) && body.solid.grid.is_material(b))
        edges.push_back(e);
  return edges;
}

/// Segments of the skin that join what belongs to different nodes, as they stand now.
std::vector<cut::Segment> skin_that_holds(const Body& body) {
  std::vector<cut::Segment> segments;
  for (const grid::CellId c : ids<grid::CellId>(body.solid.grid.n_cells())) {
    const grid::CellCuts cuts = grid::cuts_of(body.solid, c);
    const grid::Skeleton& skeleton = cuts.skeleton();
    if (!cuts.has_skin())
      continue;
    cut::SkinNow(body.solid, c).for_each_segment([&](const int segment) {
      if ((cuts.blades >> segment & 1) != 0)
        return;
      const auto& ends = skeleton.segment[segment].ends;
      if (skeleton.vertex[ends[0]] != skeleton.vertex[ends[1]])
        segments.push_back(cut::SkinNow(body.solid, c).segment(segment, corners(body)));
    });
  }
  return segments;
}

struct Sums {
  double mass = 0, energy = 0;
  Vec3 momentum = Vec3::Zero();
};

Sums sums(const Body& body) {
  Sums all{.energy = total_energy(*body.physics, body.loads, body.state)};
  const auto mass = body.physics->model().lumped_mass();
  for (std::size_t i = 0; i < mass.size(); ++i) {
    all.mass += mass[i];
    all.momentum += mass[i] * body.state.v[i];
  }
  all.mass += body.physics->crumbs().mass();
  all.momentum += body.physics->crumbs().momentum(body.state);
  return all;
}

bool is_finite(const Body& body) {
  double sum = 0;
  for (const Points* points : {&body.state.x, &body.state.v, &corners(body), &positions(body)})
    for (const Vec3& p : *points)
      sum += p.sum();
  return std::isfinite(sum);
}

std::vector<bool> pieces_with_nodes(const grid::CellComplex& complex) {
  const grid::Pieces pieces = grid::pieces(complex);
  std::vector<bool> has_node(pieces.n_pieces, false);
  for (const auto c : ids<grid::CopyId>(complex.n_copies()))
    if (complex.copies[c].nodes != 0)
      has_node[pieces.piece[c]] = true;
  return has_node;
}

/// In shape matching a splinter without a node goes with the node that it follows, rigidly: they are one body.
void join_splinters(const grid::Solid& solid, std::vector<std::uint32_t>& corner_pieces) {
  for (const auto& [copy, node] : grid::followed_nodes(solid))
    std::replace(corner_pieces.begin(), corner_pieces.end(),
                 std::uint32_t(corner_pieces[solid.complex.copies[copy].corners[0].value]),
                 std::uint32_t(corner_pieces[solid.complex.real_corner[node].value]));
}

class Grinder {
 public:
  Grinder(const std::string& backend, const unsigned seed, const int most_strokes)
    : random_(seed), is_lattice_(backend == "lattice"), world_(free_cube(backend)) {
    set_in_motion(body(), Vec3(0.02, 0.01, -0.03), speed);
    body().cutter = std::make_unique<cut::Cutter>(most_strokes); // else shavings would stay (cut/shreds.h)
    body().cutter->begin(body().solid, corners(body()));
    at_first_ = sums(body());
  }

  Body& body() { return world_.bodies.at(0); }

  /// A short stroke that crosses a random edge that still holds, or where none does a segment of the skin; false when
  /// there is none.
  bool aim() {
    const auto edges = edges_that_hold(body());
    const auto skin = edges.empty() ? skin_that_holds(body()) : std::vector<cut::Segment>();
    if (edges.empty() && skin.empty())
      return false;
    const auto current = [&](const grid::EdgeId e) {
      const auto [a, b] = body().solid.grid.ends(e);
      return cut::Segment{corners(body())[body().solid.complex.real_corner[a].value],
                          corners(body())[body().solid.complex.real_corner[b].value]};
    };
    const auto [from, to] = edges.empty() ? skin[random_() % skin.size()] : current(edges[random_() % edges.size()]);
    const Vec3 along = (to - from).normalized();
    Vec3 blade, way;
    do {
      blade = direction();
      way = direction();
    } while (std::abs(blade.cross(way).dot(along)) < 0.3);
    const Vec3 middle = from + uniform(0.2, 0.8) * (to - from);
    constexpr double reach = 0.02; // half a cube [m]
    cut::Blade& knife = world_.blades.at(0);
    knife.label = next_label_++;
    knife.edge = {-reach * blade, reach * blade};
    knife.key_frames = {{time_, middle - reach * way}, {time_ + dt, middle + reach * way}};
    return true;
  }

  void step(Ground& ground) {
    Timings timings;
    const Sums before = sums(body());
    recut(body(), world_.blades, time_, time_ + dt, timings);
    const Sums cut = sums(body());
    ground.most_work_of_cut = std::max(ground.most_work_of_cut, (cut.energy - before.energy) / at_first_.energy);
    body().physics->catch_up(seen(body()));
    body().report = body().physics->step(body().state, body().loads, dt);
    follow(body());
    time_ += dt;
    watch(cut, ground);
    watch(sums(body()), ground);
    ground.is_finite = ground.is_finite && is_finite(body());
  }

  /// How far crumbs, and the particles of other pieces, stray from where their velocities would take them.
  void fly(Ground& ground) {
    world_.blades.at(0).key_frames = {{0, Vec3(9, 9, 9)}};
    step(ground); // where cuts cross, cells are parted once the blade has left them
    const auto piece = pieces();
    const auto [start, velocity] = centres(piece);
    const auto crumbs = body().state.crumbs;
    const double begin = time_;
    for (int i = 0; i < 20; ++i)
      step(ground);
    for (std::size_t b = 0; b < crumbs.size(); ++b) {
      const Vec3 way = (time_ - begin) * crumbs[b].v;
      ground.most_drift =
        std::max(ground.most_drift, (body().state.crumbs[b].x - crumbs[b].x - way).norm() / (speed * (time_ - begin)));
    }
    const auto [end, unused] = centres(piece);
    const std::vector<bool> has_node = pieces_with_nodes(body().solid.complex);
    for (std::size_t p = 0; p < start.size(); ++p) {
      if (!has_node[p])
        continue; // in some backends it follows a node
      const Vec3 way = (time_ - begin) * velocity[p];
      ground.most_drift = std::max(ground.most_drift, (end[p] - start[p] - way).norm() / (speed * (time_ - begin)));
    }
  }

 private:
  double uniform(const double low, const double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  Vec3 direction() {
    std::normal_distribution<double> normal;
    Vec3 d;
    for (int axis = 0; axis < 3; ++axis)
      d[axis] = normal(random_);
    return d.normalized();
  }

  void watch(const Sums& now, Ground& ground) const {
    ground.most_energy = std::max(ground.most_energy, now.energy / at_first_.energy);
    ground.most_mass = std::max(ground.most_mass, std::abs(now.mass / at_first_.mass - 1));
    ground.most_momentum =
      std::max(ground.most_momentum, (now.momentum - at_first_.momentum).norm() / (at_first_.mass * speed));
  }

  /// The piece of each particle: of a phyxel, that of the material around it.
  std::vector<std::uint32_t> pieces() {
    if (body().state.x.size() == body().solid.complex.n_corners()) {
      auto piece = grid::corner_pieces(body().solid.complex);
      if (is_lattice_)
        join_splinters(body().solid, piece);
      return piece;
    }
    const grid::Pieces all = grid::pieces(body().solid.complex);
    std::vector<std::uint32_t> piece;
    for (const Vec3& rest : body().physics->rest())
      piece.push_back(all.piece[grid::copy_around(body().solid, rest)]);
    return piece;
  }

  /// Centre of mass and velocity of each piece.
  std::pair<Points, Points> centres(const std::vector<std::uint32_t>& piece) {
    const auto mass = body().physics->model().lumped_mass();
    const std::size_t n = 1 + *std::max_element(piece.begin(), piece.end());
    std::vector<double> sum(n, 1e-300); // a piece may be too small for a phyxel
    Points x(n, Vec3::Zero()), v(n, Vec3::Zero());
    for (std::size_t i = 0; i < piece.size(); ++i) {
      sum[piece[i]] += mass[i];
      x[piece[i]] += mass[i] * body().state.x[i];
      v[piece[i]] += mass[i] * body().state.v[i];
    }
    for (std::size_t p = 0; p < n; ++p) {
      x[p] /= sum[p];
      v[p] /= sum[p];
    }
    return {x, v};
  }

  std::mt19937 random_;
  bool is_lattice_;
  World world_;
  double time_ = 0;
  grid::CutLabel next_label_ = 1; ///< each stroke is a blade of its own
  Sums at_first_;
};

} // namespace

Ground grind(const std::string& backend, const unsigned seed, const int most_strokes) {
  Grinder grinder(backend, seed, most_strokes);
  Ground ground;
  for (; ground.n_strokes < most_strokes && grinder.aim(); ++ground.n_strokes)
    grinder.step(ground);
  grinder.fly(ground);
  const Body& body = grinder.body();
  const std::vector<bool> has_node = pieces_with_nodes(body.solid.complex);
  ground.n_pieces = static_cast<std::size_t>(std::count(has_node.begin(), has_node.end(), true));
  ground.n_splinters = has_node.size() - ground.n_pieces;
  for (const grid::NodeId n : ids<grid::NodeId>(body.solid.grid.n_nodes()))
    ground.n_nodes += body.solid.grid.is_material(n) ? 1 : 0;
  return ground;
}

} // namespace kerf::scene
