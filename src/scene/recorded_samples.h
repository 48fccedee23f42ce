#pragma once

/// Where a run's file has the colours of revealed triangles.
///
/// An atlas uses places of samples again, but surfaces that a file has already refer to theirs. So the file has rows of
/// its own, which are only ever appended: those of triangles that have been filled since the surface before. What was
/// filled in between, and again since, no surface of the file shows, and it has no row.

#include "output/records.h"
#include "texture/atlas.h"

namespace kerf::scene {

class RecordedSamples {
 public:
  /// What the file gets with the surface as the atlas has filled it: which rows are those of each triangle, and the rows
  /// that it does not have yet.
  output::Colours append(const texture::Atlas& atlas);

  void archive(Archive& a) { a(first_, n_rows_, fill_); }

 private:
  std::vector<std::uint32_t> first_; ///< row of each triangle; texture::Atlas::none
  std::size_t n_rows_ = 0;
  std::uint32_t fill_ = 0; ///< the last one that the file knows of
};

} // namespace kerf::scene
