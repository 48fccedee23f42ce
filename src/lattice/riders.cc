#include "lattice/riders.h"

#include "grid/carriers.h"
#include "material/polar.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <optional>

namespace kerf::lattice {

namespace {

using grid::CopyId;

/// A rigid body of some corners.
struct Rigid {
  double mass = 0;         ///< [kg]
  bool is_in_line = true;  ///< its corners have no spin about their line, or none at all
  Vec3 centre = Vec3::Zero(), velocity = Vec3::Zero(), spin = Vec3::Zero();
  Mat3 inertia = Mat3::Zero(), inverse_inertia = Mat3::Zero();

  Vec3 velocity_at(const Vec3& p) const { return velocity + spin.cross(p - centre); }
};

Rigid rigid_motion(const std::span<const std::uint32_t> corners, const Points& x, const Points& v,
                   const std::span<const double> mass) {
  Rigid body;
  for (const auto c : corners) {
    body.mass += mass[c];
    body.centre += mass[c] * x[c];
    body.velocity += mass[c] * v[c];
  }
  body.centre /= body.mass;
  body.velocity /= body.mass;
  Vec3 angular = Vec3::Zero();
  for (const auto c : corners) {
    const Vec3 r = x[c] - body.centre;
    body.inertia += mass[c] * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
    angular += mass[c] * r.cross(v[c]);
  }
  constexpr double well_conditioned = 1e-6;
  const double size = body.inertia.trace();
  if (body.inertia.determinant() > well_conditioned * size * size * size) {
    body.is_in_line = false;
    body.inverse_inertia = body.inertia.inverse();
    body.spin = body.inverse_inertia * angular;
  }
  return body;
}

Vec3 middle_of(const std::span<const std::uint32_t> corners, const Points& x) {
  Vec3 sum = Vec3::Zero();
  for (const auto c : corners)
    sum += x[c];
  return sum / static_cast<double>(corners.size());
}

} // namespace

Riders::Riders(const grid::CellComplex& complex, const std::span<const double> mass, const double mass_of_cube,
               const double light) {
  ride(complex, mass, mass_of_cube, light, 4);
}

Riders::Riders(const grid::CellComplex& complex, const std::span<const double> mass, const double mass_of_cube,
               const double light, const Points& rest, const double h)
  : h_(h) {
  ride(complex, mass, mass_of_cube, light, 5);
  for (const Carrier& carrier : carriers_) {
    const auto corners = carrier.own_corners();
    const Vec3 middle = middle_of(corners, rest);
    Mat3 spread = Mat3::Zero();
    for (const auto c : corners)
      spread += (rest[c] - middle) * (rest[c] - middle).transpose();
    const Mat3 inverse = spread.inverse();
    Slopes& slopes = slopes_.emplace_back();
    for (std::size_t k = 0; k < corners.size(); ++k)
      slopes[k] = inverse * (rest[corners[k]] - middle);
    for (const Rider& rider : riders_of(carrier))
      offsets_.push_back(rest[rider.corner] - middle);
  }
}

void Riders::ride(const grid::CellComplex& complex, const std::span<const double> mass, const double mass_of_cube,
                  const double light, const int n_heavy) {
  constexpr double heavy = 1.0 / 32;
  std::vector<std::uint8_t> is_heavy(mass.size());
  std::ranges::transform(mass, is_heavy.begin(), [&](const double m) { return m >= heavy * mass_of_cube ? 1 : 0; });
  const auto carrier = grid::nearest_carriers(complex, is_heavy, n_heavy);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs; // carrier, corner
  for (std::uint32_t i = 0; i < mass.size(); ++i)
    if (carrier[i] != grid::no_carrier && mass[i] < light * mass_of_cube)
      pairs.emplace_back(carrier[i], i);
  std::ranges::sort(pairs);
  for (const auto& [copy, corner] : pairs) {
    const auto n = static_cast<std::uint32_t>(riders_.size());
    if (carriers_.empty() || n == 0 || pairs[n - 1].first != copy) {
      Carrier& added = carriers_.emplace_back(Carrier{{}, 0, n, n});
      for (const auto a : complex.copies[CopyId(copy)].corners)
        if (is_heavy[a.value])
          added.corners[added.n_corners++] = a.value;
    }
    riders_.push_back({corner, 1 - mass[corner] / (light * mass_of_cube)});
    carriers_.back().last = n + 1;
  }
}

void Riders::count_by(const grid::CornerNumbers& numbers) {
  std::vector<Rider> counted;
  std::vector<Vec3> offsets;
  for (Carrier& carrier : carriers_) {
    for (std::uint32_t k = 0; k < carrier.n_corners; ++k)
      carrier.corners[k] = numbers[carrier.corners[k]];
    const auto first = static_cast<std::uint32_t>(counted.size());
    for (std::uint32_t i = carrier.first; i < carrier.last; ++i) {
      const auto& [corner, need] = riders_[i];
      if (!numbers.counts(corner))
        continue;
      counted.push_back({numbers[corner], need});
      if (!offsets_.empty())
        offsets.push_back(offsets_[i]);
    }
    carrier.first = first;
    carrier.last = static_cast<std::uint32_t>(counted.size());
  }
  riders_ = std::move(counted);
  offsets_ = std::move(offsets);
}

void Riders::settle(const Points& goals, const std::span<const double> mass, Points& x, Points& v) const {
  for (const Carrier& carrier : carriers_)
    settle(carrier, goals, mass, x, v);
}

void Riders::settle(const Carrier& carrier, const Points& goals, const std::span<const double> mass, Points& x,
                    Points& v) const {
  const auto corners = carrier.own_corners();
  if (rigid_motion(corners, x, v, mass).is_in_line)
    return;
  Vec3 moment = Vec3::Zero(), angular = Vec3::Zero(); // that would be gained
  for (const Rider& rider : riders_of(carrier)) {
    const auto i = rider.corner;
    const Vec3 way = rider.need * (goals[i] - x[i]);
    x[i] += way;
    moment += mass[i] * way;
    angular += mass[i] * way.cross(v[i]);
  }
  const Rigid body = rigid_motion(corners, x, v, mass);
  const Vec3 back = -moment / body.mass;
  angular += body.mass * back.cross(body.velocity);
  const Vec3 turned = body.inverse_inertia * angular;
  for (const auto c : corners) {
    v[c] -= turned.cross(x[c] - body.centre);
    x[c] += back;
  }
}

Riders::Place Riders::place(const std::size_t carrier, const Points& x) const {
  const auto corners = carriers_[carrier].own_corners();
  Mat3 F = Mat3::Zero();
  for (std::size_t k = 0; k < corners.size(); ++k)
    F += x[corners[k]] * slopes_[carrier][k].transpose();
  return {middle_of(corners, x), material::rotation_of(F)};
}

double Riders::part(const Place& carrier, const std::size_t rider, const Points& x) const {
  constexpr double from = 0.5, wholly = 1; // cubes
  const Vec3 away = x[riders_[rider].corner] - carrier.middle - carrier.rotation * offsets_[rider];
  return std::clamp((away.norm() / h_ - from) / (wholly - from), 0.0, 1.0);
}

void Riders::damp(const Points& x, const std::span<const double> mass, const double alpha, Points& v) const {
  const double kappa = 2 * std::sqrt(alpha) - alpha;
  for (std::size_t carrier = 0; carrier < carriers_.size(); ++carrier)
    damp(carrier, x, mass, kappa, v);
}

/// The carrier's motion V and spin w after the damping, which is implicit: with r_i a rider's place and m_i kappa_i
/// (v_i - V - w x r_i) what it gives, V and w satisfy six equations of momentum.
void Riders::damp(const std::size_t number, const Points& x, const std::span<const double> mass, const double kappa,
                  Points& v) const {
  const Carrier& carrier = carriers_[number];
  const auto corners = carrier.own_corners();
  const Rigid body = rigid_motion(corners, x, v, mass);
  if (body.is_in_line)
    return;
  const std::optional<Place> place = h_ > 0 ? std::optional(this->place(number, x)) : std::nullopt;
  const auto damping = [&](const std::size_t rider) {
    return riders_[rider].need * kappa * (place ? part(*place, rider, x) : 1);
  };
  Vec3 given = Vec3::Zero(), turned = Vec3::Zero(), moment = Vec3::Zero();
  double damped = 0;
  Mat3 inertia = body.inertia;
  for (std::size_t rider = carrier.first; rider < carrier.last; ++rider) {
    const auto i = riders_[rider].corner;
    const double by = mass[i] * damping(rider);
    const Vec3 r = x[i] - body.centre, relative = v[i] - body.velocity_at(x[i]);
    damped += by;
    moment += by * r;
    inertia += by * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
    given += by * relative;
    turned += by * r.cross(relative);
  }
  if (damped == 0)
    return;
  // [all, -[moment]x; [moment]x, inertia] [push; spin] = [given; turned]
  const double all = body.mass + damped;
  const Mat3 reduced = inertia - (moment.squaredNorm() * Mat3::Identity() - moment * moment.transpose()) / all;
  const Vec3 spin = reduced.ldlt().solve(turned - moment.cross(given) / all),
             push = (given - spin.cross(moment)) / all;
  for (std::size_t rider = carrier.first; rider < carrier.last; ++rider) {
    const auto i = riders_[rider].corner;
    v[i] -= damping(rider) * (v[i] - body.velocity_at(x[i]) - push - spin.cross(x[i] - body.centre));
  }
  for (const auto c : corners)
    v[c] += push + spin.cross(x[c] - body.centre);
}

} // namespace kerf::lattice
