#include "visibility/line_of_sight.h"

#include "geometry/predicates.h"

namespace kerf::visibility {

Box LineOfSight::reach(const Pair& pair) const { return {pair.a.cwiseMin(pair.b), pair.a.cwiseMax(pair.b)}; }

bool LineOfSight::concerns(const Pair& pair, const pba::Sight&, const Face& face) const {
  return geometry::crosses(pair.a, pair.b, face);
}

void LineOfSight::look(const CutFaces& cut, const Table<PairId, Pair>& pairs, const std::span<const Work> works,
                       Sights& sights) {
  // The points of a pair may be others than when the faces came.
  for (const Work& work : works)
    for (const std::uint32_t face : work.faces)
      if (geometry::crosses(pairs[work.pair].a, pairs[work.pair].b, cut.all()[face]))
        sights[work.pair].factor = 0;
}

} // namespace kerf::visibility
