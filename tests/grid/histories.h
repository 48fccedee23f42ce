#pragma once

/// Random cuts of a body, second cuts of skin edges and seams among them, and random orders in which they may come.

#include "grid/cuts.h"
#include "tests/support/bodies.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

namespace kerf::grid::histories {

using support::Body;
using support::Random;
using support::uniform;

/// Cuts that a body gets, and what is said in the end of the seams of its faces.
struct Plan {
  std::vector<EdgeCut> cuts;
  std::map<FaceId, Seam> seams;
};

struct Step {
  std::vector<EdgeCut> cuts;
  std::vector<std::pair<FaceId, Seam>> seams;
  std::vector<EdgeId> edges; ///< what an update is told: those of the cuts, and one of each face whose skin is parted
};

inline std::array<EdgeId, 4> edges_of(const Grid& grid, const FaceId face) {
  const auto& [below, above] = grid.cells(face);
  const CellId cell = below.valid() ? below : above;
  const auto faces = grid.faces(cell);
  const auto local = std::find(faces.begin(), faces.end(), face) - faces.begin();
  std::array<EdgeId, 4> edges;
  for (int i = 0; i < 4; ++i)
    edges[i] = grid.edges(cell)[cube::face_lines[local][i]];
  return edges;
}

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

/// A body with only its skin cut gets cuts and seams, each with its probability.
inline Plan random_plan(Random& random, const Body& body, const double inner, const double second, const double seam) {
  Plan plan{support::random_cuts(random, body, inner), {}};
  const auto of_skin = random_second_cuts(random, body, second);
  plan.cuts.insert(plan.cuts.end(), of_skin.begin(), of_skin.end());
  for (const auto face : ids<FaceId>(body.grid.n_faces()))
    if (uniform(random, 0, 1) < seam)
      plan.seams[face] = random() % 2 ? Seam::whole : Seam::parted;
  return plan;
}

/// Deals a plan over steps. A face is said to be whole no later than an edge between its material nodes is cut, and to
/// be parted, also after it has been whole, at any time.
inline std::vector<Step> dealt(Random& random, const Body& body, Plan plan, const std::size_t n_steps) {
  std::vector<Step> steps(n_steps);
  std::map<EdgeId, std::size_t> step_of;
  std::shuffle(plan.cuts.begin(), plan.cuts.end(), random);
  for (const EdgeCut& cut : plan.cuts) {
    const std::size_t step = random() % n_steps;
    step_of[cut.edge] = step;
    steps[step].cuts.push_back(cut);
    steps[step].edges.push_back(cut.edge);
  }
  for (const auto& [face, seam] : plan.seams) {
    const auto edges = edges_of(body.grid, face);
    std::size_t last = n_steps - 1;
    for (const EdgeId e : edges)
      if (support::is_inner(body, e) && step_of.contains(e))
        last = std::min(last, step_of[e]);
    const std::size_t whole = random() % (last + 1);
    if (seam == Seam::whole || random() % 2)
      steps[whole].seams.emplace_back(face, Seam::whole);
    if (seam == Seam::parted) {
      const std::size_t parted = whole + random() % (n_steps - whole);
      steps[parted].seams.emplace_back(face, Seam::parted);
      steps[parted].edges.push_back(edges[random() % 4]);
    }
  }
  for (Step& step : steps)
    std::shuffle(step.edges.begin(), step.edges.end(), random);
  return steps;
}

inline void apply(const Step& step, Body& body) {
  for (const EdgeCut& cut : step.cuts)
    body.cuts.add(body.grid, cut);
  for (const auto& [face, seam] : step.seams)
    body.cuts.set_seam(face, seam);
}

inline Body applied(const Plan& plan, Body body) {
  apply({plan.cuts, {plan.seams.begin(), plan.seams.end()}, {}}, body);
  return body;
}

} // namespace kerf::grid::histories
