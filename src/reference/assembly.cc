#include "reference/space.h"

#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/lac/dynamic_sparsity_pattern.h>

#include <Eigen/Dense>

namespace kerf::reference {

namespace {

/// Values and gradients of one component's shape functions in a cell, times the root of each quadrature weight, so that
/// their products are integrals: rows are quadrature points.
template <int dim>
class Shapes {
 public:
  Shapes(const Space<dim>& space, const dealii::UpdateFlags flags)
    : values_(space.mapping, space.element.base_element(0), space.quadrature(), flags | dealii::update_JxW_values),
      n_(space.element.base_element(0).n_dofs_per_cell()) {}

  void reinit(const typename dealii::Triangulation<dim>::cell_iterator& cell) { values_.reinit(cell); }

  Eigen::MatrixXd gradients(const int axis) const {
    return filled([&](const unsigned int i, const unsigned int q) { return values_.shape_grad(i, q)[axis]; });
  }
  Eigen::MatrixXd values() const {
    return filled([&](const unsigned int i, const unsigned int q) { return values_.shape_value(i, q); });
  }
  unsigned int n() const { return n_; }
  const dealii::FEValues<dim>& at_points() const { return values_; }

 private:
  template <class Entry>
  Eigen::MatrixXd filled(const Entry& entry) const {
    Eigen::MatrixXd A(values_.n_quadrature_points, n_);
    for (unsigned int q = 0; q < values_.n_quadrature_points; ++q)
      for (unsigned int i = 0; i < n_; ++i)
        A(q, i) = entry(i, q) * std::sqrt(values_.JxW(q));
    return A;
  }

  dealii::FEValues<dim> values_;
  unsigned int n_;
};

/// Hooke's law, component by component: entry (i a, j b) is the integral of
/// lambda d_a N_i d_b N_j + mu (d_b N_i d_a N_j + delta_ab grad N_i . grad N_j).
template <int dim>
void add_stiffness(const Space<dim>& space, const Shapes<dim>& shapes, dealii::FullMatrix<double>& K) {
  const double E = space.problem.youngs_modulus, nu = space.problem.poissons_ratio;
  const double lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), mu = E / (2 * (1 + nu));
  std::array<Eigen::MatrixXd, dim> G;
  for (int d = 0; d < dim; ++d)
    G[d] = shapes.gradients(d);
  Eigen::MatrixXd laplace = G[0].transpose() * G[0];
  for (int d = 1; d < dim; ++d)
    laplace += G[d].transpose() * G[d];
  for (int a = 0; a < dim; ++a)
    for (int b = a; b < dim; ++b) {
      const Eigen::MatrixXd S = G[a].transpose() * G[b];
      for (unsigned int i = 0; i < shapes.n(); ++i)
        for (unsigned int j = 0; j < shapes.n(); ++j) {
          const double entry = lambda * S(i, j) + mu * S(j, i) + (a == b ? mu * laplace(i, j) : 0.0);
          const auto row = space.element.component_to_system_index(a, i),
                     column = space.element.component_to_system_index(b, j);
          K(row, column) = K(column, row) = entry;
        }
    }
}

template <int dim>
void add_body_force(const Space<dim>& space, const Shapes<dim>& shapes, dealii::Vector<double>& f) {
  const auto& at = shapes.at_points();
  for (unsigned int q = 0; q < at.n_quadrature_points; ++q) {
    const Vec3 force = space.problem.body_force(to_vec<dim>(at.quadrature_point(q))) * at.JxW(q);
    for (int d = 0; d < dim; ++d)
      for (unsigned int i = 0; i < shapes.n(); ++i)
        f[space.element.component_to_system_index(d, i)] += force[d] * at.shape_value(i, q);
  }
}

template <int dim>
void add_tractions(const Space<dim>& space, const dealii::FEFaceValues<dim>& at, const Claims& claims,
                   dealii::Vector<double>& f) {
  for (std::size_t t = 0; t < space.problem.tractions.size(); ++t)
    for (unsigned int q = 0; claims.tractions >> t & 1 && q < at.n_quadrature_points; ++q) {
      const Vec3 X = to_vec<dim>(at.quadrature_point(q)), normal = to_vec<dim>(at.normal_vector(q));
      const Vec3 force = space.problem.tractions[t].value(X, normal) * at.JxW(q);
      for (unsigned int i = 0; i < space.element.n_dofs_per_cell(); ++i)
        f[i] += force[space.element.system_to_component_index(i).first] * at.shape_value(i, q);
    }
}

} // namespace

template <int dim>
System<dim>::System(const Space<dim>& space) : f(space.dofs.n_dofs()) {
  using namespace dealii;
  DynamicSparsityPattern entries(space.dofs.n_dofs());
  DoFTools::make_sparsity_pattern(space.dofs, entries, space.constraints, false);
  pattern.copy_from(entries);
  K.reinit(pattern);
  Shapes<dim> shapes(space, update_values | update_gradients | update_quadrature_points);
  FEFaceValues<dim> faces(space.mapping, space.element, space.face_quadrature(),
                          update_values | update_JxW_values | update_quadrature_points | update_normal_vectors);
  const unsigned int n = space.element.n_dofs_per_cell();
  FullMatrix<double> cell_K(n, n);
  dealii::Vector<double> cell_f(n);
  std::vector<types::global_dof_index> indices(n);
  for (const auto& cell : space.dofs.active_cell_iterators()) {
    shapes.reinit(cell);
    add_stiffness(space, shapes, cell_K);
    cell_f = 0;
    if (space.problem.body_force)
      add_body_force(space, shapes, cell_f);
    for (const auto face : cell->face_indices())
      if (cell->at_boundary(face) && space.claims[cell->face(face)->boundary_id()].tractions != 0) {
        faces.reinit(cell, face);
        add_tractions(space, faces, space.claims[cell->face(face)->boundary_id()], cell_f);
      }
    cell->get_dof_indices(indices);
    space.constraints.distribute_local_to_global(cell_K, cell_f, indices, K, f);
  }
}

template <int dim>
void assemble_mass(const Space<dim>& space, const System<dim>& system, dealii::SparseMatrix<double>& M) {
  using namespace dealii;
  M.reinit(system.pattern);
  Shapes<dim> shapes(space, update_values);
  const unsigned int n = space.element.n_dofs_per_cell();
  FullMatrix<double> cell_M(n, n);
  std::vector<types::global_dof_index> indices(n);
  for (const auto& cell : space.dofs.active_cell_iterators()) {
    shapes.reinit(cell);
    const Eigen::MatrixXd N = shapes.values();
    const Eigen::MatrixXd m = space.problem.density * N.transpose() * N;
    for (int d = 0; d < dim; ++d)
      for (unsigned int i = 0; i < shapes.n(); ++i)
        for (unsigned int j = 0; j < shapes.n(); ++j)
          cell_M(space.element.component_to_system_index(d, i), space.element.component_to_system_index(d, j)) =
            m(i, j);
    cell->get_dof_indices(indices);
    space.constraints.distribute_local_to_global(cell_M, indices, M);
  }
  for (types::global_dof_index i = 0; i < space.dofs.n_dofs(); ++i)
    if (space.constraints.is_constrained(i))
      M.set(i, i, 0);
}

template struct System<2>;
template struct System<3>;
template void assemble_mass(const Space<2>&, const System<2>&, dealii::SparseMatrix<double>&);
template void assemble_mass(const Space<3>&, const System<3>&, dealii::SparseMatrix<double>&);

} // namespace kerf::reference
