#pragma once

/// What no step of any case may do.

#include "tests/grinder/look.h"
#include "tests/grinder/scene.h"

#include <optional>

namespace kerf::grinder {

/// Why a case failed, in one word, and the figures.
struct Failure {
  /// "runaway", "outlier", "volume", "drawn out", "energy", "cut energy", "NaN", "pieces", "stopped"
  std::string reason;
  int step = 0;
  std::string words;
  bool is_final = false; ///< nothing can go on from there
};

/// The largest of each figure so far, over what is allowed: 1 fails.
struct Figures {
  double fastest = 0; ///< speed [m/s]
  double stretch = 0; ///< of a copy's edge, as it is [1]
  double runaway = 0, outlier = 0, volume = 0, reach = 0, energy = 0, cut_energy = 0;
};

/// Watches one body from its start to its end.
class Watch {
 public:
  /// The body as it is at the start of the scene.
  Watch(const Scene& scene, const scene::Body& body);

  /// After each step. Returns what has failed first of all there is.
  std::optional<Failure> after_step(const scene::Body& body, int step, double dt);

  const Figures& figures() const { return figures_; }

 private:
  std::optional<Failure> watch_speeds(const scene::Body& body, const Look& look, int step, double time);
  std::optional<Failure> watch_shapes(const scene::Body& body, const Look& look, int step, double time);
  std::optional<Failure> watch_energy(const Look& look, int step, double dt);
  std::optional<Failure> watch_pieces(const scene::Body& body, const Look& look, int step);

  double most_energy_gained_;                             ///< of what has been turned over [1]
  bool keeps_energy_;                                     ///< in the mean: no step is as the one before
  double least_mass_;                                     ///< of particles whose speeds count [cubes]
  double gravity_ = 0;                                    ///< [m/s^2]
  double wave_speed_ = 0, recoil_ = 0;                    ///< [m/s]
  double mass_ = 0;                                       ///< [kg]
  double start_gravity_ = 0;                              ///< [J]
  double gained_ = 0, gained_by_cuts_ = 0, turnover_ = 0; ///< [J]
  double missing_ = 0, work_of_cut_ = 0;                  ///< a step ago [J]
  std::size_t n_pieces_ = 0;
  int n_recuts_ = 0;
  Figures figures_;
};

} // namespace kerf::grinder
