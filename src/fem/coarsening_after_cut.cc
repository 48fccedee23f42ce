#include "base/loan.h"
#include "base/union_find.h"
#include "fem/coarsening.h"
#include "grid/cube.h"

#include <algorithm>
#include <utility>

namespace kerf::fem {

/// Coarse copies that hold what cuts have changed are dissolved, and found again among the fine copies that they had;
/// so are coarse corners of these, and of what is glued to them.
class AfterCut {
 public:
  AfterCut(const CellsView& fine, const Coarsening& before, const CutCells& cut)
    : fine_(fine), before_(before), cut_(cut), dissolved_(before.coarse.n_copies(), 0) {}

  Coarsening result() {
    dissolve();
    find_copies();
    find_corners();
    ask();
    return std::move(now_);
  }

 private:
  static constexpr std::uint32_t none = CellsOfLevel::unused;

  bool is_upper(const std::uint32_t copy, const int axis) const { return (fine_.place[copy][axis] & 1) != 0; }
  const std::uint32_t* corners(const std::uint32_t copy) const { return fine_.corners.data() + 8 * std::size_t(copy); }
  bool are_glued(const std::uint32_t below, const std::uint32_t above, const int axis) const {
    return std::ranges::all_of(grid::cube::face_vertices[2 * axis],
                               [&](const int v) { return corners(below)[v | 1 << axis] == corners(above)[v]; });
  }
  /// Calls f(other) for each copy glued onto one, along an axis above or below it.
  template <class Function>
  void for_each_glued(const std::uint32_t copy, const int axis, const bool above, const Function& f) const {
    const std::uint32_t mine = above ? 1U << axis : 0, its = above ? 0 : 1U << axis;
    for (const std::uint32_t user : cut_.users(corners(copy)[mine]))
      if (const std::uint32_t other = user / 8; user % 8 == its)
        if (above ? are_glued(copy, other, axis) : are_glued(other, copy, axis))
          f(other);
  }
  std::uint32_t parent_before(const std::uint32_t copy) const {
    return copy < before_.parent.size() ? before_.parent[copy] : none;
  }

  void dissolve();
  void find_copies();
  void find_corners();
  void open_corners();
  void ask();

