#include "cut/advance.h"

#include "base/function_ref.h"
#include "geometry/convex_hull.h"
#include "grid/fronts.h"
#include "grid/parts.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <utility>

namespace kerf::cut {

namespace {

using grid::CellId;
using grid::Front;
using grid::Solid;

constexpr double off_plane = 0.25;       // what counts [cubes]
constexpr std::size_t most_pieces = 128; // the last ones are kept: a body may swing about a blade that rests

/// A cell's coordinates in which its cube is [0, h]^3 at its place at rest, as an affine map from where it is.
struct ToRest {
  ToRest(const Solid& solid, const CellId c, const Points& x) : origin(solid.grid.origin(c)) {
    const grid::Copy& copy = solid.complex.copies[solid.complex.first_copy[c]];
    Mat3 along = Mat3::Zero();
    for (int v = 0; v < 8; ++v) {
      const Vec3& p = x[copy.corners[v].value];
      middle += p / 8;
      for (int axis = 0; axis < 3; ++axis)
        along.col(axis) += ((v >> axis & 1) != 0 ? 0.25 : -0.25) * p;
    }
    const double h = solid.grid.h();
    bool invertible = false;
    Mat3 inverse;
    along.computeInverseWithCheck(inverse, invertible, 1e-6 * h * h * h);
    from = invertible ? Mat3(h * inverse) : Mat3(Mat3::Zero());
    origin += Vec3::Constant(0.5 * h);
  }
  Vec3 operator()(const Vec3& p) const { return origin + from * (p - middle); }

  Vec3 origin, middle = Vec3::Zero();
  Mat3 from;
};

/// Coordinates in a plane and above it, in cubes.
struct InPlane {
  InPlane(const Vec3& point, const Vec3& normal, const double h)
    : origin(point), u(normal.unitOrthogonal() / h), v(normal.cross(u)), w(normal / h) {}
  Vec3 operator()(const Vec3& p) const { return {u.dot(p - origin), v.dot(p - origin), w.dot(p - origin)}; }
  Vec3 point(const Eigen::Vector2d& p) const { return origin + (p[0] * u + p[1] * v) / w.squaredNorm(); }

