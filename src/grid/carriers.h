#pragma once

/// Which copies carry the corners that hardly any material holds.

#include "grid/complex.h"

#include <cstdint>
#include <span>
#include <vector>

namespace kerf::grid {

constexpr std::uint32_t no_carrier = CopyId::no_value;

/// For each corner the copy that carries it: one that knows it, or else the nearest one of its piece (fewest steps
/// between copies with a corner in common), of which at least `enough` corners are heavy; `no_carrier` where the piece
/// has no such copy. `is_heavy`: of each corner. Four corners of a cube are not in a row.
std::vector<std::uint32_t> nearest_carriers(const CellComplex& complex, std::span<const std::uint8_t> is_heavy,
                                            int enough = 4);

} // namespace kerf::grid
