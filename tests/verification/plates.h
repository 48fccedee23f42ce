#pragma once

/// Problems whose answers are not those of a beam: Cook's membrane, a cut in the shape of a disc, and the condition of
/// what slivers do to the stiffness.

#include "tests/verification/statics.h"

namespace kerf::verification {

/// Cook's trapezium (Cook, Malkus and Plesha 1989): corners (0, 0), (48, 44), (48, 60), (0, 44), clamped at x = 0,
/// a shear load of 1 N/m on x = 48. Plane stress with E = 1 Pa, nu = 1/3 is what is tabulated; plane strain with 15/16
/// Pa and nu = 1/4 has the same stiffness in its plane, and is what a slab between two slippery walls can do.
/// Displacement v of the middle of the loaded side [m]: 23.9677 by elements of degree 5 in layers that shrink by 0.3
/// towards all four corners (degree 4: 23.9676); tables of the literature end at 23.96.
constexpr double cook_reference = 23.968;
/// The same, in plane strain with E = 1 Pa: v for nu = 0.3 and 0.499, by the same elements (degree 4: 21.945, 18.531).
constexpr double cook_reference_at_03 = 21.945, cook_reference_at_0499 = 18.533;
struct PlateResult {
  double value = 0;
  std::size_t n_cells = 0;
  double smallest_fraction = 1; ///< [1]
  Cost cost;
};
PlateResult cooks_membrane(int n_over_length, double offset, const fem::HexahedraOptions& options);
/// Its material.
fem::HexahedraOptions cook_material(fem::Strain strain);

/// A disc cut (radius r, centre and plane off the lattice) in the middle of a cube of edge 2 R under a tension sigma
/// along the disc's normal. Sneddon 1946: the faces open by w(s) = 8 (1 - nu^2) sigma sqrt(r^2 - s^2) / (pi E), twice
/// what one face moves, in a body without end.
struct Penny {
  double n_over_radius = 3;             ///< cubes
  double half_width = 4;                ///< R / r [1]
  Vec3 offset = Vec3(0.31, 0.43, 0.57); ///< of the centre from a node, in parts of h [1]
  Vec3 normal = Vec3::UnitZ();          ///< of any length
};
struct PennyResult {
  double opening = 0;       ///< as a multiple of the exact one, nearest to it at the cut edges in the disc [1]
  double opening_error = 0; ///< root mean square of what these are off that multiple, over that of the exact one [1]
  double volume = 0;        ///< of the gap, over the exact one, 16 (1 - nu^2) sigma r^3 / (3 E) [1]
  double work = 0;          ///< of the tension, beyond that on a block without a cut, over sigma times that volume [1]
  double release_rate = 0;  ///< of the elements, in tubes of r / 2 and .95 r, over 4 (1 - nu^2) sigma^2 r / (pi E) [1]
  std::size_t n_cells = 0;
  Cost cost;
};
PennyResult penny(const Penny& problem, const fem::HexahedraOptions& options);
/// The work of such a cut that is bent to a part of a sphere of `radius`, r from its middle to its rim along it, given
/// as a mesh, as PennyResult has it.
double work_of_cap(const Penny& problem, double radius, cut::Fronts fronts, const fem::HexahedraOptions& options);

/// The work of a tension of 1 Pa across a crack from the side of a cube of 3 m, E = 1 Pa, whose plane leans by an angle
/// [rad] about a line of the grid, along which its front lies: in cubes of .25 m, so many of them ahead of the middle and
/// above it.
double work_of_leaning_crack(double angle, double along, double across, const fem::HexahedraOptions& options);

/// A plate of 1 x 2 m in plane strain (E = 1 Pa, nu = 0.3), in cubes of which n are 1 m, with a crack of .4 m from its
/// side under a tension of 1 Pa: where its front and its plane lie between nodes.
struct EdgeCrack {
  double along = 0.5, across = 0.5; ///< of a cube [1]
  int n = 20;
};
struct EdgeCrackResult {
  double front_error = 0; ///< how far the front lies too far, as the work of the tension tells it [cubes]
  double intensity = 0;   ///< the stress intensity by energy release, over that by which the work grows with the crack
};
/// Elements of extended inertia are those of explicit steps.
EdgeCrackResult edge_crack(const EdgeCrack& crack, fem::Strain strain, fem::Inertia inertia = fem::Inertia::lumped);

/// Condition numbers [1] of the stiffness of a small clamped block whose outer layers of cells, on two sides, are
/// filled
/// to `depth` of a cell: as it is, and with the Cholesky factors of its 3 x 3 diagonal blocks on both sides, as the
/// solvers see it.
struct Condition {
  double smallest_fraction = 0, plain = 0, scaled = 0;
};
Condition condition(double depth, const fem::HexahedraOptions& options);

} // namespace kerf::verification
