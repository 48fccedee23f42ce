#pragma once

/// After a cut: those of the corners around it that have hardly any mass go to their goals (riders.h). Where there is
/// still more energy than before the cut, so do all corners of regions that it has touched, again and again: with the
/// regions' motions held, x = g is where the energy is least, and with positions held these motions are (matching.h), so
/// it falls with each. A way that lifts pieces that are held by more than it lets out is not taken. The last of these
/// ways ends where the energy is what it was.

#include "dynamics/relief.h"
#include "lattice/matching.h"

namespace kerf::lattice {

/// A step lets out what it can; time stands still, dt is not asked for.
class Relief : public dynamics::Stepper {
 public:
  /// The model must outlive it.
  Relief(const Matching& model, dynamics::Excess excess) : model_(model), excess_(std::move(excess)) {}

  dynamics::StepReport step(dynamics::State& state, const dynamics::Loads& loads, double dt) override;

 private:
  void settle(std::span<const std::uint8_t> is_held, dynamics::State& state) const;

  const Matching& model_;
  dynamics::Excess excess_;
};

} // namespace kerf::lattice
