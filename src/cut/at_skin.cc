#include "cut/at_skin.h"

#include "cut/part_face.h"
#include "grid/touched.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>
#include <functional>
#include <iterator>
#include <optional>
#include <utility>

namespace kerf::cut {

namespace cube = grid::cube;
using grid::CellCuts;
using grid::CellId;
using grid::EdgeId;
using grid::FaceId;
using grid::Seam;
using grid::SkinArc;

namespace {

/// May the skin of an arc be said to be whole? Not where it has been parted, said or unsaid.
bool may_be_whole(const CellCuts& cell, const int face, const SkinArc& arc, const unsigned new_lines) {
  return cell.seams[face] == Seam::whole ||
         (cell.seams[face] == Seam::unsaid && (cell.cut & arc.inner & ~new_lines) == 0);
}

bool is_between_nodes(const CellCuts& cell, const int line) {
  return !(cell.skin >> line & 1) && (cell.cut >> line & 1);
}

/// The mean plane of the inner cuts of some lines of a cell, in the rest configuration.
class RestPlane {
 public:
  RestPlane(const grid::Solid& solid, const CellId c, const unsigned lines) {
    const auto edges = solid.grid.edges(c);
    Vec3 sum = Vec3::Zero();
    for (unsigned left = lines; left != 0; left &= left - 1) {
      const EdgeId e = edges[std::countr_zero(left)];
      const Vec3& normal = solid.cuts.find(e)->normal;
      sum += grid::edge_point(solid, e);
      normal_ += normal_.dot(normal) < 0 ? Vec3(-normal) : normal;
    }
    point_ = sum / std::popcount(lines);
  }

  bool parts(const Vec3& p, const Vec3& q) const {
    return (normal_.dot(p - point_) < 0) != (normal_.dot(q - point_) < 0);
  }

 private:
  Vec3 point_, normal_ = Vec3::Zero();
};

/// An edge that is crossed again keeps the cut that it has (grid/cuts.h), so that beside such edges there is none to
/// tell whether a surface parts the skin: the plane of what it cuts in the same cell tells, by the side on which the
/// skin's edges end.
class CrossedAgain {
 public:
  /// `is_own` says of an edge that is cut whether the surface has cut it.
  CrossedAgain(const grid::Solid& solid, std::function<bool(EdgeId)> is_own)
    : solid_(solid), is_own_(std::move(is_own)) {}

  bool is_beside_others(const CellId c, const CellCuts& cell, const SkinArc& arc) const {
    const auto edges = solid_.grid.edges(c);
    unsigned lines = cell.blades() & CellCuts::beside(arc);
    for (; lines != 0; lines &= lines - 1)
      if (!is_own_(edges[std::countr_zero(lines)]))
        return true;
    return false;
  }
  bool parts(const RestPlane& plane, const CellId c, const SkinArc& arc) const {
    const auto edges = solid_.grid.edges(c);
    return plane.parts(grid::edge_skin_point(solid_, edges[arc.lines[0]]),
                       grid::edge_skin_point(solid_, edges[arc.lines[1]]));
  }

  /// Calls part(cell, face) where the plane of what has been cut in a cell parts skin that is whole beside edges of
  /// others: in the cell, around those of its edges that it crosses again, and once more around those of these cells.
  template <class Part>
  void for_each_parted(const RestPlane& plane, const CellId c, const Part& part) const {
    constexpr int n_rings = 2; // with 1, three planes left a bridge in 6 of 12,000 bodies; with more, in no fewer
    std::vector<CellId> seen = {c};
    std::size_t begin = 0;
    for (int ring = 0; ring <= n_rings; ++ring) {
      const std::size_t end = seen.size();
      for (; begin < end; ++begin) {
        const CellId at = seen[begin];
        const CellCuts cell = grid::cuts_of(solid_, at);
        for_each_parted_in(plane, at, cell, part);
        if (ring == n_rings)
          continue;
        const auto edges = solid_.grid.edges(at);
        for (unsigned lines = cell.blades(); lines != 0; lines &= lines - 1)
          if (const EdgeId e = edges[std::countr_zero(lines)]; !is_own_(e) && crosses(plane, e))
            for (const CellId other : solid_.grid.cells(e))
              if (other.valid() && std::find(seen.begin(), seen.end(), other) == seen.end())
                seen.push_back(other);
      }
    }
  }

