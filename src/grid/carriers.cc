#include "grid/carriers.h"

#include <algorithm>

namespace kerf::grid {

namespace {

/// The same for each copy: itself where it can carry.
std::vector<std::uint32_t> carriers_of_copies(const CellComplex& complex,
                                              const std::span<const std::uint8_t> is_heavy, const int enough) {
  std::vector<std::uint32_t> carrier(complex.n_copies(), no_carrier), front;
  for (const auto c : ids<CopyId>(complex.n_copies()))
    if (std::ranges::count_if(complex.copies[c].corners, [&](const auto a) { return is_heavy[a.value] != 0; }) >=
        enough) {
      carrier[c.value] = c.value;
      front.push_back(c.value);
    }
  std::vector<std::vector<std::uint32_t>> around(is_heavy.size()); // copies without a carrier yet, by corner
  for (const auto c : ids<CopyId>(complex.n_copies()))
    if (carrier[c.value] == no_carrier)
      for (const auto corner : complex.copies[c].corners)
        around[corner.value].push_back(c.value);
  for (std::vector<std::uint32_t> next; !front.empty(); front.swap(next), next.clear())
    for (const auto c : front)
      for (const auto corner : complex.copies[CopyId(c)].corners)
        for (const auto other : around[corner.value])
          if (carrier[other] == no_carrier) {
            carrier[other] = carrier[c];
            next.push_back(other);
          }
  return carrier;
}

} // namespace

std::vector<std::uint32_t> nearest_carriers(const CellComplex& complex, const std::span<const std::uint8_t> is_heavy,
                                            const int enough) {
  const auto carrier_of_copy = carriers_of_copies(complex, is_heavy, enough);
  std::vector<std::uint32_t> carrier(is_heavy.size(), no_carrier);
  for (const auto c : ids<CopyId>(complex.n_copies()))
    for (const auto corner : complex.copies[c].corners)
      if (const auto k = carrier_of_copy[c.value]; k != no_carrier)
        if (auto& known = carrier[corner.value]; known == no_carrier || (k == c.value && known != k))
          known = k;
  return carrier;
}

} // namespace kerf::grid
