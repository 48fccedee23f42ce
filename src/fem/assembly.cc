#include "fem/assembly.h"

#include "base/parallel.h"

#include <algorithm>
#include <array>

namespace kerf::fem {

namespace {

using Matrix = Eigen::SparseMatrix<double>;

/// The corners that share a copy with each corner, itself among them, ascending.
std::vector<std::vector<std::uint32_t>> neighbours(const Incidence& incidence, const grid::CornerNumbers& numbers) {
  std::vector<std::vector<std::uint32_t>> all(numbers.size());
  parallel_for(all.size(), [&](const std::size_t i) {
    auto& mine = all[i];
    for (const auto user : incidence.users(numbers.corner(i)))
      for (int a = 0; a < 8; ++a)
        mine.push_back(numbers[incidence.corners(user / 8)[a]]);
    std::sort(mine.begin(), mine.end());
    mine.erase(std::unique(mine.begin(), mine.end()), mine.end());
  });
  return all;
}

Matrix empty_matrix(const std::vector<std::vector<std::uint32_t>>& neighbours) {
  const auto n = static_cast<Eigen::Index>(3 * neighbours.size());
  std::vector<int> sizes;
  sizes.reserve(n);
  for (const auto& mine : neighbours)
    sizes.insert(sizes.end(), 3, static_cast<int>(3 * mine.size()));
  Matrix K(n, n);
  K.reserve(sizes);
  for (std::size_t c = 0; c < neighbours.size(); ++c)
    for (int j = 0; j < 3; ++j)
      for (const auto r : neighbours[c])
        for (int i = 0; i < 3; ++i)
          K.insert(3 * r + i, 3 * c + j) = 0;
  K.makeCompressed();
  return K;
}

void add(const Matrix24& element, const std::uint32_t* const corners,
         const std::vector<std::vector<std::uint32_t>>& neighbours, Matrix& K) {
  for (int b = 0; b < 8; ++b) {
    const auto& rows = neighbours[corners[b]];
    for (int a = 0; a < 8; ++a) {
      const auto place = std::lower_bound(rows.begin(), rows.end(), corners[a]) - rows.begin();
      for (int j = 0; j < 3; ++j) {
        double* const column = K.valuePtr() + K.outerIndexPtr()[3 * corners[b] + j] + 3 * place;
        for (int i = 0; i < 3; ++i)
          column[i] += element(3 * a + i, 3 * b + j);
      }
    }
  }
}

} // namespace

Eigen::SparseMatrix<double> assemble(const Incidence& incidence, const grid::CornerNumbers& numbers,
                                     const std::function<Matrix24(std::size_t copy)>& element_matrix) {
  constexpr std::size_t chunk = 1024; // of 4.6 kB each: stays in cache, and no more memory than that
  const auto pattern = neighbours(incidence, numbers);
  Matrix K = empty_matrix(pattern);
  std::vector<Matrix24> matrices(std::min(chunk, incidence.n_copies()));
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
        std::array<std::uint32_t, 8> corners;
        for (int a = 0; a < 8; ++a)
          corners[a] = numbers[incidence.corners(first + i)[a]];
        add(matrices[i], corners.data(), pattern, K);
      }
  }
  return K;
}

} // namespace kerf::fem
