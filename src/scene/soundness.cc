#include "scene/soundness.h"

#include "base/error.h"
#include "base/loan.h"
#include "base/parallel.h"
#include "dynamics/conjugate_gradients.h"
#include "dynamics/forces.h"
#include "material/polar.h"
#include "physics/on_corners.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>
#include <span>

namespace kerf::scene {

namespace {

std::string in_short(const double value) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.4g", value);
  return text.data();
}

std::string place(const Vec3& p) {
  return "(" + in_short(p[0]) + ", " + in_short(p[1]) + ", " + in_short(p[2]) + ") m";
}

constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

/// Of particles in a row.
struct Motion {
  std::size_t lost = none; ///< the first one without a finite place
  std::size_t fastest = 0; ///< against the mean motion
  double squared_speed = 0; ///< of that [m^2/s^2]
  double squared_way = 0;   ///< of the one that comes farthest against the mean motion [m^2]

  Motion& operator+=(const Motion& next) {
    lost = std::min(lost, next.lost);
    squared_way = std::max(squared_way, next.squared_way);
    if (next.squared_speed > squared_speed) {
      squared_speed = next.squared_speed;
      fastest = next.fastest;
    }
    return *this;
  }
};

Vec3 mean_velocity(const dynamics::ForceModel& model, const Points& v) {
  const auto [mass, momentum] = dynamics::mass_and_momentum(model, v);
  return mass > 0 ? Vec3(momentum / mass) : Vec3(Vec3::Zero());
}

const grid::Copy& copy_of(const Body& body, const std::size_t c) {
  return body.solid.complex.copies[grid::CopyId(static_cast<std::uint32_t>(c))];
}

/// The twelve edges of a copy, four along each axis [m].
std::array<Vec3, 12> edges(const Points& x, const grid::Copy& copy) {
  std::array<Vec3, 12> all;
  std::size_t n = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (int v = 0; v < 8; ++v)
      if ((v >> axis & 1) == 0)
        all[n++] = x[copy.corners[v | 1 << axis].value] - x[copy.corners[v].value];
  return all;
}

/// F in the middle of a copy: the mean of its four edges along each axis.
Mat3 mean_gradient(const std::array<Vec3, 12>& edges, const double h) {
  Mat3 F;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Vec3* const e = &edges[4 * axis];
    F.col(static_cast<Eigen::Index>(axis)) = (e[0] + e[1] + e[2] + e[3]) / (4 * h);
  }
  return F;
}
double volume_ratio(const std::array<Vec3, 12>& edges, const double h) { return mean_gradient(edges, h).determinant(); }

std::string in_words(const Body& body, const std::size_t copy) {
  const grid::Grid& grid = body.solid.grid;
  const Vec3 middle = grid.origin(copy_of(body, copy).cell) + Vec3::Constant(0.5 * grid.h());
  return "copy " + std::to_string(copy) + ", whose cube rests around " + place(middle);
}

/// The copy whose cube has turned inside out most, of a piece or of all.
std::string worst_copy(const Body& body, const std::function<bool(std::size_t)>& is_meant) {
  std::size_t worst = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < body.solid.complex.n_copies(); ++c)
    if (is_meant(c))
      if (const double ratio = volume_ratio(edges(corners(body), copy_of(body, c)), body.solid.grid.h());
          ratio < least) {
        least = ratio;
        worst = c;
      }
  return in_words(body, worst);
}

bool is_rigid(const Body& body, const std::size_t c) {
  return body.solid.crumbs.holds(grid::CopyId(static_cast<std::uint32_t>(c)));
}

std::size_t n_nodes(const grid::Copy& copy) {
  return static_cast<std::size_t>(std::popcount(static_cast<unsigned>(copy.nodes)));
}

/// The material of a piece over that of a cube, by its nodes: an eighth for each. None of a rigid one.
struct PieceVolume {
  double rest = 0, now = 0;
};

/// What becomes of the cubes of copies that are not rigid.
struct Cubes {
  std::size_t n_nodes = 0, n_inverted = 0; ///< of them: those of copies that are inside out in their middle
  std::size_t longest = 0;                 ///< the copy that has the longest edge
  double squared_length = 0;               ///< of that [m^2]
  PieceVolume volume = {};                 ///< of all pieces

