/// How fast elements are: making them, forces, linearisation and products, for each law and kind of strain. Best of
/// several runs on one thread, CPU time.

#include "base/parallel.h"
#include "dynamics/state.h"
#include "fem/fields.h"
#include "tests/fem/models.h"

#include <cstdio>
#include <ctime>

namespace kerf::fem {
namespace {

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// The least time of a call [s].
template <class Function>
double best(const Function& f) {
  constexpr int n_runs = 7;
  double least = 1e300;
  for (int i = 0; i < n_runs; ++i) {
    const double start = cpu_seconds();
    f();
    least = std::min(least, cpu_seconds() - start);
  }
  return least;
}

void print(const char* const what, const std::size_t n, const double seconds) {
  std::printf("  %-26s %9zu elements  %9.3f ms  %8.3f M elements/s\n", what, n, 1e3 * seconds,
              1e-6 * static_cast<double>(n) / seconds);
}

void measure(const Body& body, const HexahedraOptions& options) {
  std::printf("%s\n", name_of(options).c_str());
  Hexahedra model = make_model(body, options);
  const std::size_t n = model.n_elements();
  print("building, all partial", model.n_partial(), best([&] { make_model(body, options); }));
  Points x = body.rest(), f(x.size());
  Draw draw(1);
  for (Vec3& p : x)
    p += 0.02 * body.grid.h() * draw.vector();
  print("energy", n, best([&] { model.energy(x); }));
  print("force", n, best([&] { model.force(x, f); }));
  print("linearise", n, best([&] { model.linearise(x); }));
  print("stiffness product", n, best([&] { model.apply_stiffness(dynamics::flat(x), dynamics::flat(f)); }));
  print("assembled, exact", n, best([&] { model.stiffness_matrix(x, dynamics::Tangent::exact); }));
  print("stress at corners", n, best([&] { at_corners(model, x, stress_of_copies(model, x)); }));
}

void run() {
  set_n_threads(1);
  Draw draw(2);
  const Body body = make_block({20, 20, 20}, 0.05, draw, {0.3, 0.7});
  for (const std::string& law : all_laws)
    measure(body, {.material = with_law({}, law)});
  measure(body, {.material = {}, .strain = Strain::enhanced});
}

} // namespace
} // namespace kerf::fem

int main() { kerf::fem::run(); }
