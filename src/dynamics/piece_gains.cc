#include "dynamics/piece_gains.h"

#include "dynamics/constraints.h"
#include "dynamics/forces.h"
#include "dynamics/sound_steps.h"

#include <algorithm>
#include <cmath>

namespace kerf::dynamics {

namespace {

/// Of one piece in one state.
struct PieceState {
  double mass = 0, kinetic = 0, gravity = 0; ///< [kg], [J]
  Vec3 momentum = Vec3::Zero(), moment = Vec3::Zero();
  double square = 0; ///< mass times the place's square

  double inner() const { return std::max(0.0, mass > 0 ? kinetic - 0.5 * momentum.squaredNorm() / mass : 0); }
  double spread() const { return std::max(0.0, mass > 0 ? square - moment.squaredNorm() / mass : 0); }
};

Loan<PieceState> states(const ForceModel& model, const Pieces& pieces, const Loads& loads, const State& state) {
  const auto mass = model.lumped_mass();
  const Loan<Vec3> p = momenta(model, state.v);
  Loan<PieceState> all(pieces.n(), PieceState());
  for (std::size_t i = 0; i < p.size(); ++i) {
    PieceState& piece = all[pieces.of(i)];
    piece.mass += mass[i];
    piece.kinetic += 0.5 * state.v[i].dot(p[i]);
    piece.gravity -= mass[i] * loads.gravity.dot(state.x[i]);
    piece.momentum += p[i];
    piece.moment += mass[i] * state.x[i];
    piece.square += mass[i] * state.x[i].squaredNorm();
  }
  return all;
}

/// The particle of a piece that leaves free motion most.
std::size_t most_thrown(const Pieces& pieces, const std::size_t piece, const State& before, const State& after) {
  std::size_t most = 0;
  double largest = -1;
  for (std::size_t i = 0; i < after.v.size(); ++i)
    if (const double change = (after.v[i] - before.v[i]).squaredNorm(); pieces.of(i) == piece && change > largest) {
      largest = change;
      most = i;
    }
  return most;
}

} // namespace

void require_no_piece_gains(const ForceModel& model, const Pieces& pieces, const Loads& loads, const State& before,
                            const State& after, const double most) {
  const auto* const energies = dynamic_cast<const PieceEnergies*>(&model);
  if (!energies || pieces.n() == 1 || !loads.acting.empty())
    return;
  constexpr double drowned = 1e-9, solved = 1e-5, unseen = 1e-12; // as of the whole body (sound_steps.cc)
  const auto flies = free_pieces(pieces, loads, after.x.size());
  const auto elastic_0 = energies->energies(before.x, pieces), elastic_1 = energies->energies(after.x, pieces);
  const auto first = states(model, pieces, loads, before), last = states(model, pieces, loads, after);
  const double dt = after.time - before.time;
  for (std::size_t p = 0; p < pieces.n(); ++p) {
    const PieceState &a = first[p], &b = last[p];
    const double gained = elastic_1[p] - elastic_0[p] + (b.kinetic - a.kinetic) + (b.gravity - a.gravity),
                 dealt = a.inner() + b.inner() + std::abs(elastic_0[p]) + std::abs(elastic_1[p]),
                 sizes = a.kinetic + b.kinetic + std::abs(elastic_0[p]) + std::abs(elastic_1[p]) +
                         std::abs(a.gravity) + std::abs(b.gravity),
                 exchanged = std::abs(b.kinetic - a.kinetic) + std::abs(b.gravity - a.gravity),
                 shift = drowned * sizes + solved * exchanged + unseen * b.spread() / (dt * dt);
    if (flies[p] != 0 && !(gained <= most * dealt + shift))
      throw StepError("a piece gained " + in_short(gained) + " J that no load gave, " + per_cent(gained / dealt) +
                        " of the energy that it dealt with",
                      most_thrown(pieces, p, before, after));
  }
}

} // namespace kerf::dynamics
