#include "reference/motion.h"

#include "base/error.h"
#include "base/parallel.h"
#include "reference/space.h"

#include <deal.II/grid/grid_tools.h>
#include <deal.II/lac/sparse_direct.h>
#include <deal.II/numerics/vector_tools_interpolate.h>

namespace kerf::reference {

namespace {

using Vector = dealii::Vector<double>;

/// A displacement as a sum over unknowns.
struct Sample {
  struct Term {
    dealii::types::global_dof_index unknown;
    unsigned int axis;
    double weight;
  };
  std::vector<Term> terms;

  Vec3 of(const Vector& u) const {
    Vec3 sum = Vec3::Zero();
    for (const Term& term : terms)
      sum[term.axis] += term.weight * u[term.unknown];
    return sum;
  }
};

template <int dim>
Sample sample_at(const Space<dim>& space, const Vec3& X) {
  dealii::Point<dim> point;
  for (int d = 0; d < dim; ++d)
    point[d] = X[d];
  const auto [cell, place] = dealii::GridTools::find_active_cell_around_point(space.mapping, space.dofs, point);
  if (cell.state() != dealii::IteratorState::valid)
    throw DataError("a point that a reference motion is asked at lies outside of its body");
  std::vector<dealii::types::global_dof_index> unknowns(space.element.n_dofs_per_cell());
  cell->get_dof_indices(unknowns);
  Sample sample;
  for (unsigned int i = 0; i < unknowns.size(); ++i)
    sample.terms.push_back(
      {unknowns[i], space.element.system_to_component_index(i).first, space.element.shape_value(i, place)});
  return sample;
}

/// Chung and Hulbert's, as functions of the spectral radius.
struct Weights {
  explicit Weights(const double radius)
    : mass((2 * radius - 1) / (radius + 1)),
      force(radius / (radius + 1)),
      velocity(0.5 - mass + force),
      displacement(0.25 * (1 - mass + force) * (1 - mass + force)) {}
  double mass, force; ///< of the beginning of a step, in inertia and in all else
  double velocity, displacement;
};

/// Of all unknowns; what is constrained stands at 0, and constraints.distribute() gives it its value.
struct Moving {
  Vector u, v, a;
};

template <int dim>
class Motion {
 public:
  Motion(const Space<dim>& space, const TimeStepping& in_time)
    : space_(space), in_time_(in_time), weights_(in_time.spectral_radius), system_(space) {
    assemble_mass(space, system_, M_);
    for (dealii::types::global_dof_index i = 0; i < space.dofs.n_dofs(); ++i)
      if (space.constraints.is_constrained(i))
        M_.set(i, i, 1); // of an acceleration that is 0
    const double dt = in_time.time_step, b = weights_.displacement, g = weights_.velocity;
    dealii::SparseMatrix<double> A(system_.pattern);
    A.copy_from(M_);
    A *= 1 - weights_.mass + (1 - weights_.force) * g * dt * in_time.mass_damping;
    A.add((1 - weights_.force) * b * dt * dt, system_.K);
    keep_libraries_to_one_thread();
    inverse_.initialize(A);
  }

  Moving begin(const Beginning& beginning) const {
    Moving now{field(beginning.displacement), field(beginning.velocity), Vector(space_.dofs.n_dofs())};
    dealii::SparseDirectUMFPACK inverse;
    inverse.initialize(M_);
    inverse.vmult(now.a, out_of_balance(now.u, now.v));
    return now;
  }

  void step(Moving& now) const {
    const double dt = in_time_.time_step, b = weights_.displacement, g = weights_.velocity;
    Vector u = now.u, v = now.v; // without what the new acceleration brings
    u.add(dt, now.v, (0.5 - b) * dt * dt, now.a);
    v.add((1 - g) * dt, now.a);
    Vector middle_u = u, middle_v = v, left(u.size()), a(u.size());
    middle_u.sadd(1 - weights_.force, weights_.force, now.u);
    middle_v.sadd(1 - weights_.force, weights_.force, now.v);
    M_.vmult(left, now.a);
    Vector force = out_of_balance(middle_u, middle_v);
    force.add(-weights_.mass, left);
    space_.constraints.set_zero(force);
    inverse_.vmult(a, force);
    u.add(b * dt * dt, a);
    v.add(g * dt, a);
    now = {std::move(u), std::move(v), std::move(a)};
  }

 private:
  /// f - K u - c M v.
  Vector out_of_balance(const Vector& u, const Vector& v) const {
    Vector force(u.size()), damped(u.size());
    system_.K.residual(force, u, system_.f);
    M_.vmult(damped, v);
    force.add(-in_time_.mass_damping, damped);
    space_.constraints.set_zero(force);
    return force;
  }

  Vector field(const Field& of) const {
    Vector values(space_.dofs.n_dofs());
    if (of)
      dealii::VectorTools::interpolate(space_.mapping, space_.dofs, FieldFunction<dim>(of), values);
    space_.constraints.set_zero(values);
    return values;
  }

  const Space<dim>& space_;
  const TimeStepping in_time_;
  const Weights weights_;
  System<dim> system_;
  dealii::SparseMatrix<double> M_;
  dealii::SparseDirectUMFPACK inverse_;
};

template <int dim>
std::vector<Points> follow(const Problem& problem, const Discretisation& discretisation, const TimeStepping& in_time,
                           const Points& points, const Beginning& beginning) {
  Space<dim> space(problem, discretisation);
  adapt(space, discretisation);
  const Motion<dim> motion(space, in_time);
  std::vector<Sample> samples;
  for (const Vec3& X : points)
    samples.push_back(sample_at(space, X));
  Moving now = motion.begin(beginning);
  std::vector<Points> found;
  for (int step = 0;; ++step) {
    Vector u = now.u;
    space.constraints.distribute(u);
    Points& at_step = found.emplace_back();
    for (const Sample& sample : samples)
      at_step.push_back(sample.of(u));
    if (step == in_time.n_steps)
      return found;
    motion.step(now);
  }
}

void require_steps(const Problem& problem, const TimeStepping& in_time) {
  if (!(in_time.time_step > 0) || in_time.n_steps < 1 || !(in_time.mass_damping >= 0) ||
      !(in_time.spectral_radius >= 0 && in_time.spectral_radius <= 1))
    throw ParameterError("a reference motion needs steps > 0, damping >= 0 and a spectral radius in [0, 1]");
  for (const Support& support : problem.supports)
    if (support.displacement)
      throw ParameterError("the supports of a reference motion do not move");
}

} // namespace

std::vector<Points> motion(const Problem& problem, const Discretisation& discretisation, const TimeStepping& in_time,
                           const Points& points, const Beginning& beginning) {
  require_steps(problem, in_time);
  return problem.mesh.dimension == 2 ? follow<2>(problem, discretisation, in_time, points, beginning)
                                     : follow<3>(problem, discretisation, in_time, points, beginning);
}

} // namespace kerf::reference
