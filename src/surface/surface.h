#pragma once

/// The closed surface of a cut body (thesis §2.4, §2.5) and how it follows the corners: x_surface = W x_corners.
///
/// For each cut edge, each of its material ends s and each of the (up to four) cells around it, one quadrilateral,
/// split along the diagonal edge vertex - centre, which both sides of a cut share. A vertex takes the weights of its
/// place in its copy: linear on an edge, bilinear in a face, trilinear in a cell (§2.4.4, with corners as unknowns
/// instead of extrapolated frames).

#include "grid/complex.h"

#include <Eigen/SparseCore>

namespace kerf::surface {

using Weights = Eigen::SparseMatrix<double, Eigen::RowMajor, int>;

struct Surface {
  Points rest;                        ///< rest positions of the vertices [m]
  std::vector<Triangle> triangles;    ///< counter-clockwise from outside
  std::vector<grid::CutLabel> labels; ///< per triangle: which cut made it; 0 is the skin
  std::vector<grid::CopyId> copies;   ///< per triangle: the copy whose material it bounds
  Weights weights;                    ///< W: n_vertices x n_corners [1]; rows sum to 1
};

Surface build_surface(const grid::Grid& grid, const grid::Cuts& cuts, const grid::CellComplex& complex);

/// x_surface = W x_corners [m].
void follow(const Surface& surface, const Points& corners, Points& positions);

/// Signed volume that closed triangles enclose [m^3].
double enclosed_volume(const Points& positions, const std::vector<Triangle>& triangles);

/// Rest volume of each piece [m^3], from the triangles.
std::vector<double> piece_volumes(const Surface& surface, const grid::CellComplex& complex);

} // namespace kerf::surface
