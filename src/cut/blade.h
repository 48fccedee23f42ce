#pragma once

/// A blade: a polyline that moves rigidly by key frames in world space, and the strip of triangles it sweeps (thesis
/// §2.3.3). A scalpel is one segment, a curved tool has many (blade_edge.h), scissors are two blades that share their
/// motion and turn against each other on a hinge (scissors.h).
///
/// Method: a strip is split at key frames and wherever the blade has turned by 2 degrees. Vertices are pose(t) of the
/// polyline, a function of t alone, so consecutive sweeps share theirs bit by bit and leave no gap.

#include "base/vec.h"
#include "cut/motion.h"
#include "grid/cuts.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace kerf::cut {

struct AngleFrame {
  double time = 0;  ///< [s]
  double angle = 0; ///< [degrees]
};

/// What turns a blade within its tool: about an axis, by an angle that is linear between key frames and constant
/// outside of them. On a hinge a blade cuts only while its angle falls towards 0: one that opens goes with its back
/// first, and what recoils across closed blades meets no edge.
struct Hinge {
  Vec3 pivot = Vec3::Zero(); ///< a point of the axis, tool frame [m]
  Vec3 axis = Vec3::UnitZ(); ///< unit, tool frame
  std::vector<AngleFrame> angles;
};

struct Blade {
  std::string name;
  Points edge; ///< the cutting edge, a polyline, blade frame [m]
  std::vector<KeyFrame> key_frames;
  grid::CutLabel label = 1;
  Vec3 spine = Vec3::Zero();       ///< from the cutting edge to the back, blade frame [m]; drawn only
  std::optional<Hinge> hinge = {}; ///< turns the blade's frame in the frame that the key frames move
};

/// Throws ParameterError at the path "Blade NAME/...": fewer than two points, two equal points in a row, key frames
/// that check_key_frames() refuses, a hinge without a direction or angles, or with angles that are not finite, beyond
/// 180 degrees, or at times that do not increase.
void check(const Blade& blade);

/// Divides the edge of a blade that turns into pieces of at most `longest` [m], at most 200 a segment: a piece sweeps
/// two triangles, whose normals are off by its length times how much it turns on its way [rad/m].
void divide_edge_of_turning(Blade& blade, double longest);

/// Where the blade is at time t [s]. Here and below, check() must accept the blade.
Pose pose(const Blade& blade, double t);

/// The cutting edge at time t [s], world frame [m].
Points world_points(const Blade& blade, double t);
/// The same, in the memory of `points`.
void put_world_points(const Blade& blade, double t, Points& points);

/// Where the cutting edge stands at successive moments of a step.
struct BladePath {
  std::vector<double> fractions; ///< of the step, from 0 to 1
  std::vector<Points> lines;     ///< world frame [m]
};

/// The paths on which the blade cuts in a step, in order: from key frame to key frame, so that a blade that turns back
/// cuts on its way there; on a hinge, those on which it closes.
std::vector<BladePath> paths(const Blade& blade, double t0, double t1);

/// Around all of them; nothing overlaps it when there are none [m]. Allocates nothing once it has been asked.
Box reach_of_paths(const Blade& blade, double t0, double t1);

/// The triangles between two successive places of the cutting edge; none when they are the same.
void add_strip(const Points& before, const Points& after, std::vector<std::array<Vec3, 3>>& strip);

/// The triangles [m, world frame] that the cutting edge sweeps from t0 to t1 [s]; none while the blade rests.
std::vector<std::array<Vec3, 3>> sweep(const Blade& blade, double t0, double t1);

} // namespace kerf::cut
