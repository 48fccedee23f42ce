#pragma once

/// Beams along x, clamped or guided, whole and split: what they do under load, and what theory says.
///
/// Lattice nodes lie on the ends x = 0 and x = L, and on the sides in y; across the thickness (z) they are offset as a
/// problem wants it.

#include "tests/verification/statics.h"

namespace kerf::verification {

struct BeamModel {
  fem::Strain strain = fem::Strain::enhanced;
  fem::Boundary boundary = fem::Boundary::octants;
  double ghost_weight = fem::GhostPenaltyOptions().weight;
  double poissons_ratio = 0.3; ///< of heavy_cantilever [1]
};

struct BeamResult {
  double value = 0; ///< what was asked for
  std::size_t n_cells = 0;
  Cost cost;
};

/// 1 x 0.2 x 0.2 m, E = 1e6 Pa, 1000 kg/m^3, clamped, under g = 9.81 m/s^2: deflection of the other end's middle [m];
/// converged quadratic elements give 0.37663 for nu = 0.3 and 0.36619 for 0.499. `offset` in y and z.
constexpr double heavy_cantilever_reference = 0.37663, heavy_cantilever_reference_at_0499 = 0.36619;
BeamResult heavy_cantilever(int n_over_height, const Vec3& offset, const BeamModel& model);

/// Of nu = 0, clamped, under a force at its end (as a uniform traction) over a length L; thickness t, width 2 h. Its
/// deflection over that of Timoshenko's beam, P L^3/(3 E I) + P L/(5/6 G A) (Timoshenko and Goodier, Theory of
/// Elasticity, 1970;
/// the shear coefficient 5/6 is Cowper's, 1966, for nu = 0).
BeamResult end_loaded_cantilever(double slenderness, int n_over_thickness, const BeamModel& model);

/// The same cut into equal layers by planes z = const, each of `n_over_layer` cells; nodes `shift` h above the planes.
/// Deflection over that of its layers side by side: P L^3 n^2/(3 E I) + P L/(5/6 G A).
struct SplitBeam {
  int n_layers = 2, n_over_layer = 8;
  double slenderness = 4; ///< length over the thickness of all layers [1]
  double shift = 0.5;     ///< [1], in (0, 1)
};
BeamResult split_beam(const SplitBeam& beam, const BeamModel& model);

/// Deflection over length of a slender cantilever of nu = 0 (corotational) under a dead force P at its end, with
/// P L^2/(E I) = alpha. The inextensible elastica: 0.30172, 0.49346, 0.81061 for alpha = 1, 2, 10 (Bisshopp and
/// Drucker 1945).
BeamResult elastica(double alpha, double slenderness, int n_over_thickness);

/// Of the first mode of a kind of a square beam whose ends x = 0 and x = L may only move within their planes:
/// waves with wave number k = pi / L, of which theory has closed forms without end effects.
enum class Vibration { bending, axial, torsion };
using fem::MassMatrix;
/// Frequency over theory's: bending by Timoshenko's beam with the shear coefficient 5 (1 + nu)/(6 + 5 nu) (Hutchinson
/// 2001 compares coefficients), axial with Love's lateral inertia, torsion by Saint-Venant with J = 0.140577 t^4.
BeamResult frequency(Vibration kind, double slenderness, int n_over_thickness, MassMatrix mass, const BeamModel& model);

/// Two arms of height `arm` at the end x = 0 of a beam, clamped at its other end, nu = 0, nodes midway above the cut.
/// The front of the cut lies `front` h beyond the last nodes that it passes, those at x = a.
struct DoubleCantilever {
  double a = 4, arm = 1; ///< multiples of the cube edge [m]
  int n_over_arm = 4;
  double front = 0.01; ///< in (0, 1) [1]
};
/// The arms pulled apart by P, spread evenly over each arm's end: the elements' energy release rate, in tubes of a / 2
/// and .9 a around the front, over 12 P^2 c^2/(E b^2 arm^3) (1 + 0.673 arm/c)^2 with c = a + front h (Foote and
/// Buchwald 1985, Int. J. Fracture 29, 125-134; here without their terms for a force that acts at a point). Elements of
/// degree 7, in layers that shrink by 0.3 towards the front, give 0.6732 for c / arm = 2 and 4: the formula is good to
/// 2e-4.
BeamResult double_cantilever(const DoubleCantilever& beam, const BeamModel& model);
/// The same by work: half of what that of P grows by as c grows from an arm less to an arm more.
BeamResult double_cantilever_by_work(const DoubleCantilever& beam, const BeamModel& model);
/// The arms pulled apart likewise: P times the opening, twice the energy that the beam has; value [J].
BeamResult work_on_double_cantilever(const DoubleCantilever& beam, const BeamModel& model);
/// The arms pulled apart likewise: the work of P after a blade has come from x = 0 to the front in so many steps, over
/// that after a rectangle has cut as far at once.
BeamResult blade_over_rectangle(const DoubleCantilever& beam, int n_steps, const BeamModel& model);
/// The arms pushed apart by a pressure of 1 Pa on the faces of the cut, E = 1 Pa: opening at x = 0 between the middles
/// of the arms [m]. The cell that holds the front is one element, as in a mesh that is fitted to x = a.
BeamResult pressed_arms(const DoubleCantilever& beam, const BeamModel& model);

} // namespace kerf::verification
