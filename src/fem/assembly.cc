#include "fem/assembly.h"

#include "base/parallel.h"

#include <algorithm>

namespace kerf::fem {

void add_entries(const Incidence& incidence, const grid::CornerNumbers& numbers,
                 const std::function<Matrix24(std::size_t copy)>& element_matrix,
                 std::vector<Eigen::Triplet<double>>& entries) {
  constexpr std::size_t chunk = 1024; // of 4.6 kB each: stays in cache
  std::vector<Matrix24> matrices(std::min(chunk, incidence.n_copies()));
  entries.reserve(entries.size() + 24 * 24 * incidence.n_copies());
  for (std::size_t first = 0; first < incidence.n_copies(); first += chunk) {
    const std::size_t n = std::min(chunk, incidence.n_copies() - first);
    parallel_for(
      n,
      [&](const std::size_t i) {
        if (incidence.is_used(first + i))
          matrices[i] = element_matrix(first + i);
      },
      64);
    for (std::size_t i = 0; i < n; ++i)
      if (incidence.is_used(first + i)) {
        const auto unknown = [&, corners = incidence.corners(first + i)](const int k) {
          return 3 * numbers[corners[k / 3]] + static_cast<std::uint32_t>(k % 3);
        };
        for (int k = 0; k < 24; ++k)
          for (int l = 0; l < 24; ++l)
            entries.emplace_back(unknown(k), unknown(l), matrices[i](k, l));
      }
  }
}

} // namespace kerf::fem
