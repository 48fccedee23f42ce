#pragma once

/// Runs cases, and keeps what failed.

#include "tests/grinder/cases.h"
#include "tests/grinder/watch.h"

#include <map>

namespace kerf::grinder {

/// What says which case it is.
struct Case {
  const Solid* solid = nullptr;
  const Kind* kind = nullptr;
  unsigned seed = 0;
};

/// "heart:fem-trilinear-corotational:7"
std::string name_of(const Case& one);

struct Outcome {
  std::optional<Failure> failure;
  std::optional<std::string> refused; ///< the message with which the scene was not accepted
  Figures figures;
  int n_steps = 0;
  std::size_t n_cells = 0, n_pieces = 0;
};

enum class Until { first_failure, end };

/// Runs a scene with some keys changed ("Section/Key=value"); past its first failure only to see how far it goes.
Outcome run(const Scene& scene, const std::vector<std::string>& changes, Until until);

/// Did it stop as it was drawn out, and does it with half the step and with the other element too, within a tenth of the
/// time? Then part of the body hangs by a thread, which no step could help: material does not tear here.
bool hangs_by_a_thread(const Scene& scene, const std::vector<std::string>& changes, const Outcome& outcome);

/// The smallest scene found that fails with the same reason: fewer tools, fewer steps, larger cubes.
Scene shrunk(const Scene& scene, const std::vector<std::string>& changes, const std::string& reason);

/// What many cases came to.
class Harvest {
 public:
  /// Scenes of cases that fail go into `folder`, which is made; empty: nowhere.
  explicit Harvest(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// `kind` of physics, under which failures are counted; `name` of the case.
  /// One that hangs by a thread is no failure.
  void add(const std::string& name, const std::string& kind, const Scene& scene,
           const std::vector<std::string>& changes, const Outcome& outcome);

  std::size_t n_cases() const { return n_cases_; }
  std::size_t n_refused() const { return n_refused_; }
  /// One line a failure.
  const std::vector<std::string>& failures() const { return failures_; }
  /// Failures by kind and reason, and the largest figures of each kind.
  std::string summary() const;

 private:
  std::filesystem::path folder_;
  std::size_t n_cases_ = 0, n_refused_ = 0;
  std::vector<std::string> failures_, refusals_, hanging_;
  std::map<std::string, std::map<std::string, int>> counts_; ///< of reasons, by kind
  std::map<std::string, Figures> healthy_;                   ///< largest figures of cases that passed, by kind
};

} // namespace kerf::grinder
