/// What deal.II's Chebyshev smoother costs beside the one of fem/level.h, on the same level, with the same product and
/// the same diagonal blocks: three steps from zero. CPU time, medians of alternating runs: bench_chebyshev CELLS, over
/// an edge of a cube.

#include "base/parallel.h"
#include "fem/level.h"

#include <deal.II/lac/la_parallel_vector.h>
#include <deal.II/lac/precondition.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <numeric>

namespace kerf::fem {
namespace {

using Vector = dealii::LinearAlgebra::distributed::Vector<float>;

Row<float>* rows(Vector& v) { return reinterpret_cast<Row<float>*>(v.begin()); }
const Row<float>* rows(const Vector& v) { return reinterpret_cast<const Row<float>*>(v.begin()); }

/// A p, as deal.II asks for it.
struct Product : dealii::Subscriptor {
  const Level& level;
  mutable int n_products = 0;
  explicit Product(const Level& of) : level(of) {}

  void vmult(Vector& y, const Vector& p) const {
    ++n_products;
    for (std::size_t i = 0; i < level.n_corners; ++i) {
      const Row<float>& row = rows(p)[i];
      const float m = level.mass[i];
      rows(y)[i] = {m * row.x, m * row.y, m * row.z};
    }
    add_product(*level.batching, level.elements, rows(p), rows(y));
  }
};

struct BlockJacobi : dealii::Subscriptor {
  const Level& level;
  explicit BlockJacobi(const Level& of) : level(of) {}

  void vmult(Vector& z, const Vector& r) const {
    for (std::size_t i = 0; i < level.n_corners; ++i) {
      const Row<float>&d = level.inverse[2 * i], &s = level.inverse[2 * i + 1], &v = rows(r)[i];
      rows(z)[i] = {d.x * v.x + s.x * v.y + s.z * v.z, s.x * v.x + d.y * v.y + s.y * v.z,
                    s.z * v.x + s.y * v.y + d.z * v.z};
    }
  }
};

/// A cube of n x n x n full cells.
Level cube(const int n) {
  Level level;
  CellsOfLevel cells;
  const auto corner = [n](const int i, const int j, const int k) {
    return static_cast<std::uint32_t>(i + (n + 1) * (j + (n + 1) * k));
  };
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        cells.place.push_back({i, j, k});
        for (int a = 0; a < 8; ++a)
          cells.corners.push_back(corner(i + (a & 1), j + (a >> 1 & 1), k + (a >> 2)));
      }
  level.n_corners = corner(n, n, n) + 1;
  const material::Elastic rubber{.density = 1000, .youngs_modulus = 1e5, .poissons_ratio = 0.3};
  const Element full = make_element(full_cube_moments(), 1.0 / n, rubber, {});
  std::vector<std::uint32_t> order(cells.n_copies()), ends;
  std::iota(order.begin(), order.end(), 0);
  for (std::size_t end = 0; end < order.size(); ends.push_back(static_cast<std::uint32_t>(end)))
    end = std::min(end + Batching::chunk_size, order.size());
  const std::vector<Kind> kinds(order.size(), Kind::full);
  level.batching = std::make_shared<Batching>(CopiesInOrder{order, ends, kinds, cells.corners.data(), level.n_corners});
  level.elements =
    batched<float>(*level.batching, 1.0 / n, rubber, full, {[&](std::uint32_t) -> const Element& { return full; }});
  level.bound = full.bound;
  level.resize();
  std::fill(level.mass.begin(), level.mass.end(), 0.01f);
  level.make_diagonal();
  level.invert_diagonal([](std::uint32_t, const Mat3& block) { return block; }); // nothing is held
  return level;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

void run(const int n) {
  Level level = cube(n);
  const Product product(level);
  dealii::PreconditionChebyshev<Product, Vector, BlockJacobi> chebyshev;
  dealii::PreconditionChebyshev<Product, Vector, BlockJacobi>::AdditionalData data;
  data.degree = 3;
  data.smoothing_range = 30;
  data.eig_cg_n_iterations = 0;
  data.max_eigenvalue = level.bound;
  data.preconditioner = std::make_shared<BlockJacobi>(level);
  chebyshev.initialize(product, data);
  const auto size = static_cast<unsigned>(4 * level.batching->n_rows());
  Vector r(size), x(size);
  for (std::size_t i = 0; i < level.n_corners; ++i)
    rows(r)[i] = {float(i % 7) - 3, float(i % 5) - 2, float(i % 11) - 5};
  chebyshev.vmult(x, r);
  product.n_products = 0;
  std::vector<double> theirs, own;
  const auto seconds = [] { return double(std::clock()) / CLOCKS_PER_SEC; };
  for (int k = 0; k < 31; ++k) {
    double start = seconds();
    chebyshev.vmult(x, r);
    theirs.push_back(seconds() - start);
    start = seconds();
    level.smooth_from_zero(rows(r), rows(x));
    own.push_back(seconds() - start);
  }
  std::printf("%8zu elements: deal.II %.3f ms, own %.3f ms, with %d products each\n",
              level.batching->batches().size() * n_lanes, 1e3 * median(theirs), 1e3 * median(own),
              product.n_products / 31);
}

} // namespace
} // namespace kerf::fem

int main(const int argc, char** const argv) {
  kerf::set_n_threads(1);
  kerf::fem::run(argc > 1 ? std::atoi(argv[1]) : 22);
}
