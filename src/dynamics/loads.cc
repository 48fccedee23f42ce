#include "dynamics/loads.h"

#include "base/error.h"
#include "dynamics/constraints.h"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>

namespace kerf::dynamics {

namespace {

/// How far H_a (x - place_a) = 0 and H_b (x - place_b) = 0 are from having a common solution [m]: what their least
/// squares leave.
double disagreement(const Support& a, const Vec3& place_a, const Support& b, const Vec3& place_b) {
  Eigen::Matrix<double, 6, 3> H;
  H << a.held, b.held;
  Eigen::Matrix<double, 6, 1> wanted;
  wanted << a.held * place_a, b.held * place_b;
  const Vec3 x = H.completeOrthogonalDecomposition().solve(wanted);
  return std::sqrt(2.0) * (H * x - wanted).norm(); // of two full holds: the distance of their places
}

/// A load that somebody else owns.
class SameLoad : public Load {
 public:
  explicit SameLoad(const Load& load) : load_(load) {}

  Nature nature() const override { return load_.nature(); }
  double energy(const double time, const Points& x) const override { return load_.energy(time, x); }
  void add_force(const Moment& moment, Points& forces) const override { load_.add_force(moment, forces); }
  void add_tangent(const Tangent kind, const Moment& moment, const double velocity_factor,
                   LoadTangent& tangent) const override {
    load_.add_tangent(kind, moment, velocity_factor, tangent);
  }
  bool is_bounded_in_velocity() const override { return load_.is_bounded_in_velocity(); }

 private:
  const Load& load_;
};

} // namespace

Support::Places Support::places(const double time) const {
  return {rotation ? rotation(time) : Mat3(Mat3::Identity()), displacement(time)};
}

Mat3 held_along(const Vec3& direction) {
  if (!(direction.norm() > 0) || !direction.allFinite())
    throw ParameterError(Complaint{.rule = "the direction that a support holds must have a length",
                                   .remedy = "Write a vector that is not zero"});
  const Vec3 n = direction.stableNormalized();
  return n * n.transpose();
}

const std::vector<std::string>& hold_words() {
  static const std::vector<std::string> words = {"all", "x", "y", "z", "xy", "yz", "xz"};
  return words;
}

Mat3 held_axes(const std::string& word) {
  if (word == "all")
    return Mat3::Identity();
  Vec3 axes = Vec3::Zero();
  for (const char axis : word)
    if (axis >= 'x' && axis <= 'z')
      axes[axis - 'x'] = 1;
  return axes.asDiagonal();
}

Loads potentials_of(const Loads& loads) {
  Loads potentials;
  potentials.carried = loads.carried;
  for (const auto& load : loads.acting)
    if (load->nature() == Nature::conservative)
      potentials.acting.push_back(std::make_unique<SameLoad>(*load));
  return potentials;
}

Loan<std::uint8_t> held_corners(const Loads& loads, const std::size_t n_corners) {
  Loan<std::uint8_t> held(n_corners, 0);
  const Constraints constraints(loads, n_corners);
  for (const auto& one : constraints.held())
    held[one.corner] = constraints.freedom(one.corner).n_free == 0;
  for (std::size_t i = 0; i < std::min(n_corners, loads.carried.size()); ++i)
    held[i] |= is_carried(loads, i) ? 1 : 0;
  return held;
}

void move_held(const Loads& loads, const double time, const double dt, Points& x, Points& v) {
  const Constraints constraints(loads, x.size());
  Loan<Vec3> moved(x);
  constraints.place(time, moved);
  for (const auto& held : constraints.held()) {
    const auto c = held.corner;
    v[c] = constraints.freedom(c).project * v[c] + (moved[c] - x[c]) / dt;
    x[c] = moved[c];
  }
}

std::optional<Contradiction> find_contradiction(const Loads& loads, const double time, const double tolerance) {
  std::vector<std::vector<std::pair<std::uint32_t, Vec3>>> of_corner; // supports and their places
  for (std::uint32_t s = 0; s < loads.supports.size(); ++s) {
    const Support& support = loads.supports[s];
    const auto place = support.places(time);
    for (std::size_t i = 0; i < support.corners.size(); ++i) {
      const auto corner = support.corners[i];
      const Vec3 x = place(support.rest[i]);
      if (corner >= of_corner.size())
        of_corner.resize(corner + 1);
      for (const auto& [other, x_other] : of_corner[corner])
        if (const double d = disagreement(loads.supports[other], x_other, support, x); d > tolerance)
          return Contradiction{other, s, corner, d};
      of_corner[corner].emplace_back(s, x);
    }
  }
  return std::nullopt;
}

} // namespace kerf::dynamics
