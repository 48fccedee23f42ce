#include "tests/fuzz/states.h"

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

namespace kerf::fuzz {

using support::uniform;

namespace {

/// Applies map(position, node's rest position) to all corners.
template <class Map>
void map_corners(Subject& subject, const Map& map) {
  for (std::size_t i = 0; i < subject.x.size(); ++i)
    subject.x[i] = map(subject.x[i], subject.grid().position(subject.solid.complex.node[grid::CornerId(i)]));
}

Mat3 random_rotation(Random& random, const double angle) {
  const Vec3 axis = support::random_direction(random);
  return Eigen::AngleAxisd(uniform(random, -angle, angle), axis).toRotationMatrix();
}

/// A place of a node on one axis, so that states are degenerate exactly.
double lattice_place(const Subject& subject, Random& random, const int axis) {
  const auto node = grid::NodeId(draw(random, static_cast<int>(subject.grid().n_nodes())));
  return subject.grid().position(node)[axis];
}

std::string rigid(Subject& subject, Random& random) {
  const Mat3 R = random_rotation(random, std::numbers::pi);
  const Vec3 d = std::pow(10, uniform(random, -3, 3)) * support::random_direction(random);
  map_corners(subject, [&](const Vec3&, const Vec3& X) -> Vec3 { return R * X + d; });
  return "moved rigidly";
}

std::string stretched(Subject& subject, Random& random) {
  Mat3 F = Mat3::Identity();
  for (int i = 0; i < 3; ++i) {
    F(i, i) = std::exp(uniform(random, -2, 2));
    F(i, (i + 1) % 3) = uniform(random, -1, 1);
  }
  map_corners(subject, [&](const Vec3&, const Vec3& X) -> Vec3 { return F * X; });
  return "stretched";
}

std::string twisted(Subject& subject, Random& random) {
  const int axis = draw(random, 3);
  const double turn = uniform(random, -1, 1) / subject.grid().h(); // up to a radian a cube
  const double middle = lattice_place(subject, random, (axis + 1) % 3);
  map_corners(subject, [&](const Vec3&, const Vec3& X) -> Vec3 {
    const Vec3 centre = middle * Vec3::Unit((axis + 1) % 3);
    return centre + Eigen::AngleAxisd(turn * X[axis], Vec3::Unit(axis)) * (X - centre);
  });
  return "twisted";
}

std::string folded(Subject& subject, Random& random) {
  const int axis = draw(random, 3);
  const double crease = lattice_place(subject, random, axis);
  map_corners(subject, [&](const Vec3&, Vec3 X) {
    X[axis] = crease - std::abs(X[axis] - crease);
    return X;
  });
  return "folded over itself";
}

std::string scrambled(Subject& subject, Random& random) {
  const double size = subject.grid().h() * std::pow(10, uniform(random, -12, 0.3));
  map_corners(subject, [&](const Vec3&, const Vec3& X) -> Vec3 { return X + size * support::random_vector(random); });
  return "scrambled by " + std::to_string(size / subject.grid().h()) + " h";
}

std::string collapsed(Subject& subject, Random& random) {
  const int first = draw(random, 3), n_choice = draw(random, 6), n_axes = n_choice < 4 ? 1 : n_choice - 2;
  for (int k = 0; k < n_axes; ++k) {
    const int axis = (first + k) % 3;
    const double place = lattice_place(subject, random, axis);
    map_corners(subject, [&](Vec3 x, const Vec3&) {
      x[axis] = place;
      return x;
    });
  }
  return n_axes == 1 ? "collapsed to a plane" : n_axes == 2 ? "collapsed to a line" : "collapsed to a point";
}

std::string jitter(Subject& subject, Random& random, const double most) {
  const double size = subject.grid().h() * std::pow(10, uniform(random, -3, most));
  map_corners(subject, [&](const Vec3& x, const Vec3&) -> Vec3 { return x + size * support::random_vector(random); });
  return "jittered";
}

std::string drifted(Subject& subject, Random& random) {
  const Mat3 R = random_rotation(random, 0.3);
  const Vec3 d = subject.grid().h() * support::random_vector(random);
  const Vec3 centre = subject.x.front();
  map_corners(subject, [&](const Vec3& x, const Vec3&) -> Vec3 { return centre + R * (x - centre) + d; });
  return "drifted";
}

/// Every piece goes its own way, and virtual corners leave the node's material: cuts gape.
std::string pulled_apart(Subject& subject, Random& random) {
  const double size = subject.grid().h() * uniform(random, 0.05, 1.5);
  const grid::Pieces pieces = grid::pieces(subject.solid.complex);
  Points way(pieces.n_pieces);
  for (Vec3& d : way)
    d = size * support::random_direction(random);
  std::vector<std::uint32_t> piece(subject.solid.complex.n_corners());
  for (const auto c : ids<grid::CopyId>(subject.solid.complex.n_copies()))
    for (const auto corner : subject.solid.complex.copies[c].corners)
      piece[corner.value] = pieces.piece[c];
  for (std::size_t i = 0; i < subject.x.size(); ++i) {
    const grid::CornerId corner(i);
    subject.x[i] += way[piece[i]];
    if (subject.solid.complex.real_corner[subject.solid.complex.node[corner]] != corner)
      subject.x[i] += 0.3 * size * support::random_vector(random);
  }
  return "pulled apart";
}

} // namespace

std::string put_into_state(Subject& subject, Random& random) {
  map_corners(subject, [](const Vec3&, const Vec3& X) { return X; });
  switch (draw(random, 9)) {
    case 0:
    case 1:
      return "at rest";
    case 2:
      return rigid(subject, random);
    case 3:
      return stretched(subject, random);
    case 4:
      return twisted(subject, random);
    case 5:
      return folded(subject, random);
    case 6:
      return collapsed(subject, random);
    default:
      return scrambled(subject, random);
  }
}

std::string move(Subject& subject, Random& random) {
  switch (draw(random, 8)) {
    case 0:
      return jitter(subject, random, -0.5);
    case 1:
      return drifted(subject, random);
    case 2:
      return pulled_apart(subject, random);
    case 3:
      return put_into_state(subject, random);
    default:
      return "still";
  }
}

std::string move_gently(Subject& subject, Random& random) {
  switch (draw(random, 4)) {
    case 0:
      return jitter(subject, random, -2);
    case 1:
      return drifted(subject, random);
    default:
      return "still";
  }
}

Box reach(const Subject& subject) {
  Box box{subject.x.front(), subject.x.front()};
  for (const Vec3& p : subject.x) {
    box.lower = box.lower.cwiseMin(p);
    box.upper = box.upper.cwiseMax(p);
  }
  box.lower -= Vec3::Constant(subject.grid().h());
  box.upper += Vec3::Constant(subject.grid().h());
  return box;
}

} // namespace kerf::fuzz
