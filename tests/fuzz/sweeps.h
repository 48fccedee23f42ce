#pragma once

/// What a body may be cut with: random and degenerate sweeps, with and without motion of the body, and surfaces that
/// are known at once. "At" a node, edge or face means the very bits of its current position.

#include "cut/recut.h"
#include "tests/fuzz/subject.h"

#include <optional>
#include <variant>

namespace kerf::fuzz {

using Soup = std::vector<std::array<Vec3, 3>>;
using Sweep = std::variant<Soup, cut::BladePath, cut::CutSurface>;

/// A closed surface has no border, so round a face of the lattice it is crossed an even number of times.
enum class Extent { open, closed };

struct NamedSweep {
  std::string name;
  Sweep sweep;
  Extent extent = Extent::open;
};

/// Draws a sweep for the body as it stands; `last` is what was swept before it.
NamedSweep random_sweep(const Subject& subject, const std::optional<NamedSweep>& last, Random& random);

/// One that is known at once.
NamedSweep random_surface(const Subject& subject, Random& random);

/// The edges that it cuts, as the cutter asks for them: found among the boxes of the body's edges. Throws Violation
/// when a look at every edge finds others, or finds them elsewhere.
cut::SweepCuts meet(Subject& subject, const Sweep& sweep, grid::CutLabel label);

} // namespace kerf::fuzz
