#pragma once

/// Warps between the faces of a cell (thesis §3.4.3.1.1), as tables of where a pixel of one face goes on the others.
///
/// Two faces of a cell are aligned by the rotation that takes the one through the cell into the other, about the line
/// in which their planes meet, or along the normal where they are parallel; then their boxes are made to match, one
/// axis being that line, or where there is none the direction in which the two are longest; then features are matched
/// (warp/match.h), each way: a warp is midway between what one match found and what undoes the other. So how a picture
/// is stored, and which exemplar stands first, makes no difference but by interpolation.

#include "texture/partition.h"
#include "warp/match.h"

namespace kerf::texture {

/// A point of one exemplar that goes to a point of another, wherever both bound a cell.
struct ExemplarPin {
  std::string name;
  std::array<std::string, 2> exemplars; ///< their names
  std::array<Vec3, 2> points;           ///< rest frame [m]
};

/// Which faces of a cell are warped to each other; those that a pin joins always are.
enum class Partners {
  all,   ///< all, as in the thesis
  facing ///< those that face each other, within 45 degrees: what lies at an angle is mixed as it is
};

struct WarpOptions {
  Partners partners = Partners::all;
  warp::MatchOptions match; ///< without pins
  int pixels = 192;         ///< of the longer side of what is matched
  std::vector<ExemplarPin> pins;
};

/// Throws ParameterError about the key "From [m]" or "To [m]", its value the pin's name, if a point lies off its
/// exemplar's plane, the exemplars share no cell, or a point lies outside of the parts of its exemplar that bound those
/// cells.
void check_pins(const std::vector<ExemplarPin>& pins, const std::vector<Cell>& cells,
                const std::vector<Exemplar>& exemplars, const std::vector<Chart>& charts);

/// The rectangle of a face as a partner sees it.
struct Aligned {
  Vec2 lower; ///< of the box, along `a` and `b` [m]
  Vec2 size;  ///< [m]
  Vec3 a, b;  ///< unit, in the plane
};
struct AlignedPair {
  Aligned from, to;
  int width = 0, height = 0; ///< [pixels] of both
};
AlignedPair align(const Face& from, const Chart& from_chart, const Face& to, const Chart& to_chart, int pixels);

/// Maps between the pixels of two aligned boxes.
using warp::BothWays;
BothWays match_faces(const Face& from, const Chart& from_chart, const Face& to, const Chart& to_chart,
                     const AlignedPair& pair, const warp::MatchOptions& options);

/// Whether two faces are warped to each other.
bool are_partners(const Face& from, const Face& to, const std::vector<Exemplar>& exemplars,
                  const std::vector<Chart>& charts, const WarpOptions& options);

/// Where the pixels of a face go on all faces of its cell: a lattice over the face's box, with one target a face at
/// each node.
struct WarpTable {
  int n_columns = 0, n_rows = 0;
  int n_numbers = 0; ///< of a node: two a face, and zeros up to a multiple of 4, which is what processors take at once
  float left = 0, top = 0; ///< of the first node [pixels of the chart]
  float columns_by_pixel = 0, rows_by_pixel = 0;
  std::vector<float>
    targets; ///< node by node: x, y on each face [pixels of its chart]; zero for itself and for no partners

  const float* node(const int c, const int r) const { return &targets[n_numbers * (r * n_columns + c)]; }
};

/// All warps of a cell: of its partners alone. `known` are the maps of pairs (i, j), i < j in order of i, then j, found
/// earlier; what was used is left in `used`.
std::vector<WarpTable> make_warps(const Cell& cell, const std::vector<Exemplar>& exemplars,
                                  const std::vector<Chart>& charts, const WarpOptions& options,
                                  const std::vector<BothWays>& known, std::vector<BothWays>& used);

/// The linear part of the map from chart pixels of face `from` to those of face `to`, before features are matched.
Mat2 aligned_linear(const AlignedPair& pair, const Chart& from, const Chart& to);

} // namespace kerf::texture
