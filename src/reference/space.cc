#include "reference/space.h"

#include "base/error.h"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/grid/grid_tools.h>
#include <deal.II/grid/manifold_lib.h>
#include <deal.II/numerics/vector_tools_boundary.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace kerf::reference {

namespace {

constexpr dealii::types::manifold_id round_id = 1, blended_id = 2;

/// Whether all vertices of a cell, face or line are as far from the z axis.
template <class Object>
bool is_on_circle(const Object& object) {
  const auto radius = [&](const unsigned int v) { return std::hypot(object->vertex(v)[0], object->vertex(v)[1]); };
  for (unsigned int v = 1; v < object->n_vertices(); ++v)
    if (std::abs(radius(v) - radius(0)) > 1e-9 * radius(0))
      return false;
  return true;
}

/// Arcs win over what lies between them.
template <int dim>
void set_round_sides(dealii::Triangulation<dim>& triangulation) {
  for (const auto& cell : triangulation.active_cell_iterators())
    if (cell->manifold_id() == blended_id) {
      for (const auto& face : cell->face_iterators())
        if (is_on_circle(face))
          face->set_all_manifold_ids(round_id);
      if constexpr (dim == 3)
        for (unsigned int l = 0; l < cell->n_lines(); ++l)
          if (is_on_circle(cell->line(l)))
            cell->line(l)->set_manifold_id(round_id);
    }
  for (const auto& cell : triangulation.active_cell_iterators())
    if (cell->manifold_id() == round_id)
      cell->set_all_manifold_ids(round_id);
}

template <int dim>
void curve(dealii::Triangulation<dim>& triangulation, const Mesh& mesh) {
  const auto has = [&](const Sides sides) {
    return std::find(mesh.sides.begin(), mesh.sides.end(), sides) != mesh.sides.end();
  };
  if (!has(Sides::round) && !has(Sides::blended))
    return;
  for (const auto& cell : triangulation.active_cell_iterators())
    if (mesh.sides[cell->index()] == Sides::blended)
      cell->set_all_manifold_ids(blended_id);
    else if (mesh.sides[cell->index()] == Sides::round)
      cell->set_manifold_id(round_id);
  set_round_sides(triangulation);
  if constexpr (dim == 3)
    triangulation.set_manifold(round_id, dealii::CylindricalManifold<3>(2));
  else
    triangulation.set_manifold(round_id, dealii::PolarManifold<2>());
  if (has(Sides::blended)) {
    dealii::TransfiniteInterpolationManifold<dim> blended;
    try {
      blended.initialize(triangulation);
    } catch (const dealii::ExceptionBase&) {
      throw ParameterError("cells of the reference problem are too thin to be curved");
    }
    triangulation.set_manifold(blended_id, blended);
  }
}

template <int dim>
void create(dealii::Triangulation<dim>& triangulation, const Mesh& mesh) {
  std::vector<dealii::Point<dim>> vertices(mesh.vertices.size());
  for (std::size_t v = 0; v < vertices.size(); ++v)
    for (int d = 0; d < dim; ++d)
      vertices[v][d] = mesh.vertices[v][d];
  std::vector<dealii::CellData<dim>> cells(mesh.cells.size());
  for (std::size_t c = 0; c < cells.size(); ++c)
    std::copy_n(mesh.cells[c].begin(), cells[c].vertices.size(), cells[c].vertices.begin());
  triangulation.create_triangulation(vertices, cells, dealii::SubCellData());
  curve(triangulation, mesh);
}

/// Bit i: the i-th of them is at X.
template <class Conditions>
std::uint64_t claimed(const Conditions& conditions, const Vec3& X) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < conditions.size(); ++i)
    if (conditions[i].where(X))
      bits |= std::uint64_t(1) << i;
  return bits;
}