  Vec3 origin, u, v, w;
};

/// The convex hull of points, in the plane.
Polygon hull(const Points& points, const InPlane& in_plane) {
  std::vector<Eigen::Vector2d> flat;
  for (const Vec3& p : points)
    flat.push_back(in_plane(p).head<2>());
  Polygon hull;
  for (const Eigen::Vector2d& p : geometry::convex_hull(flat))
    hull.push_back(in_plane.point(p));
  return hull;
}

/// Returns how many texels are drawn that were not.
int draw(const Polygon& piece, const InPlane& in_plane, Raster& raster) {
  int n_new = 0;
  for (std::size_t i = 2; i < piece.size(); ++i)
    n_new += raster.draw({in_plane(piece[0]), in_plane(piece[i - 1]), in_plane(piece[i])}, off_plane);
  return n_new;
}

/// Where the plane of a front meets the material of its cell.
Raster section_of(const Solid& solid, const Front& front, const InPlane& in_plane) {
  const CellAtPlane cell(solid, front.cell, {front.point, front.normal}, rest_of(solid, front.cell));
  Raster section;
  for (const Polygon& piece : cell.material())
    draw(piece, in_plane, section);
  return section;
}

/// A cell's cube at rest, and so much around it [m].
Box around(const Solid& solid, const CellId c, const double more) {
  const Vec3 origin = solid.grid.origin(c);
  return {origin - Vec3::Constant(more), origin + Vec3::Constant(solid.grid.h() + more)};
}

/// A little more than the cube, so that what neighbours have of the cut has no seam.
Box in_sight_of(const Solid& solid, const CellId c) { return around(solid, c, 0.01 * solid.grid.h()); }

/// With what a front in another cell may reach over by its lag.
Box reach_of(const Solid& solid, const CellId c) { return around(solid, c, grid::most_front_lag * solid.grid.h()); }

bool is_in(const Box& box, const Patch& patch) {
  const Box around = geometry::box_around(patch);
  return (around.lower.array() <= box.upper.array()).all() && (box.lower.array() <= around.upper.array()).all();
}

Polygon clipped(Polygon polygon, const Box& box) {
  for (int axis = 0; axis < 3; ++axis) {
    polygon = cut::clipped(polygon, {-Vec3::Unit(axis), -box.lower[axis]});
    polygon = cut::clipped(polygon, {Vec3::Unit(axis), box.upper[axis]});
  }
  return polygon;
}

/// One across a face.
bool has_neighbour(const Solid& solid, const CellId c, const FunctionRef<bool(CellId)> is_such) {
  for (int face = 0; face < grid::cube::n_faces; ++face)
    if (const CellId next = solid.grid.neighbour(c, face); next.valid() && is_such(next))
      return true;
  return false;
}

bool is_cut_beside(const Solid& solid, const CellId c, const FrontsOfCells& begun) {
  return has_neighbour(solid, c, [&](const CellId next) {
    return begun.contains(next) || grid::cuts_of_copies(solid, next).blades != 0;
  });
}

/// Is a line of this face parted in the cell, as cuts or a front have it?
bool divides(const Solid& solid, const CellId c, const int face, const FrontsOfCells& begun) {
  const auto at = begun.find(c);
  const grid::Segments parted = at != begun.end() ? at->second.ahead : grid::cuts_of_copies(solid, c).blades;
  return std::ranges::any_of(grid::cube::face_lines[face], [&](const int line) { return (parted >> line & 1) != 0; });
}

/// The part of a section that what is drawn covers, with its lag.
double passed(const Front& front, const Raster& section, const Raster& swept) {
  const Raster come = section & swept.grown(grid::front_lag(front.normal));
  return section.any() ? std::min(most_passed, double(come.count()) / section.count()) : 0;
}

} // namespace

/// What is swept, in the cells that it comes into.
class Advance::Sweep {
 public:
  /// `fractions`: of the way from x_before to x, at which the first and the last two points of a patch stand.
  Sweep(std::vector<Patch> patches, std::vector<std::array<double, 2>> fractions, const Solid& solid,
        const Points& x_before, const Points& x)
    : patches_(std::move(patches)),
      fractions_(std::move(fractions)),
      solid_(solid),
      x_before_(x_before),
      x_(x),
      near_(patches_) {}

  static Sweep of(const BladePath& path, const Solid& solid, const Points& x_before, const Points& x) {
    std::vector<std::array<double, 2>> fractions;
    for (std::size_t k = 1; k < path.lines.size(); ++k)
      fractions.insert(fractions.end(), path.lines[k].size() - 1, {path.fractions[k - 1], path.fractions[k]});
    return {patches(path), std::move(fractions), solid, x_before, x};
  }
  static Sweep of(const geometry::TriangleMesh& mesh, const Solid& solid, const Points& x) {
    std::vector<std::array<Vec3, 3>> triangles(mesh.triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i)
      triangles[i] = corners(mesh, i);
    return {patches(triangles), std::vector(triangles.size(), std::array{0.0, 0.0}), solid, x, x};
  }

  bool is_near(const EdgeBoxes::Block& block) const { return near_.may_be_in(block.around_cells()); }
  bool is_near(const CellId c) const { return near_.may_be_in(box_of(c)); }

  /// Calls f(polygon at rest [m]) for what lies in the reach of the cell.
  template <class Function>
  void for_each_piece(const CellId c, const Function& f) const {
    const ToRest before(solid_, c, x_before_), now(solid_, c, x_);
    const Box reach = reach_of(solid_, c);
    std::vector<std::size_t> near;
    near_.for_each(box_of(c), [&](const std::size_t i) { near.push_back(i); });
    std::ranges::sort(near);
    for (const std::size_t i : near) {
      Patch at_rest;
      for (std::size_t k = 0; k < at_rest.size(); ++k) {
        const double t = fractions_[i][k / 2];
        at_rest[k] = (1 - t) * before(patches_[i][k]) + t * now(patches_[i][k]);
      }
      if (!is_in(reach, at_rest))
        continue;
      const Polygon piece = clipped({at_rest.begin(), at_rest.end()}, reach);
      if (area(piece) > 0)
        f(piece);
    }
  }

