#include "physics/on_corners.h"

#include "dynamics/rigid_body.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>

namespace kerf::physics {

namespace {

/// What a corner has of its copies' material [kg].
std::vector<double> material_mass(const fem::Hexahedra& model) {
  std::vector<double> mass(model.incidence().n_corners(), 0.0);
  for (std::size_t i = 0; i < mass.size(); ++i)
    for (const auto user : model.incidence().users(i))
      mass[i] += model.element(user / 8).mass[user % 8];
  return mass;
}

/// The largest t of 0 .. 1 up to which a t^2 + b t is no more than c, for a and c that are not negative.
double part_within(const double a, const double b, const double c) {
  if (a + b <= c)
    return 1;
  const double root = std::sqrt(b * b + 4 * a * c);
  return b > 0 ? 2 * c / (b + root) : (root - b) / (2 * a);
}

} // namespace

lattice::Riders riders_of(const fem::Hexahedra& model, const CutBody& body) {
  constexpr double light = 1.0 / 32; // of a cube: what holds corners of less fades with their mass (ghost_penalty.h)
  if (model.inertia() != fem::Inertia::extended)
    return {};
  const double h = body.solid.grid.h();
  return {body.solid.complex, material_mass(model), body.density * h * h * h, light, grid::rest_positions(body.solid),
          h};
}

Bearers bearers_of(const fem::Hexahedra& model, const CutBody& body, std::span<const double>) {
  const double eight = 8 * std::pow(model.h(), 3);
  std::vector<double> material(model.incidence().n_corners(), 0.0);
  for (std::size_t i = 0; i < material.size(); ++i)
    for (const auto user : model.incidence().users(i))
      material[i] += model.element(user / 8).volume / eight;
  return {body.solid, material, corners_of_cut_copies(body.solid, body.surface)};
}

void damp_riders(const fem::Hexahedra& model, const lattice::Riders& riders, const std::span<const double> mass,
                 const dynamics::Loads& loads, const double dt, dynamics::State& state) {
  if (riders.n_riders() == 0)
    return;
  const double across = model.material().pressure_wave_speed() / model.h(),
               alpha = std::min(1.0, across * dt * across * dt);
  Loan<Vec3> before = Loan<Vec3>::with_room(state.v.size());
  for (const dynamics::Support& support : loads.supports)
    for (const auto i : support.corners)
      before->push_back(state.v[i]);
  riders.damp(state.x, mass, alpha, state.v);
  std::size_t k = 0;
  for (const dynamics::Support& support : loads.supports)
    for (const auto i : support.corners)
      state.v[i] -= support.held * (state.v[i] - before[k++]);
}

std::vector<std::uint8_t> touched_corners(const grid::CellComplex& complex, const grid::CutChange& change) {
  std::vector<std::uint8_t> is_touched(complex.n_corners(), 0);
  for (const grid::CopyId c : change.reshaped)
    for (const grid::CornerId corner : complex.copies[c].corners)
      is_touched[corner.value] = 1;
  return is_touched;
}

std::vector<std::uint32_t> counted_pieces(std::vector<std::uint32_t> of_corners, const grid::CornerNumbers& numbers) {
  if (numbers.are_all())
    return of_corners;
  constexpr std::uint32_t none = 0xffffffff;
  std::vector<std::uint32_t> name(of_corners.size(), none), pieces; // no more pieces than corners
  std::uint32_t n = 0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    std::uint32_t& piece = name[of_corners[numbers.corner(i)]];
    if (piece == none)
      piece = n++;
    pieces.push_back(piece);
  }
  return pieces;
}

void join_lapsed(const std::span<const grid::Lapse> lapsed, const std::function<double(std::uint32_t)>& mass,
                 dynamics::State& state) {
  std::map<std::uint32_t, double> mass_of_heir;
  Vec3 L = Vec3::Zero(); // that they had more than the heirs have in the end
  double taken = 0;      // twice the kinetic energy that the joining takes
  const auto turning = [&](const std::uint32_t corner) -> Vec3 { return state.x[corner].cross(state.v[corner]); };
  for (const auto& [corner, heir] : lapsed) {
    const auto [of_heir, is_new] = mass_of_heir.try_emplace(heir.value, mass(heir.value));
    const double more = mass(corner.value), all = of_heir->second + more;
    if (is_new)
      L += of_heir->second * turning(heir.value);
    L += more * turning(corner.value);
    if (more > 0) {
      taken += of_heir->second * more / all * (state.v[corner.value] - state.v[heir.value]).squaredNorm();
      for (Points* of_corners : {&state.x, &state.v}) {
        Vec3& value = (*of_corners)[heir.value];
        value += more / all * ((*of_corners)[corner.value] - value);
      }
    }
    of_heir->second = all;
  }
  double all = 0;
  Vec3 centre = Vec3::Zero();
  for (const auto& [heir, m] : mass_of_heir) {
    L -= m * turning(heir);
    all += m;
    centre += m * state.x[heir];
  }
  if (!(all > 0))
    return;
  centre /= all;
  Mat3 inertia = Mat3::Zero();
  Vec3 spin = Vec3::Zero();
  for (const auto& [heir, m] : mass_of_heir) {
    const Vec3 r = state.x[heir] - centre;
    inertia += m * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
    spin += m * r.cross(state.v[heir]);
  }
  const Vec3 omega = dynamics::angular_velocity(inertia, all * centre.squaredNorm(), L);
  const double part = part_within(omega.dot(inertia * omega), 2 * omega.dot(spin), taken);
  for (const auto& [heir, m] : mass_of_heir)
    state.v[heir] += part * omega.cross(state.x[heir] - centre);
}

void carry_momentum(const grid::CellComplex& complex, const std::span<const std::uint32_t> corners,
                    const std::span<const double> before, const std::span<const double> now, Points& v) {
  struct Lost {
    Vec3 v; // mean
    double mass = 0;
  };
  std::map<grid::NodeId, Lost> lost_at;
  for (const auto i : corners)
    if (const double lost = before[i] - now[i]; lost > 0) {
      Lost& all = lost_at.try_emplace(complex.node[grid::CornerId(i)], Lost{v[i]}).first->second;
      all.mass += lost;
      all.v += lost / all.mass * (v[i] - all.v);
    }
  for (const auto i : corners)
    if (const double got = now[i] - before[i]; got > 0)
      if (const auto lost = lost_at.find(complex.node[grid::CornerId(i)]); lost != lost_at.end())
        v[i] += got / now[i] * (lost->second.v - v[i]);
}

} // namespace kerf::physics
