#include "physics/physics.h"

#include "grid/locate.h"
#include "grid/shape.h"

namespace kerf::physics {

dynamics::State state_at_rest(const Physics& physics) {
  dynamics::State state{physics.rest(), Points(physics.rest().size(), Vec3::Zero()), 0};
  state.crumbs = physics.crumbs().at_rest();
  return state;
}

Interpolation body_point(const CutBody& body, const Vec3& rest) {
  Interpolation point;
  const grid::CopyId c = grid::copy_at(body.solid, rest);
  if (!c.valid())
    return point;
  const grid::Copy& copy = body.solid.complex.copies[c];
  const Vec3 origin = body.solid.grid.position(body.solid.grid.nodes(copy.cell)[0]);
  std::array<std::uint32_t, 8> corners;
  std::array<double, 8> weights;
  for (int v = 0; v < 8; ++v) {
    corners[v] = copy.corners[v].value;
    weights[v] = grid::shape(v, (rest - origin) / body.solid.grid.h());
  }
  point.add_row(corners, weights);
  return point;
}

} // namespace kerf::physics
