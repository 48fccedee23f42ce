#include "reference/solution.h"

#include "base/error.h"
#include "base/parallel.h"
#include "reference/space.h"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/lac/arpack_solver.h>
#include <deal.II/lac/sparse_direct.h>
#include <deal.II/numerics/vector_tools_integrate_difference.h>
#include <deal.II/numerics/vector_tools_point_value.h>

#include <cmath>
#include <numbers>

namespace kerf::reference {

namespace {

using Vector = dealii::Vector<double>;

template <int dim>
class Found : public Solution {
 public:
  Found(const Problem& problem, const Discretisation& discretisation) : space_(problem, discretisation) {
    adapt(space_, discretisation);
    u_ = equilibrium(space_);
  }

  Vec3 displacement(const Vec3& X) const override {
    dealii::Point<dim> point;
    for (int d = 0; d < dim; ++d)
      point[d] = X[d];
    Vector value(dim);
    try {
      dealii::VectorTools::point_value(space_.mapping, space_.dofs, u_, point, value);
    } catch (const dealii::ExceptionBase&) {
      throw DataError("a point that a reference solution is asked at lies outside of its body");
    }
    Vec3 u = Vec3::Zero();
    for (int d = 0; d < dim; ++d)
      u[d] = value[d];
    return u;
  }

  double energy() const override {
    const double E = space_.problem.youngs_modulus, nu = space_.problem.poissons_ratio;
    const double lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), mu = E / (2 * (1 + nu));
    const dealii::FEValuesExtractors::Vector all(0);
    dealii::FEValues<dim> values(space_.mapping, space_.element, space_.quadrature(),
                                 dealii::update_gradients | dealii::update_JxW_values);
    std::vector<dealii::SymmetricTensor<2, dim>> strains(values.n_quadrature_points);
    double sum = 0;
    for (const auto& cell : space_.dofs.active_cell_iterators()) {
      values.reinit(cell);
      values[all].get_function_symmetric_gradients(u_, strains);
      for (unsigned int q = 0; q < strains.size(); ++q)
        sum += (lambda / 2 * std::pow(trace(strains[q]), 2) + mu * (strains[q] * strains[q])) * values.JxW(q);
    }
    return sum;
  }

  double over_skin(const std::function<double(const Vec3&, const Vec3&, const Vec3&)>& f) const override {
    dealii::FEFaceValues<dim> values(space_.mapping, space_.element, space_.face_quadrature(),
                                     dealii::update_values | dealii::update_JxW_values |
                                       dealii::update_quadrature_points | dealii::update_normal_vectors);
    const dealii::FEValuesExtractors::Vector all(0);
    std::vector<dealii::Tensor<1, dim>> u(values.n_quadrature_points);
    double sum = 0;
    for (const auto& cell : space_.dofs.active_cell_iterators())
      for (const auto face : cell->face_indices())
        if (cell->at_boundary(face)) {
          values.reinit(cell, face);
          values[all].get_function_values(u_, u);
          for (unsigned int q = 0; q < u.size(); ++q)
            sum += values.JxW(q) *
                   f(to_vec<dim>(values.quadrature_point(q)), to_vec<dim>(values.normal_vector(q)), to_vec<dim>(u[q]));
        }
    return sum;
  }

  double distance_to(const Field& exact) const override {
    dealii::Vector<float> errors(space_.triangulation.n_active_cells());
    dealii::VectorTools::integrate_difference(space_.mapping, space_.dofs, u_, FieldFunction<dim>(exact), errors,
                                              dealii::QGauss<dim>(space_.element.degree + 3),
                                              dealii::VectorTools::L2_norm);
    return errors.l2_norm();
  }

  std::size_t n_unknowns() const override { return space_.dofs.n_dofs() - space_.constraints.n_constraints(); }
  double estimated_error() const override { return estimate(space_, u_).l2_norm(); }

 private:
  Space<dim> space_;
  Vector u_;
};

/// A frequency far below those of any mode that deforms the body, squared [1/s^2].
double low(const Problem& problem) {
  Vec3 lower = problem.mesh.vertices.front(), upper = lower;
  for (const Vec3& X : problem.mesh.vertices) {
    lower = lower.cwiseMin(X);
    upper = upper.cwiseMax(X);
  }
  constexpr double part = 1e-3;
  return part * problem.youngs_modulus / (problem.density * (upper - lower).squaredNorm());
}

/// The lowest eigenvalues of K v = lambda M v by Lanczos on (K + low M)^-1 M, which is regular though the body be free.
template <int dim>
std::vector<double> lowest_eigenvalues(const Problem& problem, const Discretisation& discretisation, const int n) {
  const Space<dim> space(problem, discretisation);
  System<dim> system(space);
  dealii::SparseMatrix<double> M, shifted;
  assemble_mass(space, system, M);
  shifted.reinit(system.pattern);
  shifted.copy_from(system.K);
  const double shift = low(problem);
  shifted.add(shift, M);
  dealii::SparseDirectUMFPACK inverse;
  keep_libraries_to_one_thread();
  inverse.initialize(shifted);
  const auto n_wanted = static_cast<unsigned int>(n);
  dealii::SolverControl control(static_cast<unsigned int>(space.dofs.n_dofs()), 1e-12);
  dealii::ArpackSolver solver(
    control, dealii::ArpackSolver::AdditionalData(2 * n_wanted + 20, dealii::ArpackSolver::largest_magnitude, true));
  solver.set_shift(-shift);
  std::vector<std::complex<double>> values(n_wanted);
  std::vector<Vector> vectors(n_wanted, Vector(space.dofs.n_dofs()));
  Vector start(space.dofs.n_dofs());
  for (unsigned int i = 0; i < start.size(); ++i)
    start[i] = space.constraints.is_constrained(i) ? 0 : std::sin(1.0 + i);
  solver.set_initial_vector(start);
  solver.solve(system.K, M, inverse, values, vectors, n_wanted);
  std::vector<double> found;
  for (const auto& value : values)
    found.push_back(value.real());
  std::sort(found.begin(), found.end());
  return found;
}

} // namespace

std::unique_ptr<Solution> solve(const Problem& problem, const Discretisation& discretisation) {
  if (problem.mesh.dimension == 2)
    return std::make_unique<Found<2>>(problem, discretisation);
  return std::make_unique<Found<3>>(problem, discretisation);
}

std::vector<double> lowest_frequencies(const Problem& problem, const Discretisation& discretisation, const int n) {
  std::vector<double> values = problem.mesh.dimension == 2 ? lowest_eigenvalues<2>(problem, discretisation, n)
                                                           : lowest_eigenvalues<3>(problem, discretisation, n);
  for (double& value : values)
    value = std::sqrt(std::max(value, 0.0)) / (2 * std::numbers::pi);
  return values;
}

} // namespace kerf::reference
