#pragma once

/// deal.II's V-cycle over our levels: its vectors, its order of smoothing, restriction and prolongation. Operator,
/// smoother and transfer are those of level.h: deal.II's Chebyshev smoother, the same polynomial, makes a step 13 %
/// longer (tests/bench/chebyshev.cc, results/README.md).

#include "fem/kernels.h"

#include <functional>
#include <memory>
#include <vector>

namespace kerf::fem {

struct Level;

class Cycle {
 public:
  /// x = A^-1 b, or near it.
  using Solve = std::function<void(const Row<float>* b, Row<float>* x)>;

  /// `levels`: the finest first; they have to live as long. `solve`: on the coarsest.
  Cycle(std::vector<Level*> levels, Solve solve);
  ~Cycle();

  /// b of the finest level, to be written.
  Row<float>* right_side();
  /// x near A^-1 b.
  const Row<float>* solve();

 private:
  struct InDealII;
  std::unique_ptr<InDealII> in_dealii_;
};

} // namespace kerf::fem
