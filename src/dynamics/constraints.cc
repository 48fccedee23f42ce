#include "dynamics/preconditioner.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace kerf::dynamics {

namespace {

constexpr double round_off_of_projectors = 1e-9; // of projectors and their sums [1]

bool holds_all(const Mat3& held) { return (held - Mat3::Identity()).cwiseAbs().maxCoeff() < round_off_of_projectors; }

Constraints::Freedom freedom_beside(const Mat3& sum) {
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(sum); // ascending: free directions first
  Constraints::Freedom freedom{sum, Mat3::Zero(), eigen.eigenvectors(), Mat3::Zero(), 0};
  for (int k = 0; k < 3; ++k) {
    const Vec3 direction = freedom.basis.col(k);
    const double value = eigen.eigenvalues()[k];
    if (value < round_off_of_projectors) {
      ++freedom.n_free;
      freedom.project += direction * direction.transpose();
    } else {
      freedom.inverse += direction * direction.transpose() / value;
    }
  }
  return freedom;
}

/// Of several supports that hold a corner in all directions, the last one alone counts.
std::span<const Constraints::Hold> those_that_count(const Loads& loads,
                                                    const std::span<const Constraints::Hold> holds) {
  for (std::size_t i = holds.size(); i-- > 0;)
    if (holds_all(loads.supports[holds[i].support].held))
      return holds.subspan(i, 1);
  return holds;
}

/// Of a positive block alone, entry by entry. False: it is not positive, or so narrow that T would tell little of it.
template <class T>
bool invert_factor(const Mat3& block, Eigen::Matrix<T, 3, 3>& inverse) {
  constexpr T narrow = sizeof(T) == sizeof(float) ? T(1e-3) : T(0); // of what elimination leaves over what was there
  const T a = T(block(0, 0)), b = T(block(1, 0)), c = T(block(2, 0)), d = T(block(1, 1)), e = T(block(2, 1)),
          f = T(block(2, 2));
  const T r0 = 1 / a, l10 = r0 * b, l20 = r0 * c, d1 = d - l10 * b, r1 = 1 / d1, below = e - l20 * b, // L D L^T
    l21 = r1 * below, d2 = f - l20 * c - l21 * below;                                                 // r = 1 / D
  if (!(a > 0 && r0 > 0 && d1 > narrow * d && d2 > narrow * f)) // r0 is 0 where T has no number as large as a
    return false;
  const T s0 = std::sqrt(r0), s1 = std::sqrt(r1), s2 = 1 / std::sqrt(d2);
  inverse << s0, 0, 0, -s1 * l10, s1, 0, s2 * (l21 * l10 - l20), -s2 * l21, s2;
  return true;
}

/// Nearly all are free in all directions, in the basis of the axes.
bool is_all_free(const Constraints::Freedom& freedom) { return freedom.n_free == 3 && freedom.sum.isZero(0); }

} // namespace

Constraints::Constraints(const Loads& loads, const std::size_t n_corners)
  : loads_(loads), freedoms_(1), kind_(n_corners, 0) {
  Loan<std::pair<std::uint32_t, Hold>> all; // of which corner
  std::size_t n = 0;
  for (std::uint32_t s = 0; s < loads.supports.size(); n += loads.supports[s++].corners.size()) {
    first_->push_back(n);
    for (std::uint32_t i = 0; i < loads.supports[s].corners.size(); ++i)
      if (const auto corner = loads.supports[s].corners[i]; !is_carried(loads, corner))
        all->push_back({corner, {s, i}});
  }
  const auto is_before = [](const auto& a, const auto& b) {
    return std::tuple(a.first, a.second.support, a.second.index) <
           std::tuple(b.first, b.second.support, b.second.index);
  };
  if (!std::is_sorted(all->begin(), all->end(), is_before)) // one support's corners are, as a rule
    std::sort(all->begin(), all->end(), is_before);
  Loan<Hold> of_corner;
  for (std::size_t i = 0; i < all.size(); ++i) {
    of_corner->push_back(all[i].second);
    if (i + 1 == all.size() || all[i + 1].first != all[i].first) {
      add(all[i].first, those_that_count(loads, *of_corner));
      of_corner->clear();
    }
  }
  add_carried();
}

void Constraints::add_carried() {
  if (loads_.carried.empty())
    return;
  const std::uint32_t none_free = kind_of(Mat3::Identity());
  for (std::size_t i = 0; i < kind_.size(); ++i)
    if (is_carried(loads_, i)) {
      kind_[i] = none_free;
      ++n_carried_;
    }
}

void Constraints::add(const std::uint32_t corner, const std::span<const Hold> holds) {
  if (const auto before = held_->empty() ? std::span<const Hold>() : this->holds(held_->back());
      holds.size() == 1 && before.size() == 1 && holds[0].support == before[0].support) {
    kind_[corner] = kind_[held_->back().corner];
  } else {
    Mat3 sum = Mat3::Zero();
    for (const Hold& hold : holds)
      sum += loads_.supports[hold.support].held;
    kind_[corner] = kind_of(sum);
  }
  const auto begin = static_cast<std::uint32_t>(holds_.size());
  holds_->insert(holds_->end(), holds.begin(), holds.end());
  held_->push_back({corner, begin, static_cast<std::uint32_t>(holds_.size())});
}