 private:
  template <class Part>
  void for_each_parted_in(const RestPlane& plane, const CellId c, const CellCuts& cell, const Part& part) const {
    for (int face = 0; face < cube::n_faces; ++face)
      for (const SkinArc& arc : grid::skin_arcs(face, cell.material))
        if (cell.is_whole(face, arc) && is_beside_others(c, cell, arc) && parts(plane, c, arc))
          part(c, face);
  }

  /// Does it cross the edge in the body?
  bool crosses(const RestPlane& plane, const EdgeId e) const {
    const auto end = [&](const grid::NodeId n) {
      return solid_.grid.is_material(n) ? solid_.grid.position(n) : grid::edge_skin_point(solid_, e);
    };
    return plane.parts(end(solid_.grid.ends(e)[0]), end(solid_.grid.ends(e)[1]));
  }

  const grid::Solid& solid_;
  std::function<bool(EdgeId)> is_own_;
};

/// Where the planes of new cuts go in the faces of the skin.
class Ways {
 public:
  Ways(const grid::Solid& solid, const Points& x, const std::span<const EdgeId> new_edges)
    : solid_(solid), x_(x), new_(new_edges.begin(), new_edges.end()) {
    std::sort(new_.begin(), new_.end());
  }

  bool goes_on(const grid::EdgeCut& cut) const {
    const Here plane = here(cut.edge, cut);
    for (const CellId c : solid_.grid.cells(cut.edge)) {
      if (!c.valid())
        continue;
      const CellCuts cell = grid::cuts_of(solid_, c);
      const auto edges = solid_.grid.edges(c);
      const int line = static_cast<int>(std::find(edges.begin(), edges.end(), cut.edge) - edges.begin());
      for (int face = 0; face < cube::n_faces; ++face)
        for (const SkinArc& arc : grid::skin_arcs(face, cell.material)) {
          if ((arc.lines[0] != line && arc.lines[1] != line) || !may_be_whole(cell, face, arc, new_lines(c)))
            continue;
          const auto way_out = leave(c, face, line, arc, plane);
          if (cut_beside(c, cell, arc, cut.label) != 0 || (way_out && stays_below(c, cell, arc, *way_out)))
            return true;
        }
    }
    return false;
  }

 protected:
  static constexpr double margin = 10 * grid::min_edge_parameter;

  /// The plane of a cut as the body stands now.
  struct Here {
    Vec3 point, normal;
    double height(const Vec3& p) const { return normal.dot(p - point); }
  };

  bool is_new(const EdgeId e) const { return std::binary_search(new_.begin(), new_.end(), e); }

  unsigned new_lines(const CellId c) const {
    unsigned lines = 0;
    const auto edges = solid_.grid.edges(c);
    for (int line = 0; line < cube::n_lines; ++line)
      lines |= unsigned(is_new(edges[line])) << line;
    return lines;
  }

  Here here(const EdgeId e, const grid::EdgeCut& cut) const {
    const EdgeEnds ends = ends_of(solid_, e);
    const Vec3 &lower = x_[ends.corners[0].value], &upper = x_[ends.corners[1].value];
    const Mat3 F = gradient_on(solid_, x_, e, cut.t);
    Mat3 cofactors; // F^-T, but for a factor
    cofactors << F.col(1).cross(F.col(2)), F.col(2).cross(F.col(0)), F.col(0).cross(F.col(1));
    return {lower + cut.t * (upper - lower), cofactors * cut.normal};
  }

  /// Where a plane leaves a face.
  struct WayOut {
    int line;
    double t; ///< on the line's edge [1]
  };