  const CellsView& fine_;
  const Coarsening& before_;
  const CutCells& cut_;
  std::vector<std::uint8_t> dissolved_; // of coarse copies before
  std::vector<std::uint32_t> was_;      // of each coarse copy the one before; `none` of those that are new
  std::vector<std::uint8_t> is_open_;   // of coarse corners before: to be found again
  Coarsening now_;
};

void AfterCut::dissolve() {
  const auto dissolve = [&](const std::uint32_t parent) {
    if (parent != none)
      dissolved_[parent] = 1;
  };
  for (const std::uint32_t copy : cut_.copies) {
    dissolve(parent_before(copy));
    for (int axis = 0; axis < 3 && fine_.is_used(copy); ++axis)
      for_each_glued(copy, axis, !is_upper(copy, axis), // in the coarse cube
                     [&](const std::uint32_t other) { dissolve(parent_before(other)); });
  }
}

void AfterCut::find_copies() {
  std::vector<std::uint32_t> loose; // fine copies without a parent as yet
  for (std::uint32_t p = 0; p < dissolved_.size(); ++p)
    if (dissolved_[p] != 0)
      for (const std::uint32_t child : before_.children.of(p))
        if (fine_.is_used(child))
          loose.push_back(child);
  for (const std::uint32_t copy : cut_.copies)
    if (fine_.is_used(copy) && parent_before(copy) == none)
      loose.push_back(copy);
  std::ranges::sort(loose);
  Loan<std::uint32_t> place(fine_.n_copies(), none);
  for (std::uint32_t i = 0; i < loose.size(); ++i)
    place[loose[i]] = i;
  UnionFind sets(loose.size());
  for (std::uint32_t i = 0; i < loose.size(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      if (!is_upper(loose[i], axis))
        for_each_glued(loose[i], axis, true, [&](const std::uint32_t above) { sets.unite(i, place[above]); });
  std::vector<std::uint32_t> set_of;
  std::vector<std::vector<std::uint32_t>> found(sets.number(set_of)); // by their lowest copies
  for (std::uint32_t i = 0; i < loose.size(); ++i)
    found[set_of[i]].push_back(loose[i]);

  const std::size_t n_fine = fine_.n_copies();
  now_.parent.assign(n_fine, none);
  now_.octant = before_.octant;
  now_.octant.resize(n_fine, 0);
  for (const std::uint32_t copy : cut_.copies) {
    const Index3& at = fine_.place[copy];
    now_.octant[copy] =
      static_cast<std::uint8_t>(fine_.is_used(copy) ? (at[0] & 1) | (at[1] & 1) << 1 | (at[2] & 1) << 2 : 0);
  }
  now_.children.all.reserve(n_fine);
  now_.children.begin.reserve(before_.coarse.n_copies() + found.size() + 1);
  now_.coarse.place.reserve(before_.coarse.n_copies() + found.size());
  const auto add = [&](const std::span<const std::uint32_t> children, const std::uint32_t was, const Index3& at) {
    for (const std::uint32_t child : children)
      now_.parent[child] = static_cast<std::uint32_t>(was_.size());
    now_.children.all.insert(now_.children.all.end(), children.begin(), children.end());
    now_.children.begin.push_back(static_cast<std::uint32_t>(now_.children.all.size()));
    now_.coarse.place.push_back(at);
    was_.push_back(was);
  };
  std::size_t next = 0;
  const auto add_found_before = [&](const std::uint32_t child) {
    for (; next < found.size() && found[next][0] < child; ++next) {
      const Index3& at = fine_.place[found[next][0]];
      add(found[next], none, {at[0] >> 1, at[1] >> 1, at[2] >> 1});
    }
  };
  for (std::uint32_t p = 0; p < dissolved_.size(); ++p)
    if (dissolved_[p] == 0) {
      add_found_before(before_.children.of(p)[0]);
      add(before_.children.of(p), p, before_.coarse.place[p]);
    }
  add_found_before(none);
}

/// Of what is dissolved, and of all that new coarse copies are glued to.
void AfterCut::open_corners() {
  is_open_.assign(before_.coarse.n_corners, 0);
  const auto open = [&](const std::uint32_t coarse_before) {
    for (std::size_t v = 0; v < 8; ++v)
      is_open_[before_.coarse.corners[8 * std::size_t(coarse_before) + v]] = 1;
  };
  for (std::uint32_t p = 0; p < dissolved_.size(); ++p)
    if (dissolved_[p] != 0)
      open(p);
  for (std::uint32_t c = 0; c < was_.size(); ++c)
    if (was_[c] == none)
      for (const std::uint32_t child : now_.children.of(c))
        for (int axis = 0; axis < 3; ++axis)
          for_each_glued(child, axis, is_upper(child, axis), [&](const std::uint32_t other) { // across the coarse face
            if (const std::uint32_t was = was_[now_.parent[other]]; was != none)
              open(was);
          });
}

void AfterCut::find_corners() {
  open_corners();
  const auto n = static_cast<std::uint32_t>(was_.size());
  std::vector<std::uint32_t> opened; // 8 coarse copy + vertex, ascending
  const auto corner_before = [&](const std::uint32_t c, const std::uint32_t v) {
    return before_.coarse.corners[8 * std::size_t(was_[c]) + v];
  };
  for (std::uint32_t c = 0; c < n; ++c)
    for (std::uint32_t v = 0; v < 8; ++v)
      if (was_[c] == none || is_open_[corner_before(c, v)] != 0)
        opened.push_back(8 * c + v);
  Loan<std::uint32_t> place(8 * std::size_t(n), none);
  for (std::uint32_t i = 0; i < opened.size(); ++i)
    place[opened[i]] = i;
  UnionFind sets(opened.size());
  for (std::size_t i = 0; i < opened.size(); ++i) {
    const std::uint32_t low = opened[i] / 8;
    if (i > 0 && opened[i - 1] / 8 == low)
      continue;
    for (int axis = 0; axis < 3; ++axis)
      for (const std::uint32_t child : now_.children.of(low))
        if (is_upper(child, axis))
          for_each_glued(child, axis, true, [&](const std::uint32_t above) {
            const std::uint32_t high = now_.parent[above];
            for (const int v : grid::cube::face_vertices[2 * axis]) {
              const std::uint32_t a = place[8 * low + static_cast<std::uint32_t>(v | 1 << axis)],
                                  b = place[8 * high + static_cast<std::uint32_t>(v)];
              if (a != none && b != none)
                sets.unite(a, b);
            }
          });
  }
  std::vector<std::uint32_t> of_opened(opened.size(), none), of_kept(before_.coarse.n_corners, none);
  std::uint32_t n_corners = 0;
  now_.coarse.corners.resize(8 * std::size_t(n));
  for (std::uint32_t c = 0; c < n; ++c)
    for (std::uint32_t v = 0; v < 8; ++v) {
      const std::uint32_t i = place[8 * c + v];
      std::uint32_t& number = i != none ? of_opened[sets.root(i)] : of_kept[corner_before(c, v)];
      if (number == none)
        number = n_corners++;
      now_.coarse.corners[8 * std::size_t(c) + v] = number;
    }
  now_.coarse.n_corners = n_corners;
}

void AfterCut::ask() {
  now_.user_ = before_.user_;
  now_.user_.resize(fine_.n_corners, none);
  std::vector<std::uint8_t> has_others(was_.size(), 0);
  for (const std::uint32_t corner : cut_.corners) {
    const auto users = cut_.users(corner);
    now_.user_[corner] = users.empty() ? none : users.front();
    for (const std::uint32_t user : users)
      has_others[now_.parent[user / 8]] = 1;
  }
  now_.begin_ = {0};
  now_.begin_.reserve(was_.size() + 1);
  now_.corner_.reserve(fine_.n_corners);
  now_.place_.reserve(fine_.n_corners);
  for (std::uint32_t c = 0; c < was_.size(); ++c) {
    if (was_[c] != none && has_others[c] == 0) {
      const auto begin = static_cast<std::ptrdiff_t>(before_.begin_[was_[c]]),
                 end = static_cast<std::ptrdiff_t>(before_.begin_[was_[c] + 1]);
      now_.corner_.insert(now_.corner_.end(), before_.corner_.begin() + begin, before_.corner_.begin() + end);
      now_.place_.insert(now_.place_.end(), before_.place_.begin() + begin, before_.place_.begin() + end);
    } else {
      for (const std::uint32_t child : now_.children.of(c))
        for (std::uint32_t i = 8 * child; i < 8 * child + 8; ++i)
          if (now_.user_[fine_.corners[i]] == i) {
            now_.corner_.push_back(fine_.corners[i]);
            now_.place_.push_back(now_.place_of(i));
          }
    }
    now_.begin_.push_back(static_cast<std::uint32_t>(now_.corner_.size()));
  }
}

Coarsening coarsened(const CellsView& fine, const Coarsening& before, const CutCells& cut) {
  return AfterCut(fine, before, cut).result();
}

} // namespace kerf::fem