std::uint32_t Constraints::kind_of(const Mat3& sum) {
  for (std::uint32_t k = 0; k < freedoms_.size(); ++k)
    if ((freedoms_[k].sum - sum).cwiseAbs().maxCoeff() < round_off_of_projectors)
      return k;
  freedoms_->push_back(freedom_beside(sum));
  return static_cast<std::uint32_t>(freedoms_.size() - 1);
}

std::size_t Constraints::n_free() const {
  std::size_t n = 3 * (kind_.size() - n_carried_);
  for (const Held& held : *held_)
    n -= static_cast<std::size_t>(3 - freedom(held.corner).n_free);
  return n;
}

std::span<const Constraints::Held> Constraints::held(const std::size_t begin, const std::size_t end) const {
  const auto first = std::ranges::lower_bound(*held_, begin, {}, &Held::corner);
  return {first, std::ranges::lower_bound(first, held_.end(), end, {}, &Held::corner)};
}

void Constraints::impose(const Points& wanted, const std::span<const Held> some, Points& values) const {
  const auto of = [&](const Hold& hold) -> const Vec3& { return wanted[first_[hold.support] + hold.index]; };
  for (const Held& held : some) {
    Vec3& value = values[held.corner];
    const Freedom& freedom = this->freedom(held.corner);
    const auto holds = this->holds(held);
    if (holds.size() == 1 && freedom.n_free == 0) { // to the last bit
      value = of(holds[0]);
      continue;
    }
    Vec3 missing = -freedom.sum * value;
    for (const Hold& hold : holds)
      missing += loads_.supports[hold.support].held * of(hold);
    value += freedom.inverse * missing;
  }
}

Loan<Vec3> Constraints::places(const double time) const {
  std::size_t n = 0;
  for (const Support& support : loads_.supports)
    n += support.rest.size();
  Loan<Vec3> all = Loan<Vec3>::with_room(n);
  for (const Support& support : loads_.supports) {
    const Support::Places place = support.places(time);
    for (const Vec3& rest : support.rest)
      all->push_back(place(rest));
  }
  return all;
}

Loan<Vec3> Constraints::velocities(const double time, const double delta) const {
  Loan<Vec3> all = places(time + delta);
  const Loan<Vec3> before = places(time - delta);
  for (std::size_t i = 0; i < all.size(); ++i)
    all[i] = (all[i] - before[i]) / (2 * delta);
  return all;
}

void Constraints::place(const double time, Points& x) const {
  if (!held_.empty())
    impose(places(time), *held_, x);
}

void Constraints::place_velocity(const double time, const double delta, Points& v) const {
  if (!held_.empty())
    impose(velocities(time, delta), *held_, v);
}

void Constraints::project(Points& values) const {
  for (const Held& held : *held_)
    values[held.corner] = freedom(held.corner).project * values[held.corner];
  if (n_carried_ > 0)
    for (std::size_t i = 0; i < values.size(); ++i)
      if (is_carried(loads_, i))
        values[i].setZero();
}

Mat3 inverse_factor(const Mat3& block, const Constraints::Freedom& freedom) {
  const int n = freedom.n_free;
  Mat3 inverse;
  if (is_all_free(freedom) && invert_factor(block, inverse))
    return inverse;
  inverse.setZero();
  if (n == 0)
    return inverse;
  const Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3> Q = freedom.basis.leftCols(n);
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3> reduced = Q.transpose() * block * Q;
  const Eigen::LLT<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3>> factor(reduced);
  if (factor.info() == Eigen::Success)
    inverse.topRows(n) = factor.matrixL().solve(Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 3, 3>(Q.transpose()));
  else if (reduced.trace() > 0) // a block that is no more than semi-definite: at least its size
    inverse.topRows(n) = std::sqrt(n / reduced.trace()) * Q.transpose();
  return inverse;
}

Eigen::Matrix3f inverse_factor_in_single(const Mat3& block, const Constraints::Freedom& freedom) {
  Eigen::Matrix3f inverse;
  return is_all_free(freedom) && invert_factor(block, inverse) ? inverse
                                                               : inverse_factor(block, freedom).cast<float>().eval();
}

Loan<std::uint8_t> free_pieces(const Pieces& pieces, const Loads& loads, const std::size_t n_corners) {
  Loan<std::uint8_t> is_free(pieces.n(), 1);
  const Constraints constraints(loads, n_corners);
  for (const auto& held : constraints.held())
    if (!is_carried(loads, held.corner))
      is_free[pieces.of(held.corner)] = 0;
  return is_free;
}

} // namespace kerf::dynamics