  Cubes& operator+=(const Cubes& more) {
    n_nodes += more.n_nodes;
    n_inverted += more.n_inverted;
    volume.rest += more.volume.rest;
    volume.now += more.volume.now;
    if (more.squared_length > squared_length) {
      longest = more.longest;
      squared_length = more.squared_length;
    }
    return *this;
  }
};

/// Copies side by side, a lane each.
struct Lanes {
  static constexpr std::size_t n = 8;

  std::array<std::size_t, n> copies;
  std::size_t n_used = 0;
  double corners[8][3][n];  ///< [m]
  double ratio[n];          ///< det F in the middle of each [1]
  double squared_length[n]; ///< of its longest edge [m^2]

  void add(const std::size_t c, const grid::Copy& copy, const Points& x) {
    for (std::size_t v = 0; v < 8; ++v)
      for (int i = 0; i < 3; ++i)
        corners[v][i][n_used] = x[copy.corners[v].value][i];
    copies[n_used++] = c;
  }
};

/// What follows from the corners.
__attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"))) void measure(Lanes& lanes,
                                                                                            const double h) {
  const double scale = 1 / (64 * h * h * h); // each column of F is a mean of four edges
  for (std::size_t l = 0; l < Lanes::n; ++l) {
    double F[3][3], longest = 0;
#pragma GCC unroll 3
    for (int axis = 0; axis < 3; ++axis) {
      F[axis][0] = F[axis][1] = F[axis][2] = 0;
#pragma GCC unroll 8
      for (int v = 0; v < 8; ++v) {
        if ((v >> axis & 1) != 0)
          continue;
        const int w = v | 1 << axis;
        const double x = lanes.corners[w][0][l] - lanes.corners[v][0][l],
                     y = lanes.corners[w][1][l] - lanes.corners[v][1][l],
                     z = lanes.corners[w][2][l] - lanes.corners[v][2][l], square = x * x + y * y + z * z;
        F[axis][0] += x;
        F[axis][1] += y;
        F[axis][2] += z;
        longest = square > longest ? square : longest;
      }
    }
    lanes.squared_length[l] = longest;
    lanes.ratio[l] = scale * (F[0][0] * (F[1][1] * F[2][2] - F[1][2] * F[2][1]) +
                              F[0][1] * (F[1][2] * F[2][0] - F[1][0] * F[2][2]) +
                              F[0][2] * (F[1][0] * F[2][1] - F[1][1] * F[2][0]));
  }
}

/// Of all copies that are not rigid. Calls put(copy, rest, now), from several threads at once, with the material of
/// each over that of a cube.
template <class Put>
Cubes cubes(const Body& body, const Put& put) {
  const Points& x = corners(body);
  const double h = body.solid.grid.h();
  const auto take = [&](Lanes& lanes, Cubes& all) {
    measure(lanes, h);
    for (std::size_t lane = 0; lane < lanes.n_used; ++lane) {
      const std::size_t c = lanes.copies[lane], n = n_nodes(copy_of(body, c));
      const double rest = double(n) / 8, now = rest * lanes.ratio[lane];
      all += {n, lanes.ratio[lane] < 0 ? n : 0, c, lanes.squared_length[lane], {rest, now}};
      put(c, rest, now);
    }
    lanes.n_used = 0;
  };
  return dynamics::sum_in_blocks(
    body.solid.complex.n_copies(), Cubes(), [&](const std::size_t begin, const std::size_t end, Cubes& all) {
      Lanes lanes = {};
      for (std::size_t c = begin; c < end; ++c) {
        if (is_rigid(body, c))
          continue;
        lanes.add(c, copy_of(body, c), x);
        if (lanes.n_used == Lanes::n)
          take(lanes, all);
      }
      take(lanes, all);
    });
}
Cubes cubes(const Body& body) {
  return cubes(body, [](std::size_t, double, double) {});
}

