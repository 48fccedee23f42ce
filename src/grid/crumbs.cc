#include "grid/crumbs.h"

#include "base/sort_unique.h"
#include "grid/locate.h"
#include "grid/material.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <bit>
#include <numeric>
#include <optional>
#include <span>

namespace kerf::grid {

namespace {

/// Of some copies' nodes.
struct Extent {
  Index3 least{}, most{};
  bool is_empty = true;

  void add(const Solid& solid, const CopyId c) {
    const Copy& copy = solid.complex.copies[c];
    const auto nodes = solid.grid.nodes(copy.cell);
    for (unsigned left = copy.nodes; left != 0; left &= left - 1) {
      const Index3& node = solid.grid.index(nodes[std::countr_zero(left)]);
      for (int axis = 0; axis < 3; ++axis) {
        least[axis] = is_empty ? node[axis] : std::min(least[axis], node[axis]);
        most[axis] = is_empty ? node[axis] : std::max(most[axis], node[axis]);
      }
      is_empty = false;
    }
  }
  bool is_of_one_cube() const { return most[0] - least[0] <= 1 && most[1] - least[1] <= 1 && most[2] - least[2] <= 1; }
};

/// The samples that each copy holds.
class SamplesOfCopies {
 public:
  SamplesOfCopies(const Solid& solid, const Points& samples)
    : samples_(samples), first_(solid.complex.n_copies() + 1, 0) {
    const std::vector<CopyId> copies = copies_around(solid, samples);
    for (const CopyId c : copies)
      ++first_[c.value + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    order_.resize(copies.size());
    for (std::uint32_t i = 0; i < copies.size(); ++i)
      order_[next[copies[i].value]++] = i;
  }

  template <class Function>
  void for_each(const CopyId c, const Function& f) const {
    for (auto k = first_[c.value]; k < first_[c.value + 1]; ++k)
      f(samples_[order_[k]]);
  }

 private:
  const Points& samples_;
  std::vector<std::uint32_t> first_, order_;
};

/// Second moment of points about their mean.
class Spread {
 public:
  void add(const Vec3& p) {
    ++n_;
    const Vec3 from_mean = p - mean_; // Welford's update
    mean_ += from_mean / n_;
    moment_ += from_mean * (p - mean_).transpose();
  }
  bool spans_volume(const double h) const {
    constexpr double least = 1.0 / 2; // of h^2
    return n_ > 3 &&
           Eigen::SelfAdjointEigenSolver<Mat3>(moment_, Eigen::EigenvaluesOnly).eigenvalues()[0] >= least * h * h;
  }

 private:
  double n_ = 0;
  Vec3 mean_ = Vec3::Zero();
  Mat3 moment_ = Mat3::Zero();
};

/// What makes a piece a crumb.
struct Rule {
  bool may_be_small = false;       ///< or must be loose
  const Points* samples = nullptr; ///< that are to span its volume
};

/// Walks through pieces until it knows what they are.
class Search {
 public:
  Search(const Solid& solid, const Rule& rule)
    : solid_(solid), rule_(rule), known_(solid.complex.n_copies(), Known::nothing) {
    if (rule.samples)
      samples_.emplace(solid, *rule.samples);
  }

  /// The copies of the crumb that holds a copy, ascending; none where it is in no crumb, or in one found before.
  std::vector<CopyId> crumb_at(const CopyId start) {
    std::vector<CopyId> copies;
    if (known_[start] != Known::nothing)
      return copies;
    bool is_crumb = true, is_loose = true, is_of_one = solid_.crumbs.holds(start);
    Extent extent;
    Spread spread;
    copies.push_back(start);
    known_[start] = Known::seen;
    for (std::size_t i = 0; i < copies.size() && is_crumb; ++i) {
      is_loose = is_loose && this->is_loose(copies[i]);
      is_of_one = is_of_one && solid_.crumbs.of(copies[i]) == solid_.crumbs.of(start);
      extent.add(solid_, copies[i]);
      if (samples_)
        samples_->for_each(copies[i], [&](const Vec3& p) { spread.add(p); });
      is_crumb = is_of_one || is_loose || (rule_.may_be_small && extent.is_of_one_cube()) ||
                 (samples_ && !spread.spans_volume(solid_.grid.h()));
      is_crumb = is_crumb && for_each_beside(copies[i], [&](const CopyId other) { return add(other, copies); });
    }
    if (is_crumb) {
      std::sort(copies.begin(), copies.end());
      return copies;
    }
    for (const CopyId c : copies)
      known_[c] = Known::attached;
    return {};
  }
  bool is_attached(const CopyId c) const { return known_[c] == Known::attached; }

 private:
  enum class Known : std::uint8_t { nothing, seen, attached };

  bool is_loose(const CopyId c) const {
    constexpr double round_off = 1e-6; // a row of whole cubes around nodes fills quarters
    const Copy& copy = solid_.complex.copies[c];
    return std::popcount(copy.nodes) <= 1 || fill(solid_, copy) < (1 - round_off) * well_filled;
  }

  /// Calls f(other) for each copy that is glued to this one, or that a front holds together with it, until f says
  /// false.
  template <class Function>
  bool for_each_beside(const CopyId c, const Function& f) const {
    for (int face = 0; face < 6; ++face)
      if (!for_each_across(c, face, f))
        return false;
    if (solid_.cuts.front(solid_.complex.copies[c].cell))
      for (const auto& [a, b] : solid_.complex.tied)
        if ((a == c || b == c) && !f(a == c ? b : a))
          return false;
    return true;
  }