  /// The lines beside an arc that a blade has cut.
  unsigned cut_beside(const CellId c, const CellCuts& cell, const SkinArc& arc, const grid::CutLabel label) const {
    unsigned lines = 0;
    const auto edges = solid_.grid.edges(c);
    for (int line = 0; line < cube::n_lines; ++line)
      if (cell.blades() & CellCuts::beside(arc) & 1u << line)
        lines |= unsigned(solid_.cuts.find(edges[line])->label == label) << line;
    return lines;
  }

  /// Nothing where the plane crosses all lines of a face that is warped.
  std::optional<WayOut> leave(const CellId c, const int face, const int from, const SkinArc& arc,
                              const Here& plane) const {
    const grid::Copy& copy = solid_.complex.copies[solid_.complex.copy_at(c, arc.vertices[0])];
    const auto height = [&](const int v) { return plane.height(x_[copy.corners[v].value]); };
    std::optional<WayOut> found;
    for (const int line : cube::face_lines[face]) {
      const auto& [v, w] = cube::line_vertices[line];
      const double a = height(v), b = height(w);
      if (line == from || (a < 0) == (b < 0))
        continue;
      if (found)
        return std::nullopt;
      found = WayOut{line, a / (a - b)};
    }
    return found;
  }

  /// Does the way out lead through material beside the arc, and not through the skin?
  bool stays_below(const CellId c, const CellCuts& cell, const SkinArc& arc, const WayOut& way_out) const {
    if (!(CellCuts::beside(arc) >> way_out.line & 1))
      return false;
    if (!(cell.skin >> way_out.line & 1))
      return true;
    const EdgeId e = solid_.grid.edges(c)[way_out.line];
    const double skin = solid_.cuts.find_outer(e)->t;
    return solid_.grid.is_material(solid_.grid.ends(e)[0]) ? way_out.t < skin - margin : way_out.t > skin + margin;
  }

  const grid::Solid& solid_;
  const Points& x_;
  std::vector<EdgeId> new_; // ascending
};

/// Follows the cuts of edges through the faces of the skin.
class Ends : private Ways {
 public:
  Ends(grid::Solid& solid, const Points& x, const std::span<const EdgeId> new_edges)
    : Ways(solid, x, new_edges), changing_(solid) {}

  std::vector<EdgeId> run() {
    const std::vector<EdgeId> given = new_;
    for (const EdgeId e : given)
      follow(e);
    for (std::size_t i = 0; i < along_.size(); ++i) // they cut no further edges
      follow(along_[i]);
    part_passed();
    part_crossed();
    std::vector<EdgeId> result = along_;
    result.insert(result.end(), parted_.begin(), parted_.end());
    return result;
  }

 private:
  void follow(const EdgeId e) {
    const grid::EdgeCut cut = *solid_.cuts.find(e);
    std::optional<Here> plane; // most edges have no skin around them
    std::vector<FaceId> done;
    for (const CellId c : solid_.grid.cells(e)) {
      if (!c.valid() || !has_skin(c))
        continue;
      if (!plane)
        plane = here(e, cut);
      const auto edges = solid_.grid.edges(c);
      const auto faces = solid_.grid.faces(c);
      const int line = static_cast<int>(std::find(edges.begin(), edges.end(), e) - edges.begin());
      for (int face = 0; face < cube::n_faces; ++face)
        if (std::ranges::find(cube::face_lines[face], line) != cube::face_lines[face].end() &&
            std::find(done.begin(), done.end(), faces[face]) == done.end()) {
          done.push_back(faces[face]);
          follow_in(c, face, line, cut, *plane);
        }
    }
  }

  bool has_skin(const CellId c) const {
    return std::ranges::any_of(solid_.grid.nodes(c), [&](const grid::NodeId n) { return !solid_.grid.is_material(n); });
  }

