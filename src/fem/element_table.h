#pragma once

/// The elements of a body: one for all full cubes, one for each copy whose material is less. Copies of crumbs need
/// none.

#include "fem/element.h"
#include "grid/solid.h"

#include <span>
#include <vector>

namespace kerf::fem {

/// How a copy counts that its material does not fill.
enum class Boundary {
  octants,         ///< with its own material: exact for every position of the cut
  volume_fraction, ///< as a full cube, of the density and stiffness that its volume is part of the cube's
  full_cube        ///< as a full cube, as is common: doubles mass and stiffness along a cut
};

struct ElementTableOptions {
  material::Elastic material;
  Boundary boundary = Boundary::octants;
  ElementOptions element;
};

class ElementTable {
 public:
  ElementTable(const grid::Solid& solid, const ElementTableOptions& options);

  /// Makes these copies' elements anew; all others must have the material they had.
  void update(const grid::Solid& solid, std::span<const grid::CopyId> changed);

  const Element& operator[](const std::size_t copy) const { return elements_[element_of_[copy]]; }
  std::size_t n_copies() const { return element_of_.size(); }
  /// How many copies have an element of their own.
  std::size_t n_partial() const { return elements_.size() - 1 - free_.size(); }

  /// Of a copy's material, as it counts (Boundary).
  Moments moments(const grid::Solid& solid, grid::CopyId copy) const;

  bool is_full(const std::size_t copy) const { return element_of_[copy] == 0; }
  const Element& full() const { return elements_[0]; }
  Strain strain() const { return options_.element.strain; }

 private:
  bool is_partial(const grid::Solid& solid, const grid::Copy& copy) const;
  /// The index of an element that nothing uses.
  std::uint32_t unused();

  double h_;
  ElementTableOptions options_;
  std::vector<Element> elements_;         // [0] is the full cube
  std::vector<std::uint32_t> element_of_; // by copy
  std::vector<std::uint32_t> free_;       // of elements_: used no more
};

} // namespace kerf::fem
