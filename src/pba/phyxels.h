#pragma once

/// The samples of a body (thesis §2.1.7; Mueller and others 2004): rest positions, the volume that each
/// stands for, and its support, which holds about k neighbours.
///
/// Volumes are those of the body's Voronoi cells around the phyxels: the material is split into parts far smaller than
/// a phyxel, and each goes to the nearest one. So they sum to the body's volume, and a phyxel at the skin counts what
/// is there. Departs from Mueller and others, who take mass over density by kernel sums: these know no skin, and give
/// a phyxel on a face twice the volume of one inside, on an edge four times.

#include "grid/solid.h"
#include "pba/sampling.h"

namespace kerf::pba {

struct Crumb;

struct Phyxels {
  Points rest;                 ///< [m]
  std::vector<double> volume;  ///< [m^3]
  std::vector<double> support; ///< [m]

  std::size_t size() const { return rest.size(); }
};

struct PhyxelOptions {
  SamplingOptions sampling = {};
  int n_neighbours = 30; ///< of a phyxel inside the body
  double support = 0;    ///< [m]; 0: by n_neighbours

  void describe(Parameters& p) {
    sampling.describe(p);
    p.integer("Neighbours [1]", n_neighbours, {.min = 3}, "Nearest phyxels that a phyxel's support holds.");
    p.number("Support [m]", support, non_negative, "Radius in which phyxels count for each other; 0: by Neighbours.");
  }
};

/// By how much a cut seems too short to phyxels that see its faces [m]: .4 of the distance between them, which is the cube
/// root of their mean volume. Measured on the openings of 18 penny-shaped cuts of 2.7 to 6 cubes a radius: by extended
/// visibility .33, .42, .41 with distances of .65, 1, 1.5 cubes, by plain visibility .31.
double front_lag(const Phyxels& phyxels);

/// Fills the material of a body. Throws ParameterError for fewer than 4 phyxels, and where make_supports() does.
Phyxels fill(const grid::Solid& solid, const PhyxelOptions& options);

/// Volume [m^3] of each point: that of the parts of which it is the nearest point. A point that is the nearest of none
/// takes a thousandth of the mean; then all are scaled to the sum of the parts.
std::vector<double> voronoi_volumes(const Points& points, const std::vector<Crumb>& parts);

/// Supports that hold the n_neighbours nearest points: halfway to the next one; half as far again as the farthest where
/// there are no more. Or options.support for all. Throws ParameterError for a support that holds no other point.
std::vector<double> make_supports(const Points& points, const PhyxelOptions& options);

} // namespace kerf::pba
