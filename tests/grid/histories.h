#pragma once

/// Random cuts of a body, of edges of the skin and of the skin's own segments among them, and random orders in which
/// they may come.

#include "grid/cuts.h"
#include "tests/support/bodies.h"

#include <algorithm>
#include <bit>
#include <set>
#include <vector>

namespace kerf::grid::histories {

using support::Body;
using support::Random;
using support::uniform;

/// Cuts that a body gets; or that it gets at once, in one step.
struct Plan {
  std::vector<EdgeCut> cuts;
  std::vector<SkinCut> of_skin = {};

  bool empty() const { return cuts.empty() && of_skin.empty(); }
  std::size_t size() const { return cuts.size() + of_skin.size(); }
  std::vector<EdgeId> edges() const {
    std::vector<EdgeId> result;
    for (const EdgeCut& cut : cuts)
      result.push_back(cut.edge);
    return result;
  }
  std::vector<SkinSegment> segments() const {
    std::vector<SkinSegment> result;
    for (const SkinCut& cut : of_skin)
      result.push_back(cut.segment);
    return result;
  }
};
using Step = Plan;

/// Second cuts between node and skin, each with a probability; one in four at the node or next to the skin.
inline std::vector<EdgeCut> random_second_cuts(Random& random, const Body& body, const double probability) {
  std::vector<EdgeCut> cuts;
  for (const EdgeId e : body.grid.skin_edges()) {
    const double node = body.grid.is_material(body.grid.ends(e)[0]) ? 0 : 1, skin = body.cuts.find_outer(e)->t;
    const double part = random() % 4 != 0 ? uniform(random, 0, 1) : random() % 2 ? 0.0 : 1 - 1e-9;
    const double t = node + part * (skin - node);
    if (uniform(random, 0, 1) < probability && body.cuts.can_be_cut(body.grid, e) && support::is_below_skin(body, e, t))
      cuts.push_back({e, t, support::random_direction(random), 1});
  }
  return cuts;
}

/// All segments of the body's skin, ascending.
inline std::set<SkinSegment> skin_segments(const Grid& grid) {
  std::set<SkinSegment> all;
  for (const auto c : ids<CellId>(grid.n_cells()))
    for (Segments left = skeleton_of(material_of(grid, c)).segments & ~skeleton::lines; left != 0; left &= left - 1)
      all.insert(skin_segment(grid, c, std::countr_zero(left)));
  return all;
}

/// Segments of the skin that are not cut, each with a probability; one in four next to an end.
inline std::vector<SkinCut> random_skin_cuts(Random& random, const Body& body, const double probability) {
  std::vector<SkinCut> cuts;
  for (const SkinSegment& segment : skin_segments(body.grid))
    if (!body.cuts.is_cut(segment) && uniform(random, 0, 1) < probability) {
      const double t = random() % 4 != 0 ? uniform(random, 0, 1) : random() % 2 ? -0.1 : 1.1;
      cuts.push_back({segment, t, support::random_direction(random), 1});
    }
  return cuts;
}

/// A body with only its skin cut gets cuts of edges inside, of edges of the skin below it, and of the skin, each with
/// its probability.
inline Plan random_plan(Random& random, const Body& body, const double inner, const double second, const double skin) {
  Plan plan{support::random_cuts(random, body, inner)};
  const auto below_skin = random_second_cuts(random, body, second);
  plan.cuts.insert(plan.cuts.end(), below_skin.begin(), below_skin.end());
  plan.of_skin = random_skin_cuts(random, body, skin);
  return plan;
}

/// Deals a plan over steps.
inline std::vector<Step> dealt(Random& random, Plan plan, const std::size_t n_steps) {
  std::vector<Step> steps(n_steps);
  std::shuffle(plan.cuts.begin(), plan.cuts.end(), random);
  std::shuffle(plan.of_skin.begin(), plan.of_skin.end(), random);
  for (const EdgeCut& cut : plan.cuts)
    steps[random() % n_steps].cuts.push_back(cut);
  for (const SkinCut& cut : plan.of_skin)
    steps[random() % n_steps].of_skin.push_back(cut);
  return steps;
}

inline void apply(const Step& step, Body& body) {
  for (const EdgeCut& cut : step.cuts)
    body.cuts.add(body.grid, cut);
  for (const SkinCut& cut : step.of_skin)
    body.cuts.add(cut);
}

inline Body applied(const Plan& plan, Body body) {
  apply(plan, body);
  return body;
}

} // namespace kerf::grid::histories
