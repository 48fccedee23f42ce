#pragma once

/// A problem in deal.II's terms: mesh, elements, constraints. For this room alone.

#include "reference/problem.h"

#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/fe_system.h>
#include <deal.II/fe/mapping_q.h>
#include <deal.II/grid/tria.h>
#include <deal.II/lac/affine_constraints.h>
#include <deal.II/lac/full_matrix.h>
#include <deal.II/lac/sparse_matrix.h>
#include <deal.II/lac/vector.h>

namespace kerf::reference {

template <int dim>
Vec3 to_vec(const dealii::Tensor<1, dim>& v) {
  Vec3 all = Vec3::Zero();
  for (int d = 0; d < dim; ++d)
    all[d] = v[d];
  return all;
}

/// A field as deal.II asks for it.
template <int dim>
class FieldFunction : public dealii::Function<dim> {
 public:
  explicit FieldFunction(Field field) : dealii::Function<dim>(dim), field_(std::move(field)) {}
  void vector_value(const dealii::Point<dim>& X, dealii::Vector<double>& values) const override {
    const Vec3 u = field_ ? field_(to_vec<dim>(X)) : Vec3(Vec3::Zero());
    for (int d = 0; d < dim; ++d)
      values[d] = u[d];
  }

 private:
  Field field_;
};

/// Which supports and tractions of a problem claim the faces of a boundary id: bit i for the i-th.
struct Claims {
  std::uint64_t supports = 0, tractions = 0;
  auto operator<=>(const Claims&) const = default;
};

template <int dim>
struct Space {
  Space(const Problem& problem, const Discretisation& discretisation);
  Space(const Space&) = delete;
  Space& operator=(const Space&) = delete;

  /// Numbers unknowns and makes constraints anew; after each refinement.
  void distribute();
  dealii::Quadrature<dim> quadrature() const;
  dealii::Quadrature<dim - 1> face_quadrature() const;

  const Problem problem;
  dealii::Triangulation<dim> triangulation;
  dealii::FESystem<dim> element;
  dealii::MappingQ<dim> mapping;
  dealii::DoFHandler<dim> dofs;
  dealii::AffineConstraints<double> constraints; ///< hanging nodes and supports
  std::vector<Claims> claims;                    ///< per boundary id
};

/// The matrices and the load of a problem, constraints eliminated.
template <int dim>
struct System {
  explicit System(const Space<dim>& space);

  dealii::SparsityPattern pattern;
  dealii::SparseMatrix<double> K; ///< [N/m]
  dealii::Vector<double> f;       ///< [N]
};

/// The consistent mass [kg] on a system's pattern; nothing stands at constrained unknowns, so that they take part in no
/// mode.
template <int dim>
void assemble_mass(const Space<dim>& space, const System<dim>& system, dealii::SparseMatrix<double>& M);

/// Displacements [m] in equilibrium, of all unknowns. Throws NumericalError where the body is free to move.
template <int dim>
dealii::Vector<double> equilibrium(const Space<dim>& space);
/// The estimate of the error of each cell.
template <int dim>
dealii::Vector<float> estimate(const Space<dim>& space, const dealii::Vector<double>& u);
/// Refines where the error in equilibrium is largest, as often as the discretisation says.
template <int dim>
void adapt(Space<dim>& space, const Discretisation& discretisation);

extern template struct Space<2>;
extern template struct Space<3>;
extern template struct System<2>;
extern template struct System<3>;

} // namespace kerf::reference