  /// Through a face of a cell, from one of its lines.
  void follow_in(const CellId c, const int face, const int line, const grid::EdgeCut& cut, const Here& plane) {
    const CellCuts cell = grid::cuts_of(solid_, c);
    for (const SkinArc& arc : grid::skin_arcs(face, cell.material)) {
      if (!(CellCuts::beside(arc) >> line & 1) || !may_be_whole(cell, face, arc, new_lines(c)))
        continue;
      const unsigned by_label = cut_beside(c, cell, arc, cut.label);
      const auto way_out = std::popcount(by_label) == 1 ? leave(c, face, line, arc, plane) : std::nullopt;
      const bool stays = std::popcount(by_label) == 2 || (way_out && stays_below(c, cell, arc, *way_out));
      if (!stays)
        part(c, face);
      else if (!way_out || is_between_nodes(cell, line) || !(cell.skin >> way_out->line & 1))
        changing_.cuts.set_seam(solid_.grid.faces(c)[face], Seam::whole); // else it is, unsaid
      if (stays && way_out && is_between_nodes(cell, line))
        cut_along(c, cell, way_out->line, way_out->t, plane, cut.label);
    }
  }

  void cut_along(const CellId c, const CellCuts& cell, const int line, const double t, const Here& plane,
                 const grid::CutLabel label) {
    if (!((cell.skin & ~cell.twice) >> line & 1))
      return;
    const EdgeId e = solid_.grid.edges(c)[line];
    changing_.cuts.add(solid_.grid, {e, t, pulled_back(solid_, x_, e, t, plane.normal), label});
    along_.push_back(e);
    new_.insert(std::lower_bound(new_.begin(), new_.end(), e), e);
  }

  void part(const CellId c, const int face) {
    if (solid_.cuts.seam(solid_.grid.faces(c)[face]) != Seam::parted)
      part_face(changing_, c, face, parted_);
  }

  /// Where a blade has cut below one end of an arc, and elsewhere beside the node at its other end without cutting that
  /// off, it has passed between the two, though the plane of the first cut does not say so. Where the second cut has
  /// that node, or the skin beside it, on its other side, the blade has yet to come to the edges between.
  void part_passed() {
    for (const auto& [c, lines] : grid::touched_cells(solid_.grid, new_)) {
      const CellCuts cell = grid::cuts_of(solid_, c);
      if (cell.twice == 0)
        continue;
      const auto edges = solid_.grid.edges(c);
      const auto nodes = solid_.grid.nodes(c);
      for (int face = 0; face < cube::n_faces; ++face)
        for (const SkinArc& arc : grid::skin_arcs(face, cell.material))
          for (const int end : {0, 1}) {
            const int cut_off = arc.lines[end], kept = arc.lines[1 - end];
            if ((cell.cut & arc.inner) != 0 || cell.seams[face] == Seam::parted || !(cell.twice >> cut_off & 1) ||
                (cell.twice >> kept & 1))
              continue;
            const grid::CutLabel label = solid_.cuts.find(edges[cut_off])->label;
            const int out = cube::line_at(arc.vertices[1 - end], cube::face_axis(face));
            if (!is_between_nodes(cell, out) || solid_.cuts.find(edges[out])->label != label)
              continue;
            const grid::NodeId node = nodes[arc.vertices[1 - end]];
            const bool passes_skin = RestPlane(solid_, c, 1u << out)
                                       .parts(solid_.grid.position(node), grid::edge_skin_point(solid_, edges[kept]));
            if (!passes_skin && are_on_one_side(nodes[arc.vertices[end]], edges[cut_off], node, edges[out]))
              part(c, face);
          }
    }
  }

  /// By blades that have met the cuts of others.
  void part_crossed() {
    for (const auto& [c, lines] : grid::touched_cells(solid_.grid, new_))
      for (unsigned left = lines; left != 0;) {
        const grid::CutLabel label = solid_.cuts.find(solid_.grid.edges(c)[std::countr_zero(left)])->label;
        const unsigned of_label = left & with_label(c, label);
        left &= ~of_label;
        const CrossedAgain again(solid_, [&](const EdgeId e) { return solid_.cuts.find(e)->label == label; });
        again.for_each_parted(RestPlane(solid_, c, of_label), c,
                              [&](const CellId other, const int face) { part(other, face); });
      }
  }

