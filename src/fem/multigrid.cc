#include "fem/multigrid.h"

#include "base/function_ref.h"
#include "base/loan.h"
#include "base/parallel.h"
#include "fem/level.h"
#include "fem/level_elements.h"
#include "fem/turned.h"
#include "material/polar.h"

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace kerf::fem {

namespace {

constexpr std::size_t many_of_a_level = 8192; // corners from which on a second thread pays
constexpr std::size_t few = 48;     // corners that are factorised as they are

/// Blocks at coarse corners, of the sum of the fine ones.
Loan<Spring> restricted(const std::vector<Spring>& fine, const Coarsening& coarsening) {
  Loan<std::uint32_t> place(coarsening.coarse.n_corners, CellsOfLevel::unused);
  Loan<Spring> coarse;
  for (const Spring& spring : fine)
    coarsening.for_each_weight(spring.corner, [&](const std::uint32_t corner, const float weight) {
      std::uint32_t& p = place[corner];
      if (p == CellsOfLevel::unused) {
        p = static_cast<std::uint32_t>(coarse.size());
        coarse->push_back({corner, Mat3::Zero()});
      }
      coarse[p].block += double(weight) * spring.block;
    });
  return coarse;
}

/// What loads resist at points.
PointSprings point_springs(const dynamics::LinearEquation& equation) {
  PointSprings springs;
  equation.loads.for_each_point(
    [&](const std::uint32_t corner, const double weight) { springs.rows.add_entry(corner, float(weight)); },
    [&](const Mat3& block) {
      springs.rows.end_row();
      springs.blocks.push_back((block / equation.stiffness_factor).cast<float>());
    });
  return springs;
}

/// The largest absolute value.
double largest(const std::span<const double> values) {
  constexpr std::size_t block = 8192, worth_blocks = 3; // from which on a second thread pays
  Loan<double> parts((values.size() + block - 1) / block);
  parallel_for(
    parts.size(),
    [&](const std::size_t b) {
      const auto of_block = values.subspan(b * block, std::min(block, values.size() - b * block));
      double most[8] = {}; // eight at a time: comparisons do not wait for each other
      std::size_t i = 0;
      for (; i + 8 <= of_block.size(); i += 8)
        for (int k = 0; k < 8; ++k)
          most[k] = std::max(most[k], std::abs(of_block[i + k]));
      for (; i < of_block.size(); ++i)
        most[0] = std::max(most[0], std::abs(of_block[i]));
      parts[b] = *std::max_element(most, most + 8);
    },
    worth_blocks);
  return parts.empty() ? 0 : *std::ranges::max_element(*parts);
}

} // namespace

/// A factorisation of the coarsest level, shifted by what single precision does not see: a free body's motion is
/// singular.
struct Multigrid::Coarsest {
  explicit Coarsest(const material::Elastic& of) : material(of) {}

  material::Elastic material;
  Eigen::LLT<Eigen::MatrixXd> dense;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> sparse;

  void factorise(const Multigrid::Level& level, const CellsOfLevel& cells);
  void solve(Multigrid::Level& level, const Row<float>* b, Row<float>* x);
  Eigen::MatrixXd matrix;
  Eigen::VectorXd right, solution;

  static bool is_dense(const fem::Level& level) { return level.n_corners <= 2 * few; }
  /// What does not get coarser, like dust, is smoothed alone.
  static bool is_too_large(const fem::Level& level) { return level.n_corners > 8 * few; }
};

struct Multigrid::Level : fem::Level {
  // Of coarse levels.
  LevelElements made_of;
  std::vector<Mat3> rotations; // of each copy
};

namespace {

/// Adds a block for a pair of corners.
template <class Add>
void add_entries(const Level& level, const CellsOfLevel& cells, const FunctionRef<Matrix24(std::size_t copy)> matrix,
                 const Add& add) {
  for (std::size_t c = 0; c < cells.n_copies(); ++c) {
    if (!cells.is_used(c))
      continue;
    const std::uint32_t* const corners = cells.corners.data() + 8 * c;
    const Matrix24 K = matrix(c);
    for (int a = 0; a < 8; ++a)
      for (int b = 0; b < 8; ++b)
        add(corners[a], corners[b], Mat3(K.block<3, 3>(3 * a, 3 * b)));
  }
  constexpr double second_difference[3] = {1, -2, 1};
  for (const GhostLine& line : level.lines) {
    const std::uint32_t corners[3] = {line.a, line.b, line.c};
    for (int p = 0; p < 3; ++p)
      for (int q = 0; q < 3; ++q)
        add(corners[p], corners[q],
            Mat3(line.stiffness * second_difference[p] * second_difference[q] * Mat3::Identity()));
  }
  for (const Tie& tie : level.ties)
    for (const auto& [i, j] : {std::pair{tie.a, tie.b}, std::pair{tie.b, tie.a}}) {
      add(i, i, Mat3(tie.stiffness * Mat3::Identity()));
      add(i, j, Mat3(-tie.stiffness * Mat3::Identity()));
    }
  for (const Spring& spring : level.springs)
    add(spring.corner, spring.corner, spring.block);
  const auto& [rows, blocks] = level.points;
  for (std::size_t i = 0; i < blocks.size(); ++i)
    for (std::uint32_t k = rows.start[i]; k < rows.start[i + 1]; ++k)
      for (std::uint32_t l = rows.start[i]; l < rows.start[i + 1]; ++l)
        add(rows.columns[k], rows.columns[l],
            Mat3(double(rows.values[k]) * double(rows.values[l]) * blocks[i].cast<double>()));
  constexpr double unseen = 1e-5;
  for (std::uint32_t i = 0; i < level.n_corners; ++i) {
    const Row<float>& d = level.diagonal[2 * std::size_t(i)];
    const double size = d.x + d.y + d.z;
    add(i, i, Mat3((double(level.mass[i]) + (size > 0 ? unseen * size : 1)) * Mat3::Identity()));
  }
}

} // namespace

void Multigrid::Coarsest::factorise(const Multigrid::Level& level, const CellsOfLevel& cells) {
  if (is_too_large(level))
    return;
  const auto matrix = [&](const std::size_t c) {
    return turned_stiffness(stiffness(level.made_of[c], material), level.rotations[c]);
  };
  const auto n = static_cast<Eigen::Index>(3 * level.n_corners);
  if (is_dense(level)) {
    Eigen::MatrixXd& A = this->matrix;
    A.setZero(n, n);
    add_entries(level, cells, matrix, [&](const std::uint32_t i, const std::uint32_t j, const Mat3& block) {
      A.block<3, 3>(3 * i, 3 * j) += block;
    });
    dense.compute(A);
    return;
  }
  std::vector<Eigen::Triplet<double>> entries;
  add_entries(level, cells, matrix, [&](const std::uint32_t i, const std::uint32_t j, const Mat3& block) {
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        entries.emplace_back(3 * i + a, 3 * j + b, block(a, b));
  });
  Eigen::SparseMatrix<double> A(n, n);
  A.setFromTriplets(entries.begin(), entries.end());
  sparse.compute(A);
}

void Multigrid::Coarsest::solve(Multigrid::Level& level, const Row<float>* const b, Row<float>* const x) {
  if (is_too_large(level)) {
    level.smooth_from_zero(b, x);
    return;
  }
  right.resize(static_cast<Eigen::Index>(3 * level.n_corners));
  for (std::size_t i = 0; i < level.n_corners; ++i)
    right.segment<3>(3 * i) << b[i].x, b[i].y, b[i].z;
  Eigen::VectorXd& y = solution;
  if (is_dense(level))
    y = dense.solve(right);
  else
    y = sparse.solve(right);
  for (std::size_t i = 0; i < level.n_corners; ++i)
    x[i] = {float(y[3 * i]), float(y[3 * i + 1]), float(y[3 * i + 2])};
}

Multigrid::~Multigrid() = default;

std::size_t Multigrid::n_levels() const { return levels_.size(); }

namespace {

Coarsening coarsened_finest(const FinestLevel& finest, const FormerLevels& former) {
  if (former.coarse.empty() || !former.numbers_are_kept)
    return coarsened(finest.cells);
  std::vector<std::uint32_t> copies;
  for (std::uint32_t c = 0; c < former.same_copy.size(); ++c)
    if (former.same_copy[c] == CellsOfLevel::unused)
      copies.push_back(c);
  return coarsened(finest.cells, former.coarse[0].coarsening, {copies, former.corners, finest.incidence, finest.numbers});
}

/// A coarser level, of so many corners, where that is worth its while.
template <class Coarsened>
std::optional<Coarsening> worth_while(const std::size_t n_corners, const Coarsened& coarsened) {
  constexpr double stands_still = 0.7; // corners over those of the level before
  if (n_corners <= few)
    return {};
  Coarsening coarsening = coarsened();
  if (double(coarsening.coarse.n_corners) > stands_still * double(n_corners))
    return {};
  return coarsening;
}

} // namespace

Multigrid::Multigrid(FinestLevel finest, const FormerLevels& former) {
  levels_.emplace_back();
  Level& first = levels_[0];
  first.n_corners = finest.cells.n_corners;
  first.batching = finest.batching;
  first.elements = std::move(finest.elements);
  first.bound = finest.full.bound;
  std::optional<Coarsening> next;
  beside([&] { next = worth_while(finest.cells.n_corners, [&] { return coarsened_finest(finest, former); }); },
         [&] {
           first.lines = lines_of(finest.faces);
           first.ties.assign(finest.ties.begin(), finest.ties.end());
           first.resize();
         });
  while (next) { // which cells are coarser is found ahead of what they are made of
    levels_.back().to_coarse = std::move(*next);
    const CellsOfLevel& cells = levels_.back().to_coarse.coarse;
    Level coarse;
    beside([&] { next = worth_while(cells.n_corners, [&] { return coarsened(cells); }); },
           [&] { make(coarse, finest, former); });
    levels_.push_back(std::move(coarse));
  }
  coarsest_ = std::make_unique<Coarsest>(finest.material);
  std::vector<fem::Level*> levels;
  for (Level& level : levels_)
    levels.push_back(&level);
  cycle_ = std::make_unique<Cycle>(std::move(levels), [this](const Row<float>* const b, Row<float>* const x) {
    coarsest_->solve(levels_.back(), b, x);
  });
}

/// The level after those that there are.
void Multigrid::make(Level& coarse, const FinestLevel& finest, const FormerLevels& former) const {
  const std::size_t n = levels_.size();
  const Level& fine = levels_.back();
  const Coarsening& coarsening = fine.to_coarse;
  const LevelElements& of_fine = fine.made_of;
  const FineElements children =
    n == 1
      ? FineElements{finest.element, finest.kind, finest.full}
      : FineElements{[&](const std::uint32_t c) -> const Element& { return of_fine[c]; }, of_fine.kind, of_fine.full};
  const double h = std::ldexp(finest.h, static_cast<int>(n)); // of the coarse cubes
  if (former.coarse.size() >= n) {
    const auto& [before, elements] = former.coarse[n - 1];
    const CoarseBefore known{n == 1 ? former.same_copy : of_fine.same_as, before.parent, elements};
    coarse.made_of = coarse_elements(coarsening, children, h / 2, finest.material, &known);
  } else {
    coarse.made_of = coarse_elements(coarsening, children, h / 2, finest.material, nullptr);
  }
  coarse.lines = coarsened(fine.lines, n == 1 ? finest.cells : CellsView(cells_of(n - 1)), coarsening);
  coarse.ties = coarsened(fine.ties, coarsening);
  coarse.n_corners = coarsening.coarse.n_corners;
  constexpr std::size_t little = 4; // so few corners that twice the steps are half the work
  coarse.n_steps = little * coarse.n_corners <= fine.n_corners ? std::min(2 * fine.n_steps, fem::Level::most_steps)
                                                               : fine.n_steps;
  put_batches(h, finest.material, coarsening.coarse, coarse);
  coarse.resize();
}

const CellsOfLevel& Multigrid::cells_of(const std::size_t coarse) const { return levels_[coarse - 1].to_coarse.coarse; }

void Multigrid::put_batches(const double h, const material::Elastic& material, const CellsOfLevel& cells,
                            Level& coarse) {
  const LevelElements& elements = coarse.made_of;
  std::vector<std::uint32_t> order(cells.n_copies()), ends;
  std::iota(order.begin(), order.end(), 0);
  for (std::size_t end = 0; end < order.size();) {
    end = std::min(end + Batching::chunk_size, order.size());
    ends.push_back(static_cast<std::uint32_t>(end));
  }
  coarse.batching = std::make_shared<Batching>(
    CopiesInOrder{order, ends, elements.kind, cells.corners.data(), cells.n_corners});
  coarse.bound = elements.full.bound;
  coarse.elements =
    batched<float>(*coarse.batching, h, material, elements.full,
                   {[&](const std::uint32_t c) -> const Element& { return elements[c]; }, elements.full.bound});
}

FormerLevels Multigrid::give_way() {
  FormerLevels former;
  former.finest = std::move(levels_[0].elements);
  former.diagonal = lend_diagonal();
  former.same_copy.resize(levels_[0].to_coarse.parent.size());
  std::iota(former.same_copy.begin(), former.same_copy.end(), 0);
  for (std::size_t l = 1; l < levels_.size(); ++l)
    former.coarse.push_back({std::move(levels_[l - 1].to_coarse), std::move(levels_[l].made_of)});
  return former;
}

std::vector<Row<float>> Multigrid::lend_diagonal() { return std::move(levels_[0].inverse); }

void Multigrid::prepare(const dynamics::LinearEquation& equation, std::vector<Row<float>> diagonal) {
  stiffness_factor_ = equation.stiffness_factor;
  put_rotations();
  for (Level& level : levels_)
    if (&level == &levels_[0] && !diagonal.empty())
      level.make_diagonal(std::move(diagonal));
    else
      level.make_diagonal();
  put_masses(equation);
  hold(equation);
  coarsest_->factorise(levels_.back(), levels_.size() > 1 ? cells_of(levels_.size() - 1) : CellsOfLevel());
  for (Level& level : levels_)
    level.invert_diagonal([&](const std::uint32_t corner, const Mat3& block) { // of the finest one
      const Mat3 S = dynamics::inverse_factor(block, equation.constraints.freedom(corner));
      return Mat3(S.transpose() * S);
    });
}

/// Of the coarse elements.
void Multigrid::put_rotations() {
  for (std::size_t l = 1; l < levels_.size(); ++l) {
    put_coarse_rotations(l);
    Level& level = levels_[l];
    std::vector<Lanes9>& rotations = *level.elements.shared.rotations;
    level.batching->for_each([&](const std::size_t i) {
      for (std::size_t lane = 0; lane < n_lanes; ++lane)
        if (const std::uint32_t c = level.batching->batches()[i].copies[lane]; c != BatchOfCopies::none)
          for (int k = 0; k < 9; ++k)
            rotations[i].row[k][lane] = static_cast<float>(level.rotations[c].data()[k]);
    });
  }
}

/// The rotations of means over children by volume.
void Multigrid::put_coarse_rotations(const std::size_t l) {
  const Level& fine = levels_[l - 1];
  Level& coarse = levels_[l];
  const Loan<Mat3> sums = l == 1 ? sums_of_finest_rotations() : Loan<Mat3>::none();
  const auto sum_of_children = [&](const std::size_t c) {
    Mat3 sum = Mat3::Zero();
    for (const std::uint32_t child : fine.to_coarse.children.of(c))
      sum += fine.made_of[child].volume * fine.rotations[child];
    return sum;
  };
  coarse.rotations.resize(cells_of(l).n_copies());
  parallel_for(
    coarse.rotations.size(),
    [&](const std::size_t c) {
      const Mat3 sum = l == 1 ? sums[c] : sum_of_children(c);
      const double all = coarse.made_of[c].volume;
      coarse.rotations[c] = all > 0 ? material::rotation_of(sum / all) : Mat3(Mat3::Identity());
    },
    256);
}

/// By parent, times volumes. Copies that have one parent lie in one coarse cube, whose cells share a node.
Loan<Mat3> Multigrid::sums_of_finest_rotations() const {
  const Level& fine = levels_[0];
  const BatchedElements<float>& elements = fine.elements;
  Loan<Mat3> sums(cells_of(1).n_copies(), Mat3::Zero());
  const std::vector<Lanes9>& rotations = *elements.shared.rotations;
  fine.batching->for_each_in_order([&](const std::size_t i) {
    const BatchOfCopies& batch = fine.batching->batches()[i];
    for (std::size_t lane = 0; lane < batch.n_used; ++lane) {
      const double volume = batch.partial == BatchOfCopies::none ? elements.cube.volume
                                                                 : elements.partial[batch.partial].volume[lane];
      Mat3& sum = sums[fine.to_coarse.parent[batch.copies[lane]]];
      for (int k = 0; k < 9; ++k)
        sum.data()[k] += volume * rotations[i].row[k][lane];
    }
  });
  return sums;
}

void Multigrid::put_masses(const dynamics::LinearEquation& equation) {
  const double factor = equation.mass_factor / equation.stiffness_factor;
  Level& finest = levels_[0];
  parallel_for(
    finest.n_corners, [&](const std::size_t i) { finest.mass[i] = float(factor * equation.mass[i]); }, many_of_a_level);
  for (std::size_t l = 0; l + 1 < levels_.size(); ++l) {
    const Coarsening& coarsening = levels_[l].to_coarse;
    std::vector<float>& coarse = levels_[l + 1].mass;
    std::ranges::fill(coarse, 0);
    levels_[l + 1].for_each_copy_in_order([&](const std::uint32_t copy) {
      const std::uint32_t* const corners = coarsening.coarse.corners.data() + 8 * std::size_t(copy);
      coarsening.for_each_corner(copy, [&](const std::uint32_t corner, const VertexWeights& weights) {
        for (std::uint32_t k = 0; k < weights.n; ++k)
          coarse[corners[weights.vertex[k]]] += weights.weight[k] * levels_[l].mass[corner];
      });
    });
  }
}

void Multigrid::hold(const dynamics::LinearEquation& equation) {
  Level& finest = levels_[0];
  finest.springs.clear();
  finest.held.clear();
  if (!finest.points.empty() || !equation.loads.empty())
    finest.points = point_springs(equation);
  Loan<Mat3> pairs; // of points that loads join
  if (!equation.loads.empty()) {
    pairs->assign(finest.n_corners, Mat3::Zero());
    equation.loads.add_bound_of_pairs(pairs);
  }
  Loan<Spring> springs; // for the coarse levels
  for (std::uint32_t i = 0; i < finest.n_corners; ++i) {
    Mat3 coarse = Mat3::Zero();
    if (!pairs.empty() && pairs[i].cwiseAbs().maxCoeff() > 0) {
      coarse = pairs[i] / equation.stiffness_factor;
      finest.springs.push_back({i, coarse});
    }
    if (!equation.constraints.is_free(i)) {
      const Mat3& free = equation.constraints.freedom(i).project;
      const Row<float>& d = finest.diagonal[2 * std::size_t(i)];
      coarse += double(d.x + d.y + d.z) / 3 * (Mat3::Identity() - free);
      finest.held.push_back({i, free});
    }
    if (coarse.cwiseAbs().maxCoeff() > 0)
      springs->push_back({i, coarse});
  }
  for (std::size_t l = 1; l < levels_.size(); ++l) {
    springs = restricted(springs, levels_[l - 1].to_coarse);
    levels_[l].springs = *springs;
    if (!levels_[l].points.empty() || !finest.points.empty())
      levels_[l].points = coarsened(levels_[l - 1].points, levels_[l - 1].to_coarse);
  }
}

void Multigrid::apply(const std::span<const double> r, const std::span<double> z) {
  const std::size_t n = levels_[0].n_corners;
  const double most = largest(r);
  const double scale = most > 0 ? most : 1; // single precision has a short range
  Row<float>* const b = cycle_->right_side();
  parallel_for(
    n,
    [&](const std::size_t i) {
      b[i] = {float(r[3 * i] / scale), float(r[3 * i + 1] / scale), float(r[3 * i + 2] / scale)};
    },
    many_of_a_level);
  levels_[0].project(b);
  const Row<float>* const x = cycle_->solve();
  const double back = scale / stiffness_factor_;
  parallel_for(
    n,
    [&](const std::size_t i) {
      z[3 * i] = back * x[i].x;
      z[3 * i + 1] = back * x[i].y;
      z[3 * i + 2] = back * x[i].z;
    },
    many_of_a_level);
}

} // namespace kerf::fem
