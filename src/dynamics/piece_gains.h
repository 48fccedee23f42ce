#pragma once

/// Steps whose energy is accounted for in each piece that flies by itself (sound_steps.h).
///
/// The problem: what a small piece gains in a step drowns in the energy of all others. One of five cubes swelled by 60
/// % in a step of generalised alpha that lost energy in sum.
///
/// A piece that nothing holds, and on which gravity alone acts, keeps its energy, so each is judged as the whole is. It
/// takes the elastic energy of each piece, twice a step, of models that tell it (PieceEnergies).

#include "base/loan.h"
#include "dynamics/loads.h"
#include "dynamics/model.h"
#include "dynamics/pieces.h"
#include "dynamics/state.h"

namespace kerf::dynamics {

/// A model whose elastic energy can be told apart.
class PieceEnergies {
 public:
  virtual ~PieceEnergies() = default;
  /// Elastic energy of each piece at positions x [m], in J.
  virtual Loan<double> energies(const Points& x, const Pieces& pieces) const = 0;
};

/// Throws StepError where a piece that flies gained more than `most`, of the energy that it dealt with [1].
void require_no_piece_gains(const ForceModel& model, const Pieces& pieces, const Loads& loads, const State& before,
                            const State& after, double most);

} // namespace kerf::dynamics
