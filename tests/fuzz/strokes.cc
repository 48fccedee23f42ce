#include "tests/fuzz/strokes.h"

#include "tests/fuzz/states.h"

#include <algorithm>
#include <cmath>

namespace kerf::fuzz {

using support::uniform;

namespace {

/// Every other one reaches across the whole body along an axis.
Points random_edge(const Box& reach, Random& random) {
  Points line(2 + draw(random, 3));
  for (Vec3& p : line)
    p = random_point(random, reach);
  if (const int axis = draw(random, 6); axis < 3) {
    line.front()[axis] = reach.lower[axis];
    line.back()[axis] = reach.upper[axis];
  }
  return line;
}

cut::Blade random_blade(const Subject& subject, const grid::CutLabel label, Random& random) {
  const Box reach = fuzz::reach(subject);
  const double h = subject.grid().h(), size = (reach.upper - reach.lower).norm();
  const Points line = random_edge(reach, random);
  cut::Blade blade;
  blade.label = label;
  blade.name = "blade " + std::to_string(label);
  for (const Vec3& p : line)
    blade.edge.push_back(p - line[0]);
  const bool turns = draw(random, 3) == 0;
  const int n_frames = 1 + draw(random, 3);
  Vec3 place = line[0], way = support::random_direction(random);
  blade.key_frames.push_back({0, place});
  for (int k = 1; k <= n_frames; ++k) {
    const double length = draw(random, 2) ? uniform(random, 0, size) : uniform(random, 0, 4 * h);
    switch (draw(random, 8)) {
      case 0: // rests
        break;
      case 1: // comes back
        way = -way;
        [[fallthrough]];
      default:
        place += length * way;
    }
    cut::KeyFrame& frame = blade.key_frames.emplace_back(cut::KeyFrame{double(k), place});
    if (turns)
      frame.rotation = uniform(random, 0, 60) * support::random_direction(random);
  }
  if (turns)
    cut::divide_edge_of_turning(blade, 2 * h);
  cut::check(blade);
  return blade;
}

} // namespace

Strokes random_strokes(const Subject& subject, const grid::CutLabel first, Random& random) {
  Strokes strokes;
  const int n_blades = draw(random, 4) == 0 ? 2 : 1;
  for (int k = 0; k < n_blades; ++k)
    strokes.blades.push_back(random_blade(subject, static_cast<grid::CutLabel>(first + k), random));
  double end = 0;
  std::size_t n_turning = 0;
  for (const cut::Blade& blade : strokes.blades) {
    end = std::max(end, blade.key_frames.back().time);
    n_turning += blade.key_frames.back().rotation.norm() > 0;
  }
  const int n_steps = 1 + draw(random, 24);
  strokes.times = {uniform(random, -0.2, 0.5)};
  for (int k = 1; k <= n_steps; ++k)
    strokes.times.push_back(strokes.times.back() +
                            (end + 0.3) / n_steps * (draw(random, 2) ? 1 : std::pow(10, uniform(random, -2, 0.3))));
  strokes.name = std::to_string(n_blades) + (n_blades > 1 ? " blades" : " blade") +
                 (n_turning > 0 ? " that turns, in " : " in ") + std::to_string(n_steps) + " steps";
  return strokes;
}

} // namespace kerf::fuzz
