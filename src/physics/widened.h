#pragma once

/// A model that sees some corners by number (grid/corner_numbers.h), as one of all corners: those that it does not see
/// have no mass, and neither force nor stiffness.

#include "base/loan.h"
#include "dynamics/model.h"
#include "dynamics/state.h"
#include "grid/corner_numbers.h"

#include <memory>

namespace kerf::physics {

class WidenedCoupling : public dynamics::MassCoupling {
 public:
  /// Both must outlive it.
  WidenedCoupling(const dynamics::MassCoupling& by_number, const grid::CornerNumbers& numbers)
    : by_number_(by_number), numbers_(numbers) {}

  void add_product(std::span<const double> p, std::span<double> y) const override;
  void add_entries(double factor, std::vector<Eigen::Triplet<double>>& entries) const override;

 private:
  const dynamics::MassCoupling& by_number_;
  const grid::CornerNumbers& numbers_;
};

/// What all models do. Base: dynamics::ForceModel, or one that is more.
template <class Base>
class WidenedForces : public Base {
 public:
  /// Both must outlive it, and stay as they are. `n_corners` are all of them.
  WidenedForces(Base& by_number, const grid::CornerNumbers& numbers, const std::size_t n_corners)
    : by_number_(by_number), numbers_(numbers), mass_(n_corners, 0.0) {
    const auto mass = by_number.lumped_mass();
    for (std::size_t i = 0; i < numbers.size(); ++i)
      mass_[numbers.corner(i)] = mass[i];
    for (dynamics::Follower follower : by_number.followers()) {
      follower.corner = numbers.corner(follower.corner);
      for (std::uint32_t k = 0; k < follower.n_leaders; ++k)
        follower.leaders[k] = numbers.corner(follower.leaders[k]);
      followers_.push_back(follower);
    }
    if (by_number.mass_coupling())
      coupling_ = std::make_unique<WidenedCoupling>(*by_number.mass_coupling(), numbers);
  }

  std::span<const double> lumped_mass() const override { return mass_; }
  const dynamics::MassCoupling* mass_coupling() const override { return coupling_.get(); }
  std::span<const dynamics::Follower> followers() const override { return followers_; }
  double energy(const Points& x) const override { return by_number_.energy(*gathered(x)); }
  double energy_ahead(const Points& x) const override { return by_number_.energy_ahead(*gathered(x)); }
  void force(const Points& x, Points& forces) const override {
    Loan<Vec3> of_numbers;
    by_number_.force(*gathered(x), of_numbers);
    forces.assign(mass_.size(), Vec3::Zero());
    numbers_.spread(*of_numbers, forces);
  }

 protected:
  Loan<Vec3> gathered(const Points& of_corners) const {
    Loan<Vec3> of_numbers;
    numbers_.gather(of_corners, *of_numbers);
    return of_numbers;
  }

  Base& by_number_;
  const grid::CornerNumbers& numbers_;

 private:
  std::vector<double> mass_;
  std::vector<dynamics::Follower> followers_;
  std::unique_ptr<WidenedCoupling> coupling_; // null where the mass is lumped
};

using WidenedForceModel = WidenedForces<dynamics::ForceModel>;

class WidenedElasticModel : public WidenedForces<dynamics::ElasticModel> {
 public:
  using WidenedForces::WidenedForces;

  void linearise(const Points& x) override { by_number_.linearise(*gathered(x)); }
  void apply_stiffness(std::span<const double> p, std::span<double> y) const override;
  void stiffness_diagonal(PutBlock put) const override;
};

} // namespace kerf::physics