  template <class Function>
  bool for_each_across(const CopyId c, const int face, const Function& f) const {
    const Copy& copy = solid_.complex.copies[c];
    const CellId cell = solid_.grid.neighbour(copy.cell, face);
    if (!cell.valid())
      return true;
    for (const CopyId other : solid_.complex.copies_of(cell)) {
      const Part mine = copy.part(), its = solid_.complex.copies[other].part();
      if ((face % 2 == 1 ? are_glued(mine, its, face / 2) : are_glued(its, mine, face / 2)) && !f(other))
        return false;
    }
    return true;
  }

  /// False where it is known to be in no crumb.
  bool add(const CopyId other, std::vector<CopyId>& copies) {
    if (known_[other] == Known::nothing) {
      known_[other] = Known::seen;
      copies.push_back(other);
    }
    return known_[other] != Known::attached;
  }

  const Solid& solid_;
  Rule rule_;
  std::optional<SamplesOfCopies> samples_;
  Table<CopyId, Known> known_;
};

/// The crumbs that hold some of these copies, without a name yet.
std::vector<Crumb> crumbs_at(Search& search, const std::span<const CopyId> copies) {
  std::vector<Crumb> found;
  for (const CopyId c : copies)
    if (auto of_crumb = search.crumb_at(c); !of_crumb.empty())
      found.push_back({Crumbs::none, std::move(of_crumb)});
  return found;
}

void mark(Solid& solid, const CopyId c, const std::uint32_t crumb) {
  solid.crumbs.set(c, crumb);
  for (const CornerId corner : solid.complex.copies[c].corners)
    solid.crumbs.of_corner[corner.value] = crumb != Crumbs::none;
}

void add(Solid& solid, std::vector<Crumb> found) {
  for (Crumb& crumb : found) {
    crumb.name = ++solid.crumbs.n_named;
    for (const CopyId c : crumb.copies)
      mark(solid, c, crumb.name);
    solid.crumbs.all.push_back(std::move(crumb));
  }
}

/// Copies across a face from what a cut has changed, of cells that stay what they are: what is glued by points of the
/// skin or by intervals may be so no more, or newly, though its own cell has not changed.
std::vector<CopyId> beside(const Solid& solid, const CutChange& change) {
  std::vector<CopyId> copies;
  for (const CellId cell : change.cells)
    for (int face = 0; face < 6; ++face)
      if (const CellId other = solid.grid.neighbour(cell, face);
          other.valid() && !std::ranges::binary_search(change.cells, other))
        for (const CopyId c : solid.complex.copies_of(other))
          if (const Copy& copy = solid.complex.copies[c]; copy.skin != 0 || copy.intervals != 0)
            copies.push_back(c);
  sort_unique(copies);
  return copies;
}

/// Whether these copies are a crumb already.
bool is_known(const Solid& solid, const std::span<const CopyId> copies) {
  const std::uint32_t name = solid.crumbs.of(copies.front());
  const auto before = std::ranges::lower_bound(solid.crumbs.all, name, {}, &Crumb::name);
  return before != solid.crumbs.all.end() && before->name == name && std::ranges::equal(before->copies, copies);
}

} // namespace

void find_crumbs(Solid& solid) {
  solid.crumbs = {};
  std::vector<CopyId> all;
  for (const auto c : ids<CopyId>(solid.complex.n_copies()))
    if (solid.complex.copies[c].nodes != 0xff)
      all.push_back(c);
  Search search(solid, {});
  if (auto found = crumbs_at(search, all); !found.empty()) {
    solid.crumbs.of_corner.resize(solid.complex.n_corners(), 0);
    add(solid, std::move(found));
  }
}

void update_crumbs(Solid& solid, CutChange& change, const Points* const samples) {
  Crumbs& crumbs = solid.crumbs;
  std::vector<CopyId> in_use = change.reshaped;
  std::erase_if(in_use, [&](const CopyId c) { return solid.complex.copies[c].is_lapsed(); });
  Search search(solid, {.may_be_small = true, .samples = samples});
  std::vector<Crumb> found = crumbs_at(search, in_use);
  for (Crumb& crumb : crumbs_at(search, beside(solid, change)))
    if (!is_known(solid, crumb.copies))
      found.push_back(std::move(crumb));
  if (found.empty() && crumbs.all.empty())
    return;
  std::vector<CopyId> now;
  for (const Crumb& crumb : found)
    now.insert(now.end(), crumb.copies.begin(), crumb.copies.end());
  sort_unique(now);
  const auto is_found = [&](const CopyId c) { return std::ranges::binary_search(now, c); };

  std::vector<CopyId> freed = std::move(in_use);
  std::erase_if(crumbs.all, [&](const Crumb& before) {
    const bool is_met = std::ranges::any_of(before.copies, [&](const CopyId c) {
      return crumbs.of(c) != before.name || search.is_attached(c) || is_found(c);
    });
    if (is_met)
      freed.insert(freed.end(), before.copies.begin(), before.copies.end());
    return is_met;
  });
  std::erase_if(freed, [&](const CopyId c) { return solid.complex.copies[c].is_lapsed() || is_found(c); });
  crumbs.of_corner.resize(solid.complex.n_corners(), 0);
  for (const CopyId c : freed)
    mark(solid, c, Crumbs::none);
  change.reshaped.insert(change.reshaped.end(), freed.begin(), freed.end());
  change.reshaped.insert(change.reshaped.end(), now.begin(), now.end());
  sort_unique(change.reshaped);
  add(solid, std::move(found));
}

} // namespace kerf::grid
