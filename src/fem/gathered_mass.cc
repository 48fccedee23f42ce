#include "fem/gathered_mass.h"

#include "grid/carriers.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <map>

namespace kerf::fem {

namespace {

using dynamics::Follower;
using grid::CopyId;

/// S^+; directions in which the corners lie in a plane are left out.
Mat3 inverse_where_it_spans(const Mat3& S) {
  constexpr double flat = 1e-6; // of the largest second moment
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(S);
  Mat3 sum = Mat3::Zero();
  for (int k = 0; k < 3; ++k)
    if (const double value = eigen.eigenvalues()[k]; value > flat * eigen.eigenvalues()[2])
      sum += eigen.eigenvectors().col(k) * eigen.eigenvectors().col(k).transpose() / value;
  return sum;
}

/// Corners that take up the mass of light ones, as they are at rest.
class Carrier {
 public:
  Carrier(const std::vector<std::uint32_t>& corners, const Points& rest, const std::span<const double> mass)
    : corners_(corners) {
    for (const auto j : corners) {
      mass_ += mass[j];
      centre_ += mass[j] * rest[j];
    }
    centre_ /= mass_;
    Mat3 S = Mat3::Zero();
    for (const auto j : corners)
      S += mass[j] * (rest[j] - centre_) * (rest[j] - centre_).transpose();
    inverse_ = inverse_where_it_spans(S);
  }

  Follower follower(const std::uint32_t corner, const Points& rest, const std::span<const double> mass) const {
    Follower follower{corner, static_cast<std::uint32_t>(corners_.size()), {}, {}};
    const Vec3 slope = inverse_ * (rest[corner] - centre_);
    for (std::uint32_t k = 0; k < follower.n_leaders; ++k) {
      const auto j = follower.leaders[k] = corners_[k];
      follower.weights[k] = mass[j] * (1 / mass_ + slope.dot(rest[j] - centre_));
    }
    return follower;
  }

  /// Gives the corners what light ones have, of that mass and moment [kg], [kg m]. Returns what it leaves of the
  /// moment.
  Vec3 take(const double light, const Vec3& moment, const Points& rest, const std::span<const double> mass,
            std::vector<double>& gathered) const {
    constexpr double most = 0.5; // of a mass
    const Vec3 slope = inverse_ * (moment - light * centre_);
    double steepest = 0;
    for (const auto j : corners_)
      steepest = std::max(steepest, std::abs(slope.dot(rest[j] - centre_)));
    const double part = steepest > most ? most / steepest : 1;
    Vec3 left = moment;
    for (const auto j : corners_) {
      const double more = mass[j] * (light / mass_ + part * slope.dot(rest[j] - centre_));
      gathered[j] += more;
      left -= more * rest[j];
    }
    return left;
  }

 private:
  const std::vector<std::uint32_t>& corners_;
  double mass_ = 0;
  Vec3 centre_ = Vec3::Zero();
  Mat3 inverse_ = Mat3::Zero();
};

/// Moments that carriers left, by piece [kg m].
using Left = std::map<std::uint32_t, Vec3>;

/// Gives them to all heavy corners of their piece.
void give_to_pieces(const Left& left, const std::vector<std::uint32_t>& piece, const Points& rest,
                    std::vector<double>& mass) {
  std::map<std::uint32_t, std::vector<std::uint32_t>> corners;
  for (std::uint32_t i = 0; i < mass.size(); ++i)
    if (mass[i] > 0 && left.contains(piece[i]))
      corners[piece[i]].push_back(i);
  for (const auto& [which, of_piece] : corners)
    Carrier(of_piece, rest, mass).take(0, left.at(which), rest, mass, mass);
}

} // namespace

GatheredMass gathered_mass(const grid::Solid& solid, const std::span<const double> mass, const double mass_of_cube) {
  constexpr double light = 1.0 / 128; // of a cube (header)
  std::vector<std::uint8_t> is_heavy(mass.size());
  std::ranges::transform(mass, is_heavy.begin(), [&](const double m) { return m >= light * mass_of_cube ? 1 : 0; });
  const auto carrier = grid::nearest_carriers(solid.complex, is_heavy);
  const Points rest = grid::rest_positions(solid);
  std::map<std::uint32_t, std::vector<std::uint32_t>> light_ones; // by carrier
  for (std::uint32_t i = 0; i < mass.size(); ++i)
    if (!is_heavy[i] && mass[i] > 0 && carrier[i] != grid::no_carrier)
      light_ones[carrier[i]].push_back(i);
  const auto piece = grid::corner_pieces(solid.complex);
  Left left;
  GatheredMass result{{mass.begin(), mass.end()}, {}};
  for (const auto& [copy, corners] : light_ones) {
    std::vector<std::uint32_t> heavy;
    for (const auto corner : solid.complex.copies[CopyId(copy)].corners)
      if (is_heavy[corner.value])
        heavy.push_back(corner.value);
    const Carrier by(heavy, rest, mass);
    double all = 0;
    Vec3 moment = Vec3::Zero();
    for (const auto i : corners) {
      result.followers.push_back(by.follower(i, rest, mass));
      all += mass[i];
      moment += mass[i] * rest[i];
      result.mass[i] = 0;
    }
    left.try_emplace(piece[heavy.front()], Vec3::Zero()).first->second += by.take(all, moment, rest, mass, result.mass);
  }
  give_to_pieces(left, piece, rest, result.mass);
  return result;
}

} // namespace kerf::fem
