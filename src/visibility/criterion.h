#pragma once

/// The contract of a weight criterion: how a cut weakens the bond of a pair of points (thesis §2.3.1, §2.6.2).

#include "base/parameters.h"
#include "pba/sight.h"
#include "visibility/cut_faces.h"

#include <memory>

namespace kerf::visibility {

/// A pair to look at again, and the faces that have come near it since.
struct Work {
  PairId pair;
  std::vector<std::uint32_t> faces; ///< in the order in which they came

  void archive(Archive& a) { a(pair, faces); }
};

using Sights = Table<PairId, pba::Sight>;

class Criterion {
 public:
  virtual ~Criterion() = default;

  /// Outside of this box no face changes what is between the pair.
  virtual Box reach(const Pair& pair) const = 0;

  /// May a face inside the reach change the sight that the pair has? A quick look; yes when in doubt.
  virtual bool concerns(const Pair& pair, const pba::Sight& sight, const Face& face) const = 0;

  /// Pairs first, first + 1, ... are new, or others than before: nothing is between them.
  virtual void watch(PairId first, std::span<const Pair> pairs) = 0;

  /// Brings the sights of the pairs of the works up to date; no pair is in two works. Does not depend on the number of
  /// threads.
  virtual void look(const CutFaces& cut, const Table<PairId, Pair>& pairs, std::span<const Work> works,
                    Sights& sights) = 0;

  /// What it remembers of pairs beside their sights.
  virtual void archive(Archive&) {}
};

/// What a scene says about weights.
struct CriterionChoice {
  std::string criterion = "extended visibility";
  double diffraction_exponent = 1;  ///< gamma of (2.34) [1], >= 1
  double transparency_exponent = 2; ///< gamma of (2.35) [1], >= 2
  int mask_resolution = 32;         ///< texels a side, 4 to 32
  double disk_radius = 0.5;         ///< in distances of the pair [1], > 0
  std::string masks_by = "CPU";

  void describe(Parameters& p);
};

/// The names of all criteria.
const std::vector<std::string>& criteria();

/// `skin`: the faces around the body, none for a body without end; extended visibility reads it. Throws ParameterError
/// for an unknown name or a number out of range, DataError when the masks shall be made by OpenGL and there is none. No
/// GL context is made otherwise.
std::unique_ptr<Criterion> make_criterion(const CriterionChoice& choice, std::span<const Face> skin = {});

} // namespace kerf::visibility
