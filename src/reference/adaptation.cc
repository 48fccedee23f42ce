#include "base/error.h"
#include "base/parallel.h"
#include "reference/space.h"

#include <deal.II/grid/grid_refinement.h>
#include <deal.II/lac/sparse_direct.h>
#include <deal.II/numerics/error_estimator.h>

namespace kerf::reference {

using Vector = dealii::Vector<double>;

template <int dim>
Vector equilibrium(const Space<dim>& space) {
  System<dim> system(space);
  dealii::SparseDirectUMFPACK factors;
  Vector u(space.dofs.n_dofs());
  try {
    keep_libraries_to_one_thread();
    factors.initialize(system.K);
    factors.vmult(u, system.f);
  } catch (const dealii::ExceptionBase& error) {
    throw NumericalError("the reference problem cannot be solved: its body is free to move, or it is too large");
  }
  Vector left(system.f.size());
  constexpr double solved = 1e-6; // what a regular matrix leaves is far below
  if (!(system.K.residual(left, u, system.f) <= solved * system.f.l2_norm()))
    throw NumericalError("the reference problem cannot be solved: its body is free to move");
  space.constraints.distribute(u);
  return u;
}

template <int dim>
dealii::Vector<float> estimate(const Space<dim>& space, const Vector& u) {
  dealii::Vector<float> errors(space.triangulation.n_active_cells());
  dealii::KellyErrorEstimator<dim>::estimate(space.mapping, space.dofs, space.face_quadrature(), {}, u, errors);
  return errors;
}

template <int dim>
void adapt(Space<dim>& space, const Discretisation& discretisation) {
  for (int i = 0; i < discretisation.n_adaptations; ++i) {
    dealii::GridRefinement::refine_and_coarsen_fixed_number(space.triangulation, estimate(space, equilibrium(space)),
                                                            discretisation.refined_part, 0);
    space.triangulation.execute_coarsening_and_refinement();
    space.distribute();
  }
}

template dealii::Vector<double> equilibrium(const Space<2>&);
template dealii::Vector<double> equilibrium(const Space<3>&);
template dealii::Vector<float> estimate(const Space<2>&, const dealii::Vector<double>&);
template dealii::Vector<float> estimate(const Space<3>&, const dealii::Vector<double>&);
template void adapt(Space<2>&, const Discretisation&);
template void adapt(Space<3>&, const Discretisation&);

} // namespace kerf::reference
