#pragma once

/// Forces at the positions for which they were asked last, and the energy there: integrators ask again where a step
/// ends and the next one starts. May be asked by several threads at once.

#include "base/fingerprint.h"

#include <mutex>
#include <optional>

namespace kerf::fem {

class KnownForces {
 public:
  bool are_known(const Points& x) const {
    const std::uint64_t at = fingerprint(x);
    const std::lock_guard lock(mutex_);
    return is_at(at);
  }
  /// False: not known there.
  bool forces(const Points& x, Points& forces) const {
    const std::uint64_t at = fingerprint(x);
    const std::lock_guard lock(mutex_);
    if (!is_at(at))
      return false;
    forces = forces_;
    return true;
  }
  std::optional<double> energy(const Points& x) const {
    const std::uint64_t at = fingerprint(x);
    const std::lock_guard lock(mutex_);
    return is_at(at) ? energy_ : std::nullopt;
  }
  void put(const Points& x, const Points& forces, const std::optional<double>& energy) {
    const std::uint64_t at = fingerprint(x);
    const std::lock_guard lock(mutex_);
    where_ = at;
    forces_ = forces;
    energy_ = energy;
  }
  void put_energy(const Points& x, const double energy) {
    const std::uint64_t at = fingerprint(x);
    const std::lock_guard lock(mutex_);
    if (is_at(at))
      energy_ = energy;
  }
  void forget() {
    const std::lock_guard lock(mutex_);
    where_ = std::nullopt;
  }

 private:
  bool is_at(const std::uint64_t fingerprint) const { return where_ == fingerprint; }

  mutable std::mutex mutex_;
  std::optional<std::uint64_t> where_;
  Points forces_;
  std::optional<double> energy_;
};

} // namespace kerf::fem