  /// The lines whose inner cut has a label.
  unsigned with_label(const CellId c, const grid::CutLabel label) const {
    unsigned lines = 0;
    const auto edges = solid_.grid.edges(c);
    for (int line = 0; line < cube::n_lines; ++line)
      if (const grid::EdgeCut* const cut = solid_.cuts.find(edges[line]))
        lines |= unsigned(cut->label == label) << line;
    return lines;
  }

  /// Of one surface that has cut an edge of each of two nodes, in the rest configuration.
  bool are_on_one_side(const grid::NodeId a, const EdgeId of_a, const grid::NodeId b, const EdgeId of_b) const {
    const Vec3 &at_a = solid_.cuts.find(of_a)->normal, &at_b = solid_.cuts.find(of_b)->normal;
    const double height_a = at_a.dot(solid_.grid.position(a) - grid::edge_point(solid_, of_a));
    const double height_b = at_b.dot(solid_.grid.position(b) - grid::edge_point(solid_, of_b));
    return (height_a < 0) == ((at_a.dot(at_b) < 0 ? -height_b : height_b) < 0);
  }

  grid::Solid& changing_;
  std::vector<EdgeId> along_;  // that were cut along with them
  std::vector<EdgeId> parted_; // cut edges at faces whose skin is parted
};

} // namespace

void part_skin(grid::Solid& solid, std::vector<grid::EdgeId>& new_edges) {
  std::vector<EdgeId> own = new_edges, parted;
  std::sort(own.begin(), own.end());
  const CrossedAgain again(solid, [&](const EdgeId e) { return std::binary_search(own.begin(), own.end(), e); });
  const auto touched = grid::touched_cells(solid.grid, new_edges);
  for (const auto& [c, new_lines] : touched) {
    const CellCuts cell = grid::cuts_of(solid, c);
    if (cell.skin == 0)
      continue;
    const auto faces = solid.grid.faces(c);
    const RestPlane plane(solid, c, new_lines);
    for (int face = 0; face < cube::n_faces; ++face) {
      bool is_cut = false, leaves = false;
      for (const SkinArc& arc : grid::skin_arcs(face, cell.material)) {
        const unsigned lines = new_lines & CellCuts::beside(arc);
        is_cut |= lines != 0;
        leaves |= !may_be_whole(cell, face, arc, new_lines) ||
                  (again.is_beside_others(c, cell, arc) ? again.parts(plane, c, arc) : std::popcount(lines) % 2 != 0);
      }
      if (is_cut)
        solid.cuts.set_seam(faces[face], leaves ? Seam::parted : Seam::whole);
    }
  }
  for (const auto& [c, new_lines] : touched)
    again.for_each_parted(RestPlane(solid, c, new_lines), c,
                          [&](const CellId other, const int face) { part_face(solid, other, face, parted); });
  std::sort(parted.begin(), parted.end());
  parted.erase(std::unique(parted.begin(), parted.end()), parted.end());
  std::set_difference(parted.begin(), parted.end(), own.begin(), own.end(), std::back_inserter(new_edges));
}

std::vector<grid::EdgeCut> cuts_that_go_on(const grid::Solid& solid, const Points& x,
                                           const std::span<const grid::EdgeId> new_edges,
                                           const std::span<const grid::EdgeCut> of_skin) {
  const Ways ways(solid, x, new_edges);
  std::vector<grid::EdgeCut> result;
  for (const grid::EdgeCut& cut : of_skin)
    if (ways.goes_on(cut))
      result.push_back(cut);
  return result;
}

std::vector<grid::EdgeId> end_at_skin(grid::Solid& solid, const Points& x,
                                      const std::span<const grid::EdgeId> new_edges) {
  return Ends(solid, x, new_edges).run();
}

} // namespace kerf::cut