/// A boundary id for each combination of supports and tractions that the faces of the coarse mesh meet.
template <int dim>
std::vector<Claims> claim(dealii::Triangulation<dim>& triangulation, const Problem& problem) {
  std::vector<Claims> all;
  for (const auto& cell : triangulation.active_cell_iterators())
    for (const auto& face : cell->face_iterators())
      if (face->at_boundary()) {
        const Vec3 X = to_vec<dim>(face->center());
        const Claims claims{claimed(problem.supports, X), claimed(problem.tractions, X)};
        const auto at = std::find(all.begin(), all.end(), claims);
        face->set_boundary_id(static_cast<dealii::types::boundary_id>(at - all.begin()));
        if (at == all.end())
          all.push_back(claims);
      }
  return all;
}

void require_met(const std::vector<Claims>& claims, const Problem& problem) {
  Claims met;
  for (const Claims& one : claims)
    met = {met.supports | one.supports, met.tractions | one.tractions};
  const auto all = [](const std::size_t n) { return (std::uint64_t(1) << n) - 1; };
  if (met.supports != all(problem.supports.size()) || met.tractions != all(problem.tractions.size()))
    throw ParameterError("a support or traction of the reference problem meets no face of its mesh");
}

/// The unknowns of the vertex that is nearest to X.
template <int dim>
std::array<dealii::types::global_dof_index, dim> unknowns_at(const dealii::DoFHandler<dim>& dofs, const Vec3& X) {
  std::array<dealii::types::global_dof_index, dim> unknowns{};
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& cell : dofs.active_cell_iterators())
    for (const auto v : cell->vertex_indices())
      if (const double distance = (to_vec<dim>(cell->vertex(v)) - X).norm(); distance < nearest) {
        nearest = distance;
        for (int d = 0; d < dim; ++d)
          unknowns[d] = cell->vertex_dof_index(v, d);
      }
  return unknowns;
}

const Problem& checked(const Problem& problem, const Discretisation& discretisation) {
  if (discretisation.degree < 1 || discretisation.degree > 4)
    throw ParameterError("reference elements have a degree from 1 to 4, not " + std::to_string(discretisation.degree));
  if (!(problem.youngs_modulus > 0) || !(problem.poissons_ratio > -1 && problem.poissons_ratio < 0.5))
    throw ParameterError("a reference solution needs Young's modulus > 0 and Poisson's ratio > -1 and < 0.5");
  return problem;
}

} // namespace

template <int dim>
Space<dim>::Space(const Problem& of, const Discretisation& discretisation)
  : problem(checked(of, discretisation)),
    element(dealii::FE_Q<dim>(static_cast<unsigned int>(discretisation.degree)), dim),
    mapping(static_cast<unsigned int>(discretisation.degree)),
    dofs(triangulation) {
  create(triangulation, problem.mesh);
  claims = claim(triangulation, problem);
  require_met(claims, problem);
  triangulation.refine_global(static_cast<unsigned int>(discretisation.n_refinements));
  distribute();
}

template <int dim>
void Space<dim>::distribute() {
  dofs.distribute_dofs(element);
  constraints.clear();
  dealii::DoFTools::make_hanging_node_constraints(dofs, constraints);
  for (std::size_t i = 0; i < problem.supports.size(); ++i) {
    const Support& support = problem.supports[i];
    dealii::ComponentMask mask(dim, false);
    for (unsigned int d = 0; d < dim; ++d)
      mask.set(d, support.held[d]);
    const FieldFunction<dim> displacement(support.displacement);
    for (std::size_t id = 0; id < claims.size(); ++id)
      if (claims[id].supports >> i & 1)
        dealii::VectorTools::interpolate_boundary_values(mapping, dofs, static_cast<dealii::types::boundary_id>(id),
                                                         displacement, constraints, mask);
  }
  for (const Pin& pin : problem.pins) {
    const auto unknowns = unknowns_at(dofs, pin.at);
    for (int d = 0; d < dim; ++d)
      if (pin.held[d] && !constraints.is_constrained(unknowns[d]))
        constraints.add_line(unknowns[d]);
  }
  constraints.close();
}

template <int dim>
dealii::Quadrature<dim> Space<dim>::quadrature() const {
  return dealii::QGauss<dim>(element.degree + 1);
}

template <int dim>
dealii::Quadrature<dim - 1> Space<dim>::face_quadrature() const {
  return dealii::QGauss<dim - 1>(element.degree + 1);
}

template struct Space<2>;
template struct Space<3>;

} // namespace kerf::reference
