#pragma once

/// A model with closed-form answers: masses in a row, each drawn to its rest position, and to its neighbours' offsets.

#include "dynamics/model.h"
#include "dynamics/state.h"

#include <limits>

namespace kerf::dynamics {

class Chain : public ElasticModel {
 public:
  struct Springs {
    double anchor = 0;           ///< force -anchor d on a mass at distance d from rest [N/m]
    double cubic = 0;            ///< force -cubic |d|^2 d beside it [N/m^3]
    double neighbour = 0;        ///< between masses next to each other [N/m]
    Vec3 weights = Vec3::Ones(); ///< of the anchor's three directions [1]
  };

  Chain(std::vector<double> mass, const Springs& springs) : mass_(std::move(mass)), springs_(springs) {
    for (std::size_t i = 0; i < mass_.size(); ++i)
      rest_.emplace_back(0.1 * static_cast<double>(i), 0, 0);
  }

  const Points& rest() const { return rest_; }
  State state() const { return {rest_, Points(rest_.size(), Vec3::Zero()), 0}; }

  std::span<const double> lumped_mass() const override { return mass_; }

  double energy(const Points& x) const override {
    double sum = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Vec3 d = x[i] - rest_[i];
      sum += 0.5 * springs_.anchor * d.dot(springs_.weights.cwiseProduct(d)) +
             0.25 * springs_.cubic * d.squaredNorm() * d.squaredNorm();
      if (i > 0)
        sum += 0.5 * springs_.neighbour * (d - (x[i - 1] - rest_[i - 1])).squaredNorm();
    }
    return sum;
  }

  void force(const Points& x, Points& forces) const override {
    forces.assign(x.size(), Vec3::Zero());
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Vec3 d = x[i] - rest_[i];
      forces[i] -= springs_.anchor * springs_.weights.cwiseProduct(d) + springs_.cubic * d.squaredNorm() * d;
      if (i > 0) {
        const Vec3 pull = springs_.neighbour * (d - (x[i - 1] - rest_[i - 1]));
        forces[i] -= pull;
        forces[i - 1] += pull;
      }
    }
  }

  void linearise(const Points& x) override {
    blocks_.clear();
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Vec3 d = x[i] - rest_[i];
      blocks_.push_back(springs_.anchor * Mat3(springs_.weights.asDiagonal()) +
                        springs_.cubic * (d.squaredNorm() * Mat3::Identity() + 2 * d * d.transpose()));
    }
  }

  void apply_stiffness(std::span<const double> p, std::span<double> y) const override {
    const auto at = [&](const std::size_t i) { return Vec3(p[3 * i], p[3 * i + 1], p[3 * i + 2]); };
    for (std::size_t i = 0; i < mass_.size(); ++i) {
      Vec3 sum = blocks_[i] * at(i);
      if (i > 0)
        sum += springs_.neighbour * (at(i) - at(i - 1));
      if (i + 1 < mass_.size())
        sum += springs_.neighbour * (at(i) - at(i + 1));
      for (int k = 0; k < 3; ++k)
        y[3 * i + k] = sum[k];
    }
  }

  void stiffness_diagonal(const PutBlock put) const override {
    for (std::size_t i = 0; i < mass_.size(); ++i)
      put(i, blocks_[i] + springs_.neighbour * ((i > 0) + (i + 1 < mass_.size())) * Mat3::Identity());
  }

 private:
  std::vector<double> mass_;
  Springs springs_;
  Points rest_;
  std::vector<Mat3> blocks_;
};

} // namespace kerf::dynamics
