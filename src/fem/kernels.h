#pragma once

/// The inner loops over elements, on plain pointers, vectors across elements, compiled for several instruction sets and
/// chosen at run time.
///
/// The motion of a cube's 8 nodes is taken apart into modes: c_m = sum over nodes a of s_m(a) u_a for the products s_m
/// of the signs of the node's coordinates, m = bits of the axes in the product. (A Walsh-Hadamard transform: 24
/// additions a direction.) Translations are c_0, the three linear modes c_1, c_2, c_4 are affine motions, and what
/// remains, c_3, c_5, c_6, c_7, are the hourglass modes. An element is then little: the mean deformation gradient, sum
/// c_m b_m^T with b_m = e_k / (4 h) for the linear modes and 12 numbers for the others, meets Hooke's law or a law's
/// tangent; a symmetric 12 x 12 matrix meets the hourglass modes, and vanishes for most pairs in a full cube, which is
/// its own mirror image.
///
/// Elements come in batches of 16 of one kind, full or partial. What elements add to a corner is summed in the order
/// of batches, then of lanes: the same for any number of threads whose batches share no corner.

#include <cstddef>
#include <cstdint>

namespace kerf::fem {

constexpr std::size_t n_lanes = 16;
constexpr int n_hourglass = 12, n_hourglass_pairs = 78, n_tangent_pairs = 45;
constexpr int linear_modes[3] = {1, 2, 4}, hourglass_modes[4] = {3, 5, 6, 7};

/// Three numbers a corner, aligned.
template <class T>
struct alignas(4 * sizeof(T)) Row {
  T x = 0, y = 0, z = 0, unused = 0;
};

/// Index of a pair i >= j in a symmetric matrix that is kept row by row up to its diagonal.
constexpr int pair_index(const int i, const int j) { return i * (i + 1) / 2 + j; }

/// Of a partial cube.
template <class T>
struct alignas(64) PartialCubes {
  T volume[n_lanes];
  T weight[n_lanes];                ///< of its diagonal blocks in `diagonal`; may be an excess alone, or none [1]
  T gradient[n_hourglass][n_lanes]; ///< b_m, at 3 k + j [1/m]
};

/// Of a partial cube, what hourglass modes meet in the turned frame [N/m]. Unknowns are 3 k + i for mode k of 3, 5, 6,
/// 7 and direction i. In single precision for both: it is most of what a product reads.
struct alignas(64) HourglassOfCubes {
  float pair[n_hourglass_pairs][n_lanes];
};

/// What all elements of a body share.
template <class T>
struct CubeConstants {
  T h, lambda, mu;                ///< [m], [Pa]
  T volume;                       ///< of a full cube [m^3]
  T hourglass[n_hourglass_pairs]; ///< of a full cube
};

template <class T>
struct Batch {
  const std::uint32_t (*corners)[n_lanes]; ///< 8 rows; lanes that are not used have a corner of their own
  const float (*rotation)[n_lanes];        ///< 9 rows, 3 x 3 column by column
  const PartialCubes<T>* partial;          ///< null: full cubes
  const HourglassOfCubes* hourglass;       ///< of partial ones
  const T (*tangent)[n_lanes];             ///< 45 rows, pairs of the law's tangent times the volume; null: Hooke's
  std::uint32_t n_used;                    ///< lanes, the first ones
  bool is_row; ///< each lane's cube stands on the one before it along x: they share the corners between them
};

/// F and its rotation for each lane, 3 x 3 column by column.
struct alignas(64) Turns {
  double F[9][n_lanes], R[9][n_lanes];
};

template <class T>
struct ElementKernels {
  /// y += K p.
  void (*product)(const CubeConstants<T>& cube, const Batch<T>& batch, const Row<T>* p, Row<T>* y);
  /// Adds the diagonal 3 x 3 blocks of K: xx, yy, zz to a corner's first row and xy, yz, zx to its second.
  void (*diagonal)(const CubeConstants<T>& cube, const Batch<T>& batch, Row<T>* blocks);
};

/// Any x86-64, AVX2, AVX-512.
enum class InstructionSet { narrow, middle, wide };
/// The widest that this processor has.
InstructionSet instruction_set();

template <class T>
const ElementKernels<T>& element_kernels(InstructionSet set = instruction_set());

/// R of the polar decomposition of any F, 3 x 3 column by column.
using FindRotation = void (*)(const double* F, double* R);

/// What of Hooke's law an energy holds beside the hourglass modes.
enum class MeanPart { hooke, none };

struct ForceKernels {
  /// F, and the R of its polar decomposition. Returns bits of the lanes whose R is not found, for being inverted or
  /// far from a rotation.
  unsigned (*turn)(const CubeConstants<double>& cube, const Batch<double>& batch, const Row<double>* x, Turns& turns);
  /// forces -= dE/dx, dR/dx included where `spins` is 1 (and not where it is 0), with P, 9 rows, the stress of a law
  /// times the volume, beside (null: none). `energies`: as energy() has them, to the last bit; null: none.
  void (*force)(const CubeConstants<double>& cube, const Batch<double>& batch, const Turns& turns, MeanPart mean,
                const double (*P)[n_lanes], double spins, const Row<double>* x, Row<double>* forces, double* energies);
  /// Both at once, for Hooke's law in frames that turn: the same to the last bit, with R by `find` where turn() has
  /// none.
  void (*turned_force)(const CubeConstants<double>& cube, const Batch<double>& batch, FindRotation find,
                       const Row<double>* x, Row<double>* forces, double* energies);
  /// E of each lane that is used [J].
  void (*energy)(const CubeConstants<double>& cube, const Batch<double>& batch, const Turns& turns, MeanPart mean,
                 const Row<double>* x, double* energies);
  /// q = tr(R^T G) of each lane, G the mean gradient of p and R the batch's rotation: how a volume changes.
  void (*dilatation)(const CubeConstants<double>& cube, const Batch<double>& batch, const Row<double>* p, double* q);
  /// y += the derivative of that by p, times q.
  void (*add_pressure)(const CubeConstants<double>& cube, const Batch<double>& batch, const double* q, Row<double>* y);
};
const ForceKernels& force_kernels(InstructionSet set = instruction_set());

} // namespace kerf::fem
