#include "fem/cycle.h"

#include "base/parallel.h"
#include "fem/level.h"
#include "fem/row_of_floats.h"

#include <deal.II/lac/la_parallel_vector.h>
#include <deal.II/multigrid/mg_base.h>
#include <deal.II/multigrid/multigrid.h>

namespace kerf::fem {

namespace {

using Vector = dealii::LinearAlgebra::distributed::Vector<float>;

Row<float>* rows(Vector& v) { return reinterpret_cast<Row<float>*>(v.begin()); }
const Row<float>* rows(const Vector& v) { return reinterpret_cast<const Row<float>*>(v.begin()); }

/// deal.II counts levels from the coarsest.
struct Levels {
  std::vector<Level*> finest_first;

  unsigned finest() const { return static_cast<unsigned>(finest_first.size() - 1); }
  Level& operator[](const unsigned level) const { return *finest_first[finest() - level]; }
};

class Operator : public dealii::MGMatrixBase<Vector> {
 public:
  explicit Operator(const Levels& levels) : levels_(levels) {}

  void vmult(const unsigned level, Vector& y, const Vector& x) const override {
    levels_[level].multiply(rows(x), rows(y));
  }
  void vmult_add(const unsigned level, Vector& y, const Vector& x) const override {
    Vector product(y);
    vmult(level, product, x);
    y += product;
  }
  void Tvmult(const unsigned level, Vector& y, const Vector& x) const override { vmult(level, y, x); }
  void Tvmult_add(const unsigned level, Vector& y, const Vector& x) const override { vmult_add(level, y, x); }
  unsigned int get_minlevel() const override { return 0; }
  unsigned int get_maxlevel() const override { return levels_.finest(); }

 private:
  const Levels& levels_;
};

class Smoother : public dealii::MGSmootherBase<Vector> {
 public:
  explicit Smoother(const Levels& levels) : levels_(levels) {}

  void clear() override {}
  void smooth(const unsigned level, Vector& x, const Vector& b) const override {
    levels_[level].smooth(rows(b), rows(x));
  }
  void apply(const unsigned level, Vector& x, const Vector& b) const override {
    levels_[level].smooth_from_zero(rows(b), rows(x));
  }

 private:
  const Levels& levels_;
};

class Transfer : public dealii::MGTransferBase<Vector> {
 public:
  explicit Transfer(const Levels& levels) : levels_(levels) {}

  void prolongate(const unsigned to, Vector& fine, const Vector& coarse) const override {
    fine = 0;
    prolongate_and_add(to, fine, coarse);
  }
  void prolongate_and_add(const unsigned to, Vector& fine, const Vector& coarse) const override {
    const Coarsening& coarsening = levels_[to].to_coarse;
    const Row<float>* const from = rows(coarse);
    Row<float>* const sums = rows(fine);
    levels_[to - 1].for_each_copy([&](const std::uint32_t copy) {
      Four of_copy[8];
      for (int v = 0; v < 8; ++v)
        of_copy[v] = load(from[coarsening.coarse.corners[8 * std::size_t(copy) + v]]);
      coarsening.for_each_corner(copy, [&](const std::uint32_t corner, const VertexWeights& weights) {
        Four sum = {};
        for (std::uint32_t k = 0; k < weights.n; ++k)
          sum += weights.weight[k] * of_copy[weights.vertex[k]];
        add(sums[corner], sum);
      });
    });
    levels_[to].project(sums);
  }
  void restrict_and_add(const unsigned from, Vector& coarse, const Vector& fine) const override {
    const Coarsening& coarsening = levels_[from].to_coarse;
    const Row<float>* const values = rows(fine);
    Row<float>* const sums = rows(coarse);
    levels_[from - 1].for_each_copy_in_order([&](const std::uint32_t copy) {
      Four of_copy[8] = {};
      coarsening.for_each_corner(copy, [&](const std::uint32_t corner, const VertexWeights& weights) {
        const Four value = load(values[corner]);
        for (std::uint32_t k = 0; k < weights.n; ++k)
          of_copy[weights.vertex[k]] += weights.weight[k] * value;
      });
      for (int v = 0; v < 8; ++v)
        add(sums[coarsening.coarse.corners[8 * std::size_t(copy) + v]], of_copy[v]);
    });
  }

 private:
  const Levels& levels_;
};

class Coarsest : public dealii::MGCoarseGridBase<Vector> {
 public:
  explicit Coarsest(Cycle::Solve solve) : solve_(std::move(solve)) {}

  void operator()(unsigned, Vector& x, const Vector& b) const override { solve_(rows(b), rows(x)); }

 private:
  Cycle::Solve solve_;
};

} // namespace

struct Cycle::InDealII {
  Levels levels;
  Operator A;
  Smoother smoother;
  Transfer transfer;
  Coarsest coarsest;
  dealii::Multigrid<Vector> multigrid;

  InDealII(std::vector<Level*> finest_first, Solve solve)
    : levels{std::move(finest_first)},
      A(levels),
      smoother(levels),
      transfer(levels),
      coarsest(std::move(solve)),
      multigrid(A, coarsest, transfer, smoother, smoother, 0, levels.finest(), dealii::Multigrid<Vector>::v_cycle) {
    for (unsigned level = 0; level <= levels.finest(); ++level)
      multigrid.defect[level].reinit(static_cast<dealii::types::global_dof_index>(4 * levels[level].n_rows()));
  }
};

Cycle::Cycle(std::vector<Level*> levels, Solve solve)
  : in_dealii_(std::make_unique<InDealII>(std::move(levels), std::move(solve))) {}

Cycle::~Cycle() = default;

Row<float>* Cycle::right_side() { return rows(in_dealii_->multigrid.defect[in_dealii_->levels.finest()]); }

const Row<float>* Cycle::solve() {
  const unsigned finest = in_dealii_->levels.finest();
  for (unsigned level = 0; level < finest; ++level)
    in_dealii_->multigrid.defect[level] = 0; // restriction adds to it
  in_dealii_->multigrid.cycle();
  return rows(in_dealii_->multigrid.solution[finest]);
}

} // namespace kerf::fem