 private:
  /// Around a cell on its way, with the lag of fronts.
  Box box_of(const CellId c) const {
    const grid::Copy& copy = solid_.complex.copies[solid_.complex.first_copy[c]];
    std::array<Vec3, 16> corners;
    for (int v = 0; v < 8; ++v) {
      corners[v] = x_[copy.corners[v].value];
      corners[8 + v] = x_before_[copy.corners[v].value];
    }
    const Box box = geometry::box_around(corners);
    const Vec3 lag = Vec3::Constant(grid::most_front_lag * (box.upper - box.lower).maxCoeff());
    return {box.lower - lag, box.upper + lag};
  }

  std::vector<Patch> patches_;
  std::vector<std::array<double, 2>> fractions_;
  const Solid& solid_;
  const Points &x_before_, &x_;
  NearSweep near_;
};

void Advance::sweep(const BladePath& path, const Solid& solid, const Points& x_before, const Points& x,
                    const EdgeBoxes& boxes, const grid::CutLabel label) {
  const bool rests = path.lines.front() == path.lines.back();
  sweep(Sweep::of(path, solid, x_before, x), solid, boxes, label, rests);
  for (const CellId c : touched_)
    for (std::vector<Polygon>* const pieces : {&cells_.at(c).pieces, &cells_.at(c).at_rest})
      if (pieces->size() > most_pieces)
        pieces->erase(pieces->begin(), pieces->end() - most_pieces);
}

void Advance::sweep(const geometry::TriangleMesh& mesh, const Solid& solid, const Points& x, const EdgeBoxes& boxes,
                    const grid::CutLabel label) {
  sweep(Sweep::of(mesh, solid, x), solid, boxes, label, false);
}

void Advance::sweep(const Sweep& sweep, const Solid& solid, const EdgeBoxes& boxes, const grid::CutLabel label,
                    const bool rests) {
  for (const std::uint32_t k : boxes.blocks([&](const EdgeBoxes::Block& block) { return sweep.is_near(block); }))
    boxes.for_each_cell(k, [&](const CellId c) {
      const bool is_whole = !solid.complex.copies[solid.complex.first_copy[c]].next.valid(),
                 has_front = ahead_ == Ahead::ends && solid.cuts.front(c) != nullptr;
      if ((is_whole || has_front || cells_.contains(c)) && sweep.is_near(c))
        sweep.for_each_piece(c, [&](const Polygon& piece) { add(solid, c, piece, label, rests); });
    });
}

void Advance::add(const Solid& solid, const CellId c, const Polygon& piece, const grid::CutLabel label,
                  const bool rests) {
  Cell& cell = cells_.emplace(c, Cell{label}).first->second;
  if (cell.label != label)
    return;
  if (const Front* const front = solid.cuts.front(c); front && ahead_ == Ahead::goes_on) {
    const InPlane in_plane(front->point, front->normal, solid.grid.h());
    const int n_new = draw(piece, in_plane, cell.swept);
    if (as_faces_)
      cell.add_fresh(*front, solid.grid.h(), clipped(piece, in_sight_of(solid, c)), n_new);
  } else {
    (rests ? cell.at_rest : cell.pieces).push_back(piece);
  }
  touched_.insert(c);
}

/// By how the blade has moved, or else by all that it has met.
std::optional<Front> Advance::front_in(const Solid& solid, const CellId c, const grid::CutLabel label) const {
  const auto at = cells_.find(c);
  const Cell not_met;
  const Cell& cell = at != cells_.end() && at->second.label == label ? at->second : not_met;
  const std::vector<Polygon>&pieces = cell.pieces, &at_rest = cell.at_rest;
  const auto around = [&](Points& points) { add_around(solid, c, label, points); };
  auto front = pieces.empty() && !at_rest.empty() ? std::nullopt : front_ahead(solid, c, pieces, label, ahead_, around);
  if (!front && !at_rest.empty()) {
    std::vector<Polygon> all = pieces;
    all.insert(all.end(), at_rest.begin(), at_rest.end());
    front = front_ahead(solid, c, all, label, ahead_, around);
  }
  return front;
}

/// What has been swept in the cells around, in part where that is much.
void Advance::add_around(const Solid& solid, const CellId c, const grid::CutLabel label, Points& points) const {
  constexpr std::size_t enough = 16; // pieces a cell
  for (const CellId next : cells_around(solid.grid, c)) {
    const auto at = cells_.find(next);
    if (next == c || at == cells_.end() || at->second.label != label)
      continue;
    const std::vector<Polygon>& pieces = at->second.pieces;
    for (std::size_t i = 0; i < pieces.size(); i += 1 + pieces.size() / enough)
      points.insert(points.end(), pieces[i].begin(), pieces[i].end());
  }
}

bool Advance::can_begin(const Solid& solid, const CellId c) const {
  return !solid.cuts.front(c) && !solid.cuts.joined(c) && grid::whole_parts_of(grid::cuts_of(solid, c)).n == 1;
}

std::vector<Front> Advance::take(const Solid& solid, const PendingCuts& pending) {
  std::vector<Front> fronts;
  FrontsOfCells begun;
  std::map<CellId, Cell> followed;
  std::vector<CellId> forgotten;
  std::set<CellId> later;
  const auto waits = [&](const CellId c) {
    return std::ranges::any_of(solid.grid.edges(c), [&](const grid::EdgeId e) { return pending.waits(e); });
  };
  for (const CellId c : touched_) {
    Cell& cell = cells_.at(c);
    const Front* const earlier = solid.cuts.front(c);
    if (earlier ? !is_ahead(solid, *earlier) : !can_begin(solid, c))
      forgotten.push_back(c);
    else if (waits(c))
      later.insert(c);
    else if (earlier && ahead_ == Ahead::ends) { // of another cut, or of a blade
      Front moved = *earlier;
      if (is_along(*earlier, cell.pieces, solid.grid.h()))
        follow(solid, moved);
      if (moved.passed > earlier->passed)
        fronts.push_back(moved);
    } else if (earlier) {
      Front moved = *earlier;
      moved.passed = passed(moved, cell.section, cell.swept);
      if (moved.passed > earlier->passed && !as_faces_)
        fronts.push_back(moved);
    } else if (auto front = front_in(solid, c, cell.label)) {
      followed.emplace(c, follow(solid, *front));
      begun.emplace(c, *front);
    }
  }
  FrontsOfCells all;
  const auto begin = [&](const Front& front, const FrontsOfCells& others, Cell&& followed) {
    if (!fits_in(solid, front, others))
      return false;
    fronts.push_back(front);
    all.emplace(front.cell, front);
    cells_[front.cell] = std::move(followed);
    return true;
  };
  const auto is_swept = [&](const Front* const front) {
    const Cell& cell = followed.at(front->cell);
    return (cell.section & cell.swept).any();
  };
  std::vector<const Front*> in_order;
  for (const auto& [c, front] : begun)
    in_order.push_back(&front);
  std::ranges::stable_sort(in_order, std::greater<>(), [&](const Front* const front) {
    return std::pair(is_swept(front), front->passed);
  });
  for (const Front* const front : in_order) {
    const CellId c = front->cell;
    Cell& cell = followed.at(c);
    const bool has_come = front->passed >= least_passed && (is_swept(front) || is_cut_beside(solid, c, all));
    const bool has_begun = has_come && begin(*front, all, std::move(cell));
    if (!has_begun && has_neighbour(solid, c, waits)) // which may be what it lacks
      later.insert(c);
  }
  for (Front& corner : corners_ahead(solid, begun, all))
    if (!waits(corner.cell)) {
      Cell cell = follow(solid, corner);
      corner.passed = std::max(corner.passed, least_passed);
      begin(corner, all, std::move(cell));
    }
  for (const CellId c : forgotten)
    cells_.erase(c);
  if (as_faces_)
    tell_where_they_have_come(solid, fronts);
  touched_ = std::move(later);
  std::ranges::sort(fronts, {}, &Front::cell);
  return fronts;
}

/// Of cells in which too little or nothing has been swept.
std::vector<Front> Advance::corners_ahead(const Solid& solid, const FrontsOfCells& found,
                                          const FrontsOfCells& begun) const {
  std::vector<Front> corners;
  const auto add = [&](const Front& front) {
    if (opens_early(solid, front, begun))
      corners.push_back(front);
  };
  for (const auto& [c, front] : found)
    if (front.passed < least_passed)
      add(front);
  std::set<CellId> known;
  for (const CellId c : touched_)
    for (int face = 0; face < grid::cube::n_faces; ++face) {
      const CellId next = solid.grid.neighbour(c, face);
      if (!next.valid() || touched_.contains(next) || !can_begin(solid, next) || !divides(solid, c, face, begun) ||
          !known.insert(next).second)
        continue;
      if (const auto front = front_in(solid, next, cells_.at(c).label))
        add(*front);
    }
  return corners;
}

/// All of them at once, when one has come on by enough: what sees them is made anew then (physics/phyxels.h).
void Advance::tell_where_they_have_come(const Solid& solid, std::vector<Front>& fronts) {
  constexpr double enough = 0.05; // squares of a cube's edge
  constexpr double texel = Raster::side / Raster::n;
  if (std::ranges::none_of(touched_, [&](const CellId c) {
        const auto at = cells_.find(c);
        return at != cells_.end() && at->second.n_fresh * texel * texel >= enough;
      }))
    return;
  for (auto& [c, cell] : cells_)
    if (const Front* const earlier = solid.cuts.front(c); earlier && cell.n_fresh > 0) {
      Front moved = *earlier;
      moved.passed = std::max(earlier->passed, passed(moved, cell.section, cell.swept));
      moved.come = cell.take_fresh(moved, solid.grid.h());
      fronts.push_back(moved);
    }
}

void Advance::Cell::add_fresh(const Front& front, const double h, const Polygon& piece, const int n_new) {
  constexpr std::size_t many = 64;
  const InPlane in_plane(front.point, front.normal, h);
  if (std::ranges::any_of(piece, [&](const Vec3& p) { return std::abs(in_plane(p)[2]) > off_plane; }))
    return;
  fresh.insert(fresh.end(), piece.begin(), piece.end());
  if (fresh.size() > many)
    fresh = hull(fresh, in_plane);
  n_fresh += n_new;
}

std::vector<Points> Advance::Cell::take_fresh(const Front& front, const double h) {
  n_fresh = 0;
  const Polygon around = hull(std::exchange(fresh, {}), InPlane(front.point, front.normal, h));
  return around.size() < 3 ? std::vector<Points>() : std::vector<Points>{around};
}

/// Sets how far the front has come, and what follows it from then on.
Advance::Cell Advance::follow(const Solid& solid, Front& front) const {
  const auto at = cells_.find(front.cell);
  const Cell not_met;
  const Cell& cell = at != cells_.end() ? at->second : not_met;
  const InPlane in_plane(front.point, front.normal, solid.grid.h());
  Cell followed{.label = front.label, .section = section_of(solid, front, in_plane)};
  for (const std::vector<Polygon>* const pieces : {&cell.pieces, &cell.at_rest})
    for (const Polygon& piece : *pieces) {
      draw(piece, in_plane, followed.swept);
      if (as_faces_)
        followed.add_fresh(front, solid.grid.h(), clipped(piece, in_sight_of(solid, front.cell)), 0);
    }
  front.passed = passed(front, followed.section, followed.swept);
  front.come = followed.take_fresh(front, solid.grid.h());
  return followed;
}

} // namespace kerf::cut
