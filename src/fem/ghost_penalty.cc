#include "fem/ghost_penalty.h"

#include <algorithm>
#include <iterator>
#include <tuple>

namespace kerf::fem {

namespace {

using grid::CopyId;

constexpr std::uint8_t far = 9; // the distance of copies without a well-filled one within eight

Eigen::Map<const Vec3> at(const std::span<const double> values, const std::uint32_t corner) {
  return Eigen::Map<const Vec3>(values.data() + 3 * std::size_t(corner));
}
Eigen::Map<Vec3> at(const std::span<double> values, const std::uint32_t corner) {
  return Eigen::Map<Vec3>(values.data() + 3 * std::size_t(corner));
}

bool comes_before(const GhostFace& f, const GhostFace& g) {
  return std::tie(f.lower, f.axis, f.upper) < std::tie(g.lower, g.axis, g.upper);
}

/// The copies of a list that need not be ascending, to be asked for one by one.
class Marked {
 public:
  Marked(const std::span<const CopyId> copies, const std::size_t n_copies) : is_(n_copies, 0) {
    for (const CopyId c : copies)
      is_[c.value] = 1;
  }
  bool operator()(const CopyId c) const { return is_[c.value] != 0; }

 private:
  std::vector<std::uint8_t> is_;
};

} // namespace

GhostPenalty::GhostPenalty(const GhostPenaltyOptions& options, const material::Elastic& material, const double h)
  : options_(options), stiffness_of_cube_(material.mu() * h), mass_of_cube_(material.density * h * h * h) {}

void GhostPenalty::update(const grid::Solid& solid, const std::span<const CopyId> changed,
                          const std::function<double(std::size_t)>& fill, const std::span<const double> mass) {
  const auto& [grid, cuts, complex, crumbs] = solid;
  extended_mass_.assign(mass.begin(), mass.end());
  if (options_.weight == 0)
    return;
  const Marked has_changed(changed, complex.n_copies());
  std::erase_if(known_, [&](const GhostFace& face) { return has_changed(face.lower) || has_changed(face.upper); });
  std::vector<GhostFace> found;
  for (const CopyId c : changed)
    for (int axis = 0; axis < 3; ++axis) {
      add_faces_above(solid, c, axis, fill, found);
      const grid::CellId below = grid.neighbour(complex.copies[c].cell, 2 * axis);
      if (!below.valid())
        continue;
      const auto first = static_cast<std::ptrdiff_t>(found.size());
      for (const CopyId lower : complex.copies_of(below))
        if (!has_changed(lower))
          add_faces_above(solid, lower, axis, fill, found);
      found.erase(std::remove_if(found.begin() + first, found.end(), [&](const GhostFace& f) { return f.upper != c; }),
                  found.end());
    }
  std::sort(found.begin(), found.end(), comes_before);
  const auto n_kept = static_cast<std::ptrdiff_t>(known_.size());
  known_.insert(known_.end(), found.begin(), found.end());
  std::inplace_merge(known_.begin(), known_.begin() + n_kept, known_.end(), comes_before);
  choose_faces(complex.n_copies());
  extend_mass();
  weigh_faces();
}

void GhostPenalty::add_faces_above(const grid::Solid& solid, const CopyId lower, const int axis,
                                   const std::function<double(std::size_t)>& fill,
                                   std::vector<GhostFace>& faces) const {
  const auto& [grid, cuts, complex, crumbs] = solid;
  const grid::Copy& below = complex.copies[lower];
  const grid::CellId cell = grid.neighbour(below.cell, 2 * axis + 1);
  if (!cell.valid())
    return;
  for (const CopyId upper : complex.copies_of(cell)) {
    const grid::Copy& above = complex.copies[upper];
    const double below_needs = need(fill(lower.value)), above_needs = need(fill(upper.value)),
                 needed = std::max(below_needs, above_needs);
    if (needed == 0 || !grid::are_glued(below.part(), above.part(), axis))
      continue;
    GhostFace face{lower, upper, static_cast<std::uint8_t>(axis), needed, {}, {}, {}, {}};
    if (below_needs == 0 || above_needs == 0)
      face.well_filled = below_needs == 0 ? lower : upper;
    for (int i = 0; i < 4; ++i) {
      const int v = grid::cube::face_vertices[2 * axis][i], w = v | 1 << axis;
      face.a[i] = below.corners[v].value;
      face.b[i] = below.corners[w].value;
      face.c[i] = above.corners[w].value;
    }
    faces.push_back(face);
  }
}

/// Distances by sweeps over the faces, there and back: in as many as the farthest way changes its direction.
void GhostPenalty::choose_faces(const std::size_t n_copies) {
  std::vector<std::uint8_t> distance(n_copies, far);
  bool has_changed = false;
  const auto relax = [&](const GhostFace& face) {
    std::uint8_t &p = distance[face.lower.value], &q = distance[face.upper.value];
    for (auto* const one : {&p, &q}) {
      const std::uint8_t other = one == &p ? q : p;
      if (*one > other + 1) {
        *one = static_cast<std::uint8_t>(other + 1);
        has_changed = true;
      }
    }
  };
  for (const GhostFace& face : known_)
    if (face.well_filled.valid())
      distance[face.well_filled.value] = 0;
  do {
    has_changed = false;
    std::for_each(known_.begin(), known_.end(), relax);
    std::for_each(known_.rbegin(), known_.rend(), relax);
  } while (has_changed);
  faces_.clear();
  for (const GhostFace& face : known_)
    if (const auto p = distance[face.lower.value], q = distance[face.upper.value]; p != q || p == far) {
      faces_.push_back(face);
      faces_.back().distance = std::max(p, q);
    }
}

/// From the well-filled copies outwards: what a corner was given at one distance it passes on at the next.
void GhostPenalty::extend_mass() {
  std::array<std::vector<const GhostFace*>, far + 1> at_distance;
  for (const GhostFace& face : faces_)
    at_distance[face.distance].push_back(&face);
  std::vector<double> shares(extended_mass_.size(), 0.0);
  for (int distance = 1; distance <= far; ++distance)
    extend_mass_across(at_distance[static_cast<std::size_t>(distance)], shares);
}

/// `shares`: zeros, of all corners, before and after.
void GhostPenalty::extend_mass_across(const std::span<const GhostFace* const> faces, std::vector<double>& shares) {
  constexpr double theta = 1.0 / 16, most_shares = 6; // 12 theta < 1: something is left of every mass
  for (const GhostFace* const face : faces)
    for (const auto b : face->b)
      shares[b] += 0.5 * face->need; // a quarter of it for each of the line's two ends
  std::vector<double> shifts;
  shifts.reserve(4 * faces.size());
  const std::vector<double>& mass = extended_mass_;
  for (const GhostFace* const face : faces)
    for (int i = 0; i < 4; ++i) {
      const auto a = face->a[i], b = face->b[i], c = face->c[i];
      const double part = 0.25 * face->need * theta * std::min(1.0, most_shares / shares[b]);
      shifts.push_back(part * (std::max(0.0, mass[b] - 4 * mass[a]) + std::max(0.0, mass[b] - 4 * mass[c])));
    }
  auto shift = shifts.begin();
  for (const GhostFace* const face : faces)
    for (int i = 0; i < 4; ++i, ++shift) {
      extended_mass_[face->a[i]] += *shift;
      extended_mass_[face->b[i]] -= 2 * *shift;
      extended_mass_[face->c[i]] += *shift;
      shares[face->b[i]] = 0;
    }
}

void GhostPenalty::weigh_faces() {
  constexpr double enough = 1.0 / 32; // of the mass of a cube, for the full penalty
  for (GhostFace& face : faces_) {
    double least = enough * mass_of_cube_;
    for (const auto* line : {&face.a, &face.b, &face.c})
      for (const auto corner : *line)
        least = std::min(least, extended_mass_[corner]);
    face.stiffness = 0.25 * options_.weight * stiffness_of_cube_ * face.need * least / (enough * mass_of_cube_);
  }
}

void GhostPenalty::count_by(const grid::CornerNumbers& numbers) {
  for (GhostFace& face : faces_)
    for (auto* const line : {&face.a, &face.b, &face.c})
      for (auto& corner : *line)
        corner = numbers[corner];
}

namespace {

double energy_of(const GhostFace& face, const Points& x) {
  double squares = 0;
  for (int i = 0; i < 4; ++i)
    squares += (x[face.a[i]] - 2 * x[face.b[i]] + x[face.c[i]]).squaredNorm();
  return 0.5 * face.stiffness * squares;
}

} // namespace

double GhostPenalty::energy(const Points& x) const {
  double sum = 0;
  for (const GhostFace& face : faces_)
    sum += energy_of(face, x);
  return sum;
}

void GhostPenalty::add_energies(const Points& x, const dynamics::Pieces& pieces, const std::span<double> sums) const {
  for (const GhostFace& face : faces_)
    sums[pieces.of(face.b[0])] += energy_of(face, x);
}

void GhostPenalty::add_force(const Points& x, Points& forces) const {
  for (const GhostFace& face : faces_)
    for (int i = 0; i < 4; ++i) {
      const Vec3 f = face.stiffness * (x[face.a[i]] - 2 * x[face.b[i]] + x[face.c[i]]);
      forces[face.a[i]] -= f;
      forces[face.b[i]] += 2 * f;
      forces[face.c[i]] -= f;
    }
}

void GhostPenalty::add_product(const std::span<const double> p, const std::span<double> y) const {
  for (const GhostFace& face : faces_)
    for (int i = 0; i < 4; ++i) {
      const Vec3 f = face.stiffness * (at(p, face.a[i]) - 2 * at(p, face.b[i]) + at(p, face.c[i]));
      at(y, face.a[i]) += f;
      at(y, face.b[i]) -= 2 * f;
      at(y, face.c[i]) += f;
    }
}

Loan<double> GhostPenalty::diagonal(const std::size_t n_corners) const {
  Loan<double> all(n_corners, 0.0);
  for (const GhostFace& face : faces_)
    for (int i = 0; i < 4; ++i) {
      all[face.a[i]] += face.stiffness;
      all[face.b[i]] += 4 * face.stiffness;
      all[face.c[i]] += face.stiffness;
    }
  return all;
}

void GhostPenalty::add_entries(std::vector<Eigen::Triplet<double>>& entries) const {
  constexpr std::array<double, 3> second_difference = {1, -2, 1};
  for (const GhostFace& face : faces_)
    for (int i = 0; i < 4; ++i) {
      const std::array<std::uint32_t, 3> corners = {face.a[i], face.b[i], face.c[i]};
      for (int p = 0; p < 3; ++p)
        for (int q = 0; q < 3; ++q)
          for (int k = 0; k < 3; ++k)
            entries.emplace_back(3 * corners[p] + k, 3 * corners[q] + k,
                                 face.stiffness * second_difference[p] * second_difference[q]);
    }
}

} // namespace kerf::fem
