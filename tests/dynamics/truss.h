#pragma once

/// Bars between points: geometrically nonlinear, so that statics has something to do, and with an exact tangent that
/// may be indefinite. A bar of rest length L and length l has the energy k (l - L)^2 / 2.

#include "dynamics/model.h"
#include "dynamics/state.h"

#include <array>

namespace kerf::dynamics {

class Truss : public ElasticModel, public StiffnessMatrix {
 public:
  using Bar = std::array<std::uint32_t, 2>;

  Truss(Points rest, std::vector<Bar> bars, const double stiffness)
    : rest_(std::move(rest)), bars_(std::move(bars)), stiffness_(stiffness), mass_(rest_.size(), 1.0), at_(rest_) {}

  const Points& rest() const { return rest_; }
  State state() const { return {rest_, Points(rest_.size(), Vec3::Zero()), 0}; }
  std::span<const double> lumped_mass() const override { return mass_; }

  double energy(const Points& x) const override {
    double sum = 0;
    for (const Bar& bar : bars_)
      sum += 0.5 * stiffness_ * stretch(x, bar) * stretch(x, bar);
    return sum;
  }

  void force(const Points& x, Points& forces) const override {
    forces.assign(x.size(), Vec3::Zero());
    for (const auto& [a, b] : bars_) {
      const Vec3 pull = stiffness_ * stretch(x, {a, b}) * (x[b] - x[a]).normalized();
      forces[a] += pull;
      forces[b] -= pull;
    }
  }

  void linearise(const Points& x) override { at_ = x; }

  void apply_stiffness(std::span<const double> p, std::span<double> y) const override {
    const Eigen::Map<const Eigen::VectorXd> P(p.data(), static_cast<Eigen::Index>(p.size()));
    Eigen::Map<Eigen::VectorXd>(y.data(), P.size()) = stiffness_matrix(at_, Tangent::positive) * P;
  }

  void stiffness_diagonal(const PutBlock put) const override {
    std::vector<Mat3> blocks(rest_.size(), Mat3::Zero());
    for (const Bar& bar : bars_)
      for (const auto end : bar)
        blocks[end] += block(at_, bar, Tangent::positive);
    for (std::size_t i = 0; i < blocks.size(); ++i)
      put(i, blocks[i]);
  }

  Eigen::SparseMatrix<double> stiffness_matrix(const Points& x, const Tangent kind) const override {
    std::vector<Eigen::Triplet<double>> entries;
    for (const Bar& bar : bars_) {
      const Mat3 B = block(x, bar, kind);
      for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j)
          for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b)
              entries.emplace_back(3 * bar[i] + a, 3 * bar[j] + b, (i == j ? 1 : -1) * B(a, b));
    }
    Eigen::SparseMatrix<double> K(3 * rest_.size(), 3 * rest_.size());
    K.setFromTriplets(entries.begin(), entries.end());
    return K;
  }

 private:
  double stretch(const Points& x, const Bar& bar) const {
    return (x[bar[1]] - x[bar[0]]).norm() - (rest_[bar[1]] - rest_[bar[0]]).norm();
  }

  Mat3 block(const Points& x, const Bar& bar, const Tangent kind) const {
    const Vec3 d = x[bar[1]] - x[bar[0]], n = d.normalized();
    const double across = stretch(x, bar) / d.norm(); // negative in a bar that is pressed
    return stiffness_ * (n * n.transpose() + (kind == Tangent::exact ? across : std::max(0.0, across)) *
                                               (Mat3::Identity() - n * n.transpose()));
  }

  Points rest_;
  std::vector<Bar> bars_;
  double stiffness_;
  std::vector<double> mass_;
  Points at_;
};

} // namespace kerf::dynamics
