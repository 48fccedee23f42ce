#include "fem/kernels.h"

#include "fem/force_loops.h"

namespace kerf::fem {

namespace {

// --- wide: AVX-512 ---

[[gnu::target("arch=x86-64-v4")]] void product_wide(const CubeConstants<double>& cube, const Batch<double>& batch,
                                                    const Row<double>* const p, Row<double>* const y) {
  ElementLoops<double, 8>::product(cube, batch, p, y);
}
[[gnu::target("arch=x86-64-v4")]] void diagonal_wide(const CubeConstants<double>& cube, const Batch<double>& batch,
                                                     Row<double>* const blocks) {
  ElementLoops<double, 8>::diagonal(cube, batch, blocks);
}
[[gnu::target("arch=x86-64-v4")]] void product_wide(const CubeConstants<float>& cube, const Batch<float>& batch,
                                                    const Row<float>* const p, Row<float>* const y) {
  ElementLoops<float, 16>::product(cube, batch, p, y);
}
[[gnu::target("arch=x86-64-v4")]] void diagonal_wide(const CubeConstants<float>& cube, const Batch<float>& batch,
                                                     Row<float>* const blocks) {
  ElementLoops<float, 16>::diagonal(cube, batch, blocks);
}
[[gnu::target("arch=x86-64-v4")]] void dilatation_wide(const CubeConstants<double>& cube, const Batch<double>& batch,
                                                       const Row<double>* const p, double* const q) {
  ElementLoops<double, 8>::dilatation(cube, batch, p, q);
}
[[gnu::target("arch=x86-64-v4")]] void add_pressure_wide(const CubeConstants<double>& cube, const Batch<double>& batch,
                                                         const double* const q, Row<double>* const y) {
  ElementLoops<double, 8>::add_pressure(cube, batch, q, y);
}
[[gnu::target("arch=x86-64-v4")]] unsigned turn_wide(const CubeConstants<double>& cube, const Batch<double>& batch,
                                                     const Row<double>* const x, Turns& turns) {
  return ForceLoops<double, 8>::turn_all(cube, batch, x, turns);
}
[[gnu::target("arch=x86-64-v4")]] void force_wide(const CubeConstants<double>& cube, const Batch<double>& batch,
                                                  const Turns& turns, const MeanPart mean,
                                                  const double (*const P)[n_lanes], const double spins,
                                                  const Row<double>* const x, Row<double>* const forces,
                                                  double* const energies) {
  ForceLoops<double, 8>::force(cube, batch, turns, mean, P, spins, x, forces, energies);
}
[[gnu::target("arch=x86-64-v4")]] void turned_force_wide(const CubeConstants<double>& cube,
                                                          const Batch<double>& batch, const FindRotation find,
                                                          const Row<double>* const x, Row<double>* const forces,
                                                          double* const energies) {
  ForceLoops<double, 8>::turned_force(cube, batch, find, x, forces, energies);
}
[[gnu::target("arch=x86-64-v4")]] void energy_wide(const CubeConstants<double>& cube, const Batch<double>& batch,
                                                   const Turns& turns, const MeanPart mean, const Row<double>* const x,
                                                   double* const energies) {
  ForceLoops<double, 8>::energy(cube, batch, turns, mean, x, energies);
}

// --- middle: AVX2 ---

[[gnu::target("arch=x86-64-v3")]] void product_middle(const CubeConstants<double>& cube, const Batch<double>& batch,
                                                      const Row<double>* const p, Row<double>* const y) {
  ElementLoops<double, 4>::product(cube, batch, p, y);
}
[[gnu::target("arch=x86-64-v3")]] void diagonal_middle(const CubeConstants<double>& cube, const Batch<double>& batch,
                                                       Row<double>* const blocks) {
  ElementLoops<double, 4>::diagonal(cube, batch, blocks);
}
[[gnu::target("arch=x86-64-v3")]] void product_middle(const CubeConstants<float>& cube, const Batch<float>& batch,
                                                      const Row<float>* const p, Row<float>* const y) {
  ElementLoops<float, 8>::product(cube, batch, p, y);
}
[[gnu::target("arch=x86-64-v3")]] void diagonal_middle(const CubeConstants<float>& cube, const Batch<float>& batch,
                                                       Row<float>* const blocks) {
  ElementLoops<float, 8>::diagonal(cube, batch, blocks);
}
[[gnu::target("arch=x86-64-v3")]] void dilatation_middle(const CubeConstants<double>& cube, const Batch<double>& batch,
                                                         const Row<double>* const p, double* const q) {
  ElementLoops<double, 4>::dilatation(cube, batch, p, q);
}
[[gnu::target("arch=x86-64-v3")]] void add_pressure_middle(const CubeConstants<double>& cube,
                                                           const Batch<double>& batch, const double* const q,
                                                           Row<double>* const y) {
  ElementLoops<double, 4>::add_pressure(cube, batch, q, y);
}
[[gnu::target("arch=x86-64-v3")]] unsigned turn_middle(const CubeConstants<double>& cube, const Batch<double>& batch,
                                                       const Row<double>* const x, Turns& turns) {
  return ForceLoops<double, 4>::turn_all(cube, batch, x, turns);
}
[[gnu::target("arch=x86-64-v3")]] void force_middle(const CubeConstants<double>& cube, const Batch<double>& batch,
                                                    const Turns& turns, const MeanPart mean,
                                                    const double (*const P)[n_lanes], const double spins,
                                                    const Row<double>* const x, Row<double>* const forces,
                                                    double* const energies) {
  ForceLoops<double, 4>::force(cube, batch, turns, mean, P, spins, x, forces, energies);
}
[[gnu::target("arch=x86-64-v3")]] void turned_force_middle(const CubeConstants<double>& cube,
                                                          const Batch<double>& batch, const FindRotation find,
                                                          const Row<double>* const x, Row<double>* const forces,
                                                          double* const energies) {
  ForceLoops<double, 4>::turned_force(cube, batch, find, x, forces, energies);
}
[[gnu::target("arch=x86-64-v3")]] void energy_middle(const CubeConstants<double>& cube, const Batch<double>& batch,
                                                     const Turns& turns, const MeanPart mean,
                                                     const Row<double>* const x, double* const energies) {
  ForceLoops<double, 4>::energy(cube, batch, turns, mean, x, energies);
}

// --- narrow: any x86-64 ---

void product_narrow(const CubeConstants<double>& cube, const Batch<double>& batch, const Row<double>* const p,
                    Row<double>* const y) {
  ElementLoops<double, 4>::product(cube, batch, p, y);
}
void diagonal_narrow(const CubeConstants<double>& cube, const Batch<double>& batch, Row<double>* const blocks) {
  ElementLoops<double, 4>::diagonal(cube, batch, blocks);
}
void product_narrow(const CubeConstants<float>& cube, const Batch<float>& batch, const Row<float>* const p,
                    Row<float>* const y) {
  ElementLoops<float, 4>::product(cube, batch, p, y);
}
void diagonal_narrow(const CubeConstants<float>& cube, const Batch<float>& batch, Row<float>* const blocks) {
  ElementLoops<float, 4>::diagonal(cube, batch, blocks);
}
void dilatation_narrow(const CubeConstants<double>& cube, const Batch<double>& batch,
                       const Row<double>* const p, double* const q) {
  ElementLoops<double, 4>::dilatation(cube, batch, p, q);
}
void add_pressure_narrow(const CubeConstants<double>& cube, const Batch<double>& batch,
                         const double* const q, Row<double>* const y) {
  ElementLoops<double, 4>::add_pressure(cube, batch, q, y);
}
unsigned turn_narrow(const CubeConstants<double>& cube, const Batch<double>& batch, const Row<double>* const x,
                     Turns& turns) {
  return ForceLoops<double, 4>::turn_all(cube, batch, x, turns);
}
void force_narrow(const CubeConstants<double>& cube, const Batch<double>& batch, const Turns& turns,
                  const MeanPart mean, const double (*const P)[n_lanes], const double spins, const Row<double>* const x,
                  Row<double>* const forces, double* const energies) {
  ForceLoops<double, 4>::force(cube, batch, turns, mean, P, spins, x, forces, energies);
}
void turned_force_narrow(const CubeConstants<double>& cube, const Batch<double>& batch, const FindRotation find,
                         const Row<double>* const x, Row<double>* const forces, double* const energies) {
  ForceLoops<double, 4>::turned_force(cube, batch, find, x, forces, energies);
}
void energy_narrow(const CubeConstants<double>& cube, const Batch<double>& batch, const Turns& turns,
                   const MeanPart mean, const Row<double>* const x, double* const energies) {
  ForceLoops<double, 4>::energy(cube, batch, turns, mean, x, energies);
}

} // namespace

InstructionSet instruction_set() {
  static const InstructionSet set = __builtin_cpu_supports("x86-64-v4")   ? InstructionSet::wide
                                    : __builtin_cpu_supports("x86-64-v3") ? InstructionSet::middle
                                                                          : InstructionSet::narrow;
  return set;
}

template <class T>
const ElementKernels<T>& element_kernels(const InstructionSet set) {
  static constexpr ElementKernels<T> kernels[3] = {
    {product_narrow, diagonal_narrow}, {product_middle, diagonal_middle}, {product_wide, diagonal_wide}};
  return kernels[static_cast<int>(set)];
}
template const ElementKernels<double>& element_kernels<double>(InstructionSet);
template const ElementKernels<float>& element_kernels<float>(InstructionSet);

const ForceKernels& force_kernels(const InstructionSet set) {
  static constexpr ForceKernels kernels[3] = {
    {turn_narrow, force_narrow, turned_force_narrow, energy_narrow, dilatation_narrow, add_pressure_narrow},
    {turn_middle, force_middle, turned_force_middle, energy_middle, dilatation_middle, add_pressure_middle},
    {turn_wide, force_wide, turned_force_wide, energy_wide, dilatation_wide, add_pressure_wide}};
  return kernels[static_cast<int>(set)];
}

} // namespace kerf::fem
