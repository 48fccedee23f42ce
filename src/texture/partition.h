#pragma once

/// The binary space partition of the body's inside by the planes of an ordered list of exemplars (thesis §3.4.2.1).
///
/// Each exemplar divides those cells that its picture shows at least half of; a whole section divides all that its
/// plane meets. The part of an exemplar that bounds a cell, all of it or one of its components, is a face of the cell.

#include "texture/exemplar.h"

namespace kerf::texture {

/// What a face of several components means.
enum class Components {
  one,     ///< is refused: the topology of a disk is asked for (§3.4.2.1)
  each,    ///< is one face for each component
  together ///< is one face: its pieces share a barycentre
};

/// A part of an exemplar that bounds a cell.
struct Face {
  int exemplar = 0;
  double side = 1;      ///< +1: the cell lies where the plane's normal points, -1 opposite
  image::Grey pixels;   ///< 1 what is part of it; of the chart
  std::size_t area = 0; ///< [pixels]
};

struct Cell {
  std::vector<HalfSpace> halves; ///< whose intersection it is
  std::vector<int> exemplars;    ///< of each half space
  std::vector<double> sides;
  std::vector<Face> faces;
};

/// A node divides by the plane of an exemplar; a child below zero is the cell ~child.
struct PartitionNode {
  int exemplar = 0;
  int below = ~0, above = ~0;
};

class Partition {
 public:
  /// Throws ParameterError: about "Origin [m]" if two exemplars lie in one plane, or an exemplar shows too little to
  /// divide any cell; about "Components" if a face has several and `components` is one. The complaint's value names the
  /// exemplar.
  Partition(const std::vector<Exemplar>& exemplars, const std::vector<Chart>& charts, Components components);

  const std::vector<Cell>& cells() const { return cells_; }
  /// The number of the cell that a point [m] lies in.
  int find(const Vec3& p) const;

 private:
  void divide(int exemplar, const std::vector<Chart>& charts);
  void add_faces(const std::vector<Exemplar>& exemplars, const std::vector<Chart>& charts, Components components);

  std::vector<SectionPlane> planes_;
  std::vector<PartitionNode> nodes_;
  std::vector<Cell> cells_;
};

} // namespace kerf::texture
