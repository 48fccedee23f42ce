#include "fem/hexahedra.h"

#include "base/loan.h"
#include "base/parallel.h"
#include "base/sort_unique.h"
#include "dynamics/state.h"
#include "fem/dilatation.h"
#include "fem/two_rows.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

namespace kerf::fem {

namespace {

Frame frame_of(const material::AnyLaw& law) {
  return std::holds_alternative<material::SmallStrain>(law) ? Frame::fixed : Frame::turning;
}

ElementTableOptions table_options(const HexahedraOptions& options) {
  return {options.material, options.boundary, {options.strain}};
}

} // namespace

Hexahedra::Hexahedra(const grid::Solid& solid, const HexahedraOptions& options)
  : h_(solid.grid.h()),
    law_(material::law_of(options.material)),
    frame_(frame_of(law_)),
    inertia_(options.inertia),
    material_(options.material),
    elements_(solid, table_options(options)),
    incidence_(solid),
    counted_(options.counted),
    ghost_penalty_(options.ghost_penalty, options.material, h_) {
  if (options.mass == MassMatrix::consistent)
    consistent_mass_ = std::make_unique<ConsistentMass>(elements_, incidence_, numbers_, options.material.density, h_);
  std::vector<std::uint32_t> corners(solid.complex.n_corners());
  std::iota(corners.begin(), corners.end(), 0);
  std::vector<grid::CopyId> copies;
  copies.reserve(solid.complex.n_copies());
  for (const auto c : ids<grid::CopyId>(solid.complex.n_copies()))
    copies.push_back(c);
  follow(solid, copies, corners);
  Points rest;
  numbers_.gather(grid::rest_positions(solid), rest);
  linearise(rest);
}

void Hexahedra::update(const grid::Solid& solid, const std::span<const grid::CopyId> changed) {
  elements_.update(solid, changed);
  follow(solid, changed, incidence_.update(solid, changed));
}

void Hexahedra::follow(const grid::Solid& solid, const std::span<const grid::CopyId> changed,
                       const std::span<const std::uint32_t> corners) {
  if (multigrid_) {
    former_levels_ = multigrid_->give_way();
    multigrid_ = nullptr;
    if (shares_diagonal())
      diagonal_ = std::move(former_levels_.diagonal);
  }
  of_diagonal_ = OfDiagonal::unwanted;
  const grid::CornerNumbers before = std::exchange(numbers_, grid::CornerNumbers(solid, counted_));
  const auto numbers_of_same = numbers_.extend(before) ? CornersOfSame::kept : CornersOfSame::renumbered;
  std::vector<std::uint32_t> touched; // by number
  for (const std::uint32_t corner : corners)
    if (numbers_.counts(corner))
      touched.push_back(numbers_[corner]);
  if (!former_levels_.coarse.empty()) {
    former_levels_.same_copy.resize(solid.complex.n_copies(), CellsOfLevel::unused);
    for (const grid::CopyId c : changed)
      former_levels_.same_copy[c.value] = CellsOfLevel::unused;
    former_levels_.corners.insert(former_levels_.corners.end(), touched.begin(), touched.end());
    former_levels_.numbers_are_kept &= numbers_of_same == CornersOfSame::kept;
  }
  beside(
    [&] {
      ChangeOfBatches change = batch(solid, changed, numbers_of_same);
      if (numbers_of_same == CornersOfSame::kept)
        known_.follow(std::move(change), *batching_, incidence_, numbers_, touched);
      else
        known_.forget();
    },
    [&] { follow_masses_and_penalties(solid, changed, corners); });
  if (!numbers_.are_all())
    count();
}

void Hexahedra::follow_masses_and_penalties(const grid::Solid& solid, const std::span<const grid::CopyId> changed,
                                            const std::span<const std::uint32_t> corners) {
  sum_mass(corners);
  ghost_penalty_.update( // to which a crumb's copies are as good as full
    solid, changed, [this](const std::size_t copy) { return incidence_.is_used(copy) ? fill(copy) : 1; }, mass_);
  if (inertia_ == Inertia::gathered)
    gathered_ = gathered_mass(solid, mass_, material_.density * h_ * h_ * h_);
  if (inertia_ == Inertia::extended)
    share_mass(solid);
  ties_ = ties(solid);
  if (consistent_mass_)
    consistent_mass_->update(solid, changed, mass_, mass_by_corner());
}

/// Enough for a corner is four times an even share of the copies that are tied: an element's stiffness is no larger, in
/// proportion to its material, than a few times that of a cube.
void Hexahedra::share_mass(const grid::Solid& solid) {
  tied_mass_.clear();
  if (solid.complex.tied.empty())
    return;
  std::vector<grid::CopyId> tied;
  for (const auto& [c, d] : solid.complex.tied)
    tied.insert(tied.end(), {c, d});
  sort_unique(tied);
  std::map<grid::CornerId, double> enough;
  for (const grid::CopyId c : tied)
    for (const grid::CornerId corner : solid.complex.copies[c].corners)
      enough[corner] += 0.5 * material_.density * elements_[c.value].volume;
  tied_mass_ = ghost_penalty_.extended_mass();
  grid::share_mass(
    grid::ties(solid), [&](const grid::CornerId c) { return enough.at(c); }, tied_mass_);
}

Ties Hexahedra::ties(const grid::Solid& solid) const {
  Ties ties;
  const std::span<const double> mass = mass_by_corner();
  ties.update(solid, material_, inertia_ == Inertia::extended ? mass : std::span<const double>());
  return ties;
}

void Hexahedra::count() {
  ghost_penalty_.count_by(numbers_);
  ties_.count_by(numbers_);
  numbers_.gather(mass_by_corner(), mass_by_number_);
  for (dynamics::Follower& follower : gathered_.followers) {
    follower.corner = numbers_[follower.corner];
    for (std::uint32_t k = 0; k < follower.n_leaders; ++k)
      follower.leaders[k] = numbers_[follower.leaders[k]];
  }
}

namespace {

Batching batching_of(const grid::Grid& grid, const CellsInChunks& chunks) {
  std::vector<std::uint32_t> nodes;
  nodes.reserve(8 * chunks.cells.size());
  for (const grid::CellId cell : chunks.cells)
    for (const grid::NodeId node : grid.nodes(cell))
      nodes.push_back(node.value);
  return Batching(order_of_chunks(chunks.ends, nodes, grid.n_nodes()));
}

} // namespace

ChangeOfBatches Hexahedra::batch(const grid::Solid& solid, const std::span<const grid::CopyId> changed,
                                 const CornersOfSame corners) {
  grow(places_, n_elements());
  grow(kinds_, n_elements());
  std::vector<std::uint8_t> is_same(n_elements(), 1);
  for (const grid::CopyId c : changed) {
    is_same[c.value] = 0;
    places_[c.value] = solid.grid.index(solid.grid.nodes(solid.complex.copies[c].cell)[0]);
    kinds_[c.value] = !incidence_.is_used(c.value) ? Kind::unused
                      : elements_.is_full(c.value) ? Kind::full
                                                   : Kind::partial;
  }
  const bool is_new = batching_ == nullptr;
  if (is_new) {
    chunks_ = in_chunks(solid.grid);
    batching_ = std::make_shared<Batching>(batching_of(solid.grid, chunks_));
  }
  const std::size_t n_chunks = chunks_.ends.size();
  std::vector<std::uint8_t> is_met(n_chunks, corners == CornersOfSame::renumbered ? 1 : 0);
  for (const grid::CopyId c : changed)
    is_met[chunks_.chunk_of[solid.complex.copies[c].cell.value]] = 1;
  std::vector<std::uint32_t> order, chunk_ends; // of chunks that are met
  for (std::size_t k = 0; k < n_chunks; ++k) {
    for (std::size_t i = k == 0 ? 0 : chunks_.ends[k - 1]; i < chunks_.ends[k] && is_met[k] != 0; ++i)
      for (const grid::CopyId c : solid.complex.copies_of(chunks_.cells[i]))
        order.push_back(c.value);
    chunk_ends.push_back(static_cast<std::uint32_t>(order.size()));
  }
  numbers_of_copies_.clear();
  if (!numbers_.are_all()) {
    numbers_of_copies_.reserve(8 * n_elements());
    for (std::size_t copy = 0; copy < n_elements(); ++copy)
      for (int a = 0; a < 8; ++a)
        numbers_of_copies_.push_back(incidence_.is_used(copy) ? numbers_[incidence_.corners(copy)[a]]
                                                              : CellsOfLevel::unused);
  }
  ChangeOfBatches change =
    batching_->update({order, chunk_ends, kinds_, corner_numbers(0), numbers_.size()}, is_same, is_met, corners);
  if (is_new) {
    batched_ = batched<double>(*batching_, h_, material_, elements_.full(), partial_elements());
    return change;
  }
  fem::follow(*batching_, change.renewed, partial_elements(), batched_);
  if (!former_levels_.coarse.empty())
    fem::follow(*batching_, change.renewed, weighed_partial_elements(), former_levels_.finest);
  return change;
}

PartialElements Hexahedra::partial_elements() const {
  return {[this](const std::uint32_t copy) -> const Element& { return elements_[copy]; }};
}
PartialElements Hexahedra::weighed_partial_elements() const {
  PartialElements partial = partial_elements();
  partial.bound = elements_.full().bound;
  partial.in_diagonal = shares_diagonal() ? InDiagonal::excess : InDiagonal::all;
  return partial;
}

void Hexahedra::sum_mass(const std::span<const std::uint32_t> corners) {
  grow(mass_, incidence_.n_corners());
  for (const auto corner : corners) {
    mass_[corner] = 0;
    for (const auto user : incidence_.users(corner))
      mass_[corner] += elements_[user / 8].mass[user % 8];
  }
}

double Hexahedra::volume() const {
  double sum = 0;
  for (std::size_t e = 0; e < n_elements(); ++e)
    sum += incidence_.is_used(e) ? elements_[e].volume : 0;
  return sum;
}

void Hexahedra::apply_stiffness(const std::span<const double> p, const std::span<double> y) const {
  const TwoRows lent(batching_->n_rows());
  put_rows(p, batching_->n_rows(), lent.first, lent.second);
  add_product(*batching_, batched_, lent.first, lent.second);
  write(lent.second, y);
  ghost_penalty_.add_product(p, y);
  ties_.add_product(p, y);
}

void Hexahedra::stiffness_diagonal(const PutBlock put) const {
  Loan<double> penalty = ghost_penalty_.diagonal(numbers_.size());
  ties_.add_diagonal(penalty);
  const TwoRows lent(batching_->n_rows());
  Row<double>* const sums = lent.first;
  find_diagonal(sums);
  if (of_diagonal_ == OfDiagonal::wanted)
    keep_diagonal(sums);
  parallel_for(
    numbers_.size(),
    [&](const std::size_t i) {
      const Row<double>&d = sums[2 * i], &s = sums[2 * i + 1];
      Mat3 block;
      block << d.x + penalty[i], s.x, s.z, s.x, d.y + penalty[i], s.y, s.z, s.y, d.z + penalty[i];
      put(i, block);
    },
    many_corners_of_copies);
}

void Hexahedra::find_diagonal(Row<double>* const blocks) const {
  parallel_for(
    2 * batching_->n_rows(), [&](const std::size_t i) { blocks[i] = {}; }, many_corners_of_copies);
  add_diagonal(*batching_, batched_, blocks);
}

void Hexahedra::keep_diagonal(const Row<double>* const blocks) const {
  diagonal_.resize(2 * batching_->n_rows());
  parallel_for(
    diagonal_.size(),
    [&](const std::size_t i) {
      diagonal_[i] = {float(blocks[i].x), float(blocks[i].y), float(blocks[i].z)};
    },
    many_corners_of_copies);
  of_diagonal_ = OfDiagonal::there;
}

material::Elastic Hexahedra::material_of_multigrid() const {
  return leaves_out_dilatation_ ? without_excess(material_, elements_.strain()).value() : material_;
}

void Hexahedra::make_multigrid() {
  const material::Elastic material = material_of_multigrid();
  multigrid_ = std::make_unique<Multigrid>(
    FinestLevel{{places_, {corner_numbers(0), 8 * n_elements()}, numbers_.size()},
                h_,
                material,
                elements_.full(),
                kinds_,
                [this](const std::uint32_t copy) -> const Element& { return elements_[copy]; },
                batching_,
                former_levels_.coarse.empty() ? batched<float>(*batching_, h_, material, elements_.full(),
                                                               weighed_partial_elements(), batched_.shared)
                                              : std::move(former_levels_.finest),
                ghost_penalty_.faces(),
                ties_.all(),
                incidence_,
                numbers_},
    former_levels_);
  former_levels_ = {};
}

dynamics::Preconditioner* Hexahedra::preconditioner(const dynamics::LinearEquation& equation) {
  constexpr std::size_t worth_levels = 200; // corners
  constexpr double stiff = 8;               // K over M from which on conjugate gradients alone take longer
  if (numbers_.size() < worth_levels)
    return nullptr;
  double inertia = 0;
  for (const double m : equation.mass)
    inertia += 3 * equation.mass_factor * m;
  if (equation.trace < stiff * inertia)
    return nullptr;
  const bool leaves_out = equation.mass_factor == 0 && without_excess(material_, elements_.strain());
  if (leaves_out != leaves_out_dilatation_) {
    multigrid_ = nullptr;
    former_levels_ = {};
    leaves_out_dilatation_ = leaves_out;
  }
  if (!multigrid_)
    make_multigrid();
  if (multigrid_->n_levels() == 1)
    return nullptr;
  if (!shares_diagonal()) {
    multigrid_->prepare(equation);
    if (leaves_out)
      multigrid_->leave_out(
        std::make_unique<Dilatation>(*batching_, batched_, material_of_multigrid(), equation.stiffness_factor));
    return multigrid_.get();
  }
  if (of_diagonal_ != OfDiagonal::there) {
    const TwoRows lent(batching_->n_rows());
    find_diagonal(lent.first);
    keep_diagonal(lent.first);
  }
  multigrid_->prepare(equation, std::move(diagonal_));
  of_diagonal_ = OfDiagonal::unwanted;
  return multigrid_.get();
}

} // namespace kerf::fem
