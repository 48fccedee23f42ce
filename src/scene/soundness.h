#pragma once

/// Whether a body may still be what it says: asked after each step, of every backend and integrator; of volumes in the
/// first step, after each cut, as soon as something can have moved by an eighth of a cube since they were asked for, and
/// at the end.
///
/// Four things no elastic body does. A particle without a finite place. A particle that crosses more than a cube in a
/// step against the mean motion while all kinetic and elastic energy of the body could not move an eighth of a full
/// cube, which is the least that a corner of whole cubes has, that fast: what moves so is lighter than anything that
/// the grid resolves. A piece that is inside out, or crushed to a tenth or blown up to ten times its volume (at small
/// strain by a quarter), or a body with a tenth of its copies inside out: volumes are those of copies in their middle,
/// weighed by their nodes. And a copy of which an edge is 32 times as long as at rest. The last two are borne where the
/// initial state gave the body an energy with which it may come there, and it has at most a quarter more.

#include "scene/body.h"

#include <limits>

namespace kerf::scene {

struct Watch {
  bool is_sound = true; ///< what was found last
  double way = std::numeric_limits<double>::infinity(); ///< of any corner against the mean motion since then, at most
                                                        ///< [m]; infinite where volumes were never asked for

  void archive(Archive& a) { a(is_sound, way); }
};

/// After a step of dt [s] from `before` [m], before the corners follow. Velocities may ring where nothing damps them,
/// and statics go far without any: the less of a velocity and of the way over dt counts, where that is more than a cube
/// and more than a corner of so distorted copies may snap. Throws NumericalError that names the particle and its place.
/// Returns how far a particle has come against the mean motion, at most [m].
double require_sound_motion(const Body& body, const Points& before, double dt);
/// The copy whose cube is drawn out most.
struct Stretch {
  std::size_t copy = 0;
  double factor = 0; ///< its longest edge over that at rest [1]
};
/// Of all copies but those of crumbs, which are rigid.
Stretch largest_stretch(const Body& body);

/// What of a body's volumes no elastic body has, as said above, and what helps.
struct UnsoundVolume {
  std::string what, remedy; ///< empty where they are sound
};
UnsoundVolume unsound_volume(const Body& body);
/// After the corners followed; where these are not the particles, and in the `last` step, whatever the way was. Pieces
/// of fewer than eight nodes are left out. Throws NumericalError that names the piece, its worst copy and its place.
void require_sound_volume(const Body& body, Watch& watch, bool is_last);

/// "particle 12, which rests at (0.1, 0.2, 0.3) m".
std::string particle_at(const Body& body, std::size_t particle);

} // namespace kerf::scene