/// The same, and of each piece.
Cubes cubes(const Body& body, Loan<PieceVolume>& pieces) {
  pieces = Loan<PieceVolume>(body.pieces.n_pieces, PieceVolume());
  if (pieces.size() == 1) {
    const Cubes all = cubes(body);
    pieces[0] = all.volume;
    return all;
  }
  Loan<PieceVolume> volumes(body.solid.complex.n_copies(), PieceVolume()); // of copies
  const Cubes all =
    cubes(body, [&](const std::size_t c, const double rest, const double now) { volumes[c] = {rest, now}; });
  for (std::size_t c = 0; c < volumes.size(); ++c) {
    PieceVolume& piece = pieces[body.pieces.piece[grid::CopyId(static_cast<std::uint32_t>(c))]];
    piece.rest += volumes[c].rest;
    piece.now += volumes[c].now;
  }
  return all;
}

Stretch stretch_of(const Cubes& all, const Body& body) {
  return {all.longest, std::sqrt(all.squared_length) / body.solid.grid.h()};
}

constexpr char remedy[] = "What acts on it in a step is more than its material bears: use a smaller time step, smaller "
                          "loads or a stiffer material";

/// Whether the body was put where it has such an energy, and has it still: then it may pass through any shape.
bool may_be_anywhere(const Body& body) {
  if (!body.initial)
    return false;
  constexpr double little_more = 1.25; // what integrators that keep energy add and take back
  return inner_energy(*body.physics, body.state) <= little_more * body.initial->energy;
}

/// By how far a copy's corners are from where its cube would have them, turned as it is: at most [m].
double distortion(const Points& rest, const Points& x, const grid::Copy& copy, const double h) {
  Vec3 middle = Vec3::Zero(), middle_at_rest = Vec3::Zero();
  for (const grid::CornerId corner : copy.corners) {
    middle += x[corner.value] / 8;
    middle_at_rest += rest[corner.value] / 8;
  }
  const Mat3 R = material::rotation_of(mean_gradient(edges(x, copy), h));
  double most = 0;
  for (const grid::CornerId corner : copy.corners)
    most = std::max(most, (x[corner.value] - middle - R * (rest[corner.value] - middle_at_rest)).norm());
  return most;
}

/// How far a step may take each particle: what is held as far as its support goes; a corner twice as far as two of its
/// copy are from where the cube would have them. So far it snaps, to there and beyond, when a cut lets it go while the
/// body hangs from where it was held, and time steps do not resolve that.
Loan<double> room_of_particles(const Body& body, const Points& before) {
  Loan<double> room(before.size(), 0.0);
  if (body.physics->particles_are_corners())
    for (const grid::Copy& copy : body.solid.complex.copies) {
      const double way = 4 * distortion(body.physics->rest(), before, copy, body.solid.grid.h());
      for (const grid::CornerId corner : copy.corners)
        room[corner.value] = std::max(room[corner.value], way);
    }
  const auto held = dynamics::held_corners(body.loads, before.size());
  for (std::size_t i = 0; i < room.size(); ++i)
    if (held[i] != 0)
      room[i] = std::numeric_limits<double>::infinity();
  return room;
}

bool is_of_small_strain(const Body& body) {
  const auto* const elements = dynamic_cast<const physics::Elements*>(body.physics.get());
  return elements && elements->own_model().material().law == "small strain";
}

} // namespace

std::string particle_at(const Body& body, const std::size_t particle) {
  const Points& rest = body.physics->rest();
  return "particle " + std::to_string(particle) +
         (particle < rest.size() ? ", which rests at " + place(rest[particle]) : "");
}

