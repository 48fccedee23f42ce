#include "fem/element_table.h"

#include "base/loan.h"
#include "base/parallel.h"

#include <algorithm>

namespace kerf::fem {

ElementTable::ElementTable(const grid::Solid& solid, const ElementTableOptions& options)
  : h_(solid.grid.h()), options_(options) {
  elements_.push_back(make_element(full_cube_moments(), h_, options.material, options.element));
  std::vector<grid::CopyId> all;
  all.reserve(solid.complex.n_copies());
  for (const auto c : ids<grid::CopyId>(solid.complex.n_copies()))
    all.push_back(c);
  update(solid, all);
}

void ElementTable::update(const grid::Solid& solid, const std::span<const grid::CopyId> changed) {
  grow(element_of_, solid.complex.n_copies());
  std::vector<grid::CopyId> partial;
  for (const auto c : changed) {
    std::uint32_t& element = element_of_[c.value];
    if (!solid.crumbs.holds(c) && is_partial(solid, solid.complex.copies[c])) {
      partial.push_back(c);
      element = element == 0 ? unused() : element;
    } else if (element != 0) {
      free_.push_back(element);
      element = 0;
    }
  }
  parallel_for(partial.size(), [&](const std::size_t i) {
    elements_[element_of_[partial[i].value]] =
      make_element(moments(solid, partial[i]), h_, options_.material, options_.element);
  });
}

bool ElementTable::is_partial(const grid::Solid& solid, const grid::Copy& copy) const {
  return options_.boundary != Boundary::full_cube && copy.nodes != 0xff &&
         (solid.cuts.configuration(solid.grid, copy.cell) != 0 || solid.cuts.front(copy.cell) != nullptr);
}

Moments ElementTable::moments(const grid::Solid& solid, const grid::CopyId copy) const {
  const Moments own = material_moments(solid, solid.complex.copies[copy]);
  if (options_.boundary == Boundary::octants)
    return own;
  Moments part = full_cube_moments();
  for (double& m : part)
    m *= own[0];
  return part;
}

std::uint32_t ElementTable::unused() {
  if (free_.empty()) {
    elements_.emplace_back();
    return static_cast<std::uint32_t>(elements_.size() - 1);
  }
  const auto element = free_.back();
  free_.pop_back();
  return element;
}

} // namespace kerf::fem