double require_sound_motion(const Body& body, const Points& before, const double dt) {
  const dynamics::ForceModel& model = body.physics->model();
  const Vec3 mean = mean_velocity(model, body.state.v), mean_way = dt * mean;
  const auto motion_but_of = [&](const std::span<const double> room) {
    return dynamics::sum_in_blocks(
      body.state.x.size(), Motion(), [&](const std::size_t begin, const std::size_t end, Motion& part) {
        for (std::size_t i = begin; i < end; ++i) {
          const Vec3 &x = body.state.x[i], &v = body.state.v[i];
          const double speed = (v - mean).squaredNorm();
          part.squared_way = std::max(part.squared_way, (x - before[i] - mean_way).squaredNorm());
          if (!std::isfinite(speed + x.sum()))
            part += {i, 0, 0};
          else if (speed > part.squared_speed) {
            const double least = std::min(speed, ((x - before[i]) / dt - mean).squaredNorm());
            if (room.empty() || std::sqrt(least) * dt > room[i])
              part += {none, i, least};
          }
        }
      });
  };
  const auto is_slow = [&](const Motion& all) { return std::sqrt(all.squared_speed) * dt <= body.solid.grid.h(); };
  Motion all = motion_but_of({});
  if (all.lost != none)
    throw NumericalError("the motion has diverged: " + particle_at(body, all.lost) + ", has no finite place any more");
  const double way = std::sqrt(all.squared_way);
  if (is_slow(all))
    return way;
  all = motion_but_of(room_of_particles(body, before));
  if (is_slow(all))
    return way;
  const double speed = std::sqrt(all.squared_speed);
  const double eighth = body.density * std::pow(body.solid.grid.h(), 3) / 8,
               now = dynamics::kinetic_energy(model, body.state.v) + model.energy(body.state.x),
               energy = body.initial ? std::max(now, body.initial->energy) : now; // which a corner may still have
  if (0.5 * eighth * speed * speed > energy)
    throw NumericalError("the motion has diverged: " + particle_at(body, all.fastest) + ", moves at " + in_short(speed) +
                         " m/s, faster than all energy of the body (" + in_short(energy) +
                         " J) could move an eighth of a cube. Use a smaller time step");
  return way;
}

UnsoundVolume unsound_volume(const Body& body) {
  constexpr double most = 10, most_inverted = 0.1;
  Loan<PieceVolume> pieces;
  const Cubes all = cubes(body, pieces);
  const bool is_small_strain = is_of_small_strain(body);
  constexpr double most_turned = 1.25; // small strain takes I + tan(a) x for a turn by a: 1 + tan^2(a) of the volume
  for (std::uint32_t p = 0; p < pieces.size(); ++p) {
    if (pieces[p].rest < 1)
      continue;
    const double ratio = pieces[p].now / pieces[p].rest;
    if (is_small_strain && ratio > most_turned)
      return {"piece " + std::to_string(p) + " has " + in_short(100 * ratio) +
                " % of its volume at rest: small strain takes rotations for strains, and this piece turns",
              "Use another law, or smaller loads: all that they do is in proportion"};
    if (ratio > 1 / most && ratio < most)
      continue;
    const std::string how = ratio > 1 ? "blown up" : ratio > 0 ? "crushed" : "inside out";
    return {"piece " + std::to_string(p) + " is " + how + ": its volume is " + in_short(100 * ratio) +
              " % of that at rest. Worst is " +
              worst_copy(body, [&](const std::size_t c) { return body.pieces.piece[grid::CopyId(c)] == p; }),
            remedy};
  }
  // Nodes count, so near-empty copies hardly do.
  if (const double part = double(all.n_inverted) / double(std::max<std::size_t>(all.n_nodes, 1)); part > most_inverted)
    return {in_short(100 * part) + " % of the body are inside out. Worst is " +
              worst_copy(body, [](std::size_t) { return true; }),
            remedy};
  constexpr double most_stretch = 32; // of 308 sound runs of unseen bodies 4 come to more than 12, none to more than 16
  if (const Stretch stretch = stretch_of(all, body); stretch.factor > most_stretch)
    return {in_words(body, stretch.copy) + ", is drawn out to " + in_short(stretch.factor) + " times its edge", remedy};
  return {};
}

Stretch largest_stretch(const Body& body) {
  return stretch_of(cubes(body), body);
}

void require_sound_volume(const Body& body, Watch& watch, const bool is_last) {
  constexpr double little = 0.125; // cubes
  if (watch.is_sound && !is_last && body.physics->particles_are_corners() &&
      watch.way <= little * body.solid.grid.h())
    return;
  const auto [what, remedy] = unsound_volume(body);
  watch = {what.empty(), 0};
  if (!what.empty() && !may_be_anywhere(body))
    throw NumericalError(what + ". " + remedy);
}

} // namespace kerf::scene
