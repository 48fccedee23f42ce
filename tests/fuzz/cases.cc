#include "tests/fuzz/cases.h"

#include "cut/target.h"
#include "grid/cube.h"
#include "grid/fronts.h"
#include "tests/fuzz/invariants.h"
#include "tests/fuzz/states.h"
#include "tests/fuzz/strokes.h"
#include "tests/fuzz/sweeps.h"
#include "tests/support/placed.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <sstream>

namespace kerf::fuzz {

namespace {

/// How what a sweep cuts is released: at most two edges of a cell at once as in scenes, one release a sweep;
/// the same, but until nothing waits; or all of it at once. With fronts the first, as scenes do.
enum class Release { one, drained, at_once };

constexpr std::array<const char*, 3> release_names = {"one release a sweep", "released until nothing waits", "at once"};
constexpr std::array<const char*, 3> front_names = {"no fronts", "fronts", "fronts as faces"};

/// Number 0 draws the case itself, number k + 1 its sweep k.
Random generator(const std::uint32_t seed, const std::uint32_t number) {
  std::seed_seq numbers = {seed, number};
  return Random(numbers);
}

void require_sound_cut(const std::string& what, const double t, const Vec3& normal) {
  if (!(t >= 0 && t <= 1) || !(std::abs(normal.norm() - 1) < 1e-12))
    throw Violation(what + " is cut at t = " + std::to_string(t) + " with a normal of length " +
                    std::to_string(normal.norm()));
}

/// Does a cut of an edge of the skin lie between the node and the skin?
bool is_up_to_skin(const support::Body& body, const grid::EdgeCut& cut) {
  const double skin = body.cuts.find_outer(cut.edge)->t;
  return body.grid.is_material(body.grid.ends(cut.edge)[0]) ? cut.t <= skin : cut.t >= skin;
}

/// What a sweep finds must be what its header promises.
void require_sound_cuts(const Subject& subject, const cut::SweepCuts& found) {
  for (std::size_t i = 0; i < found.cuts.size(); ++i) {
    const grid::EdgeCut& cut = found.cuts[i];
    if (i > 0 && !(found.cuts[i - 1].edge < cut.edge))
      throw Violation("cuts are not ordered by edge");
    const support::Body& body = subject.specimen.body; // its skin is that of the subject
    if (!subject.solid.cuts.can_be_cut(body.grid, cut.edge) ||
        (!support::is_inner(body, cut.edge) && !is_up_to_skin(body, cut)))
      throw Violation("an edge is cut again, or outside of the material");
    require_sound_cut("edge " + std::to_string(cut.edge.value), cut.t, cut.normal);
  }
  const auto segments = grid::histories::skin_segments(subject.grid());
  for (std::size_t i = 0; i < found.of_skin.size(); ++i) {
    const grid::SkinCut& cut = found.of_skin[i];
    if (i > 0 && !(found.of_skin[i - 1].segment < cut.segment))
      throw Violation("cuts of the skin are not ordered");
    if (!segments.contains(cut.segment) || subject.solid.cuts.is_cut(cut.segment))
      throw Violation("a segment of the skin is cut that is not there, or is cut already");
    require_sound_cut("a segment of the skin", cut.t, cut.normal);
  }
}

/// Which segments of a cell a sweep crosses.
grid::Segments crossed_in(const grid::Grid& grid, const grid::CellId c, const cut::SweepCuts& found) {
  grid::Segments crossed = 0;
  for (grid::Segments left = grid::skeleton_of(grid::material_of(grid, c)).segments; left != 0; left &= left - 1) {
    const int s = std::countr_zero(left);
    const bool is_crossed =
      s < grid::skeleton::first_half
        ? std::ranges::binary_search(found.cuts, grid.edges(c)[s], {}, &grid::EdgeCut::edge)
        : std::ranges::binary_search(found.of_skin, grid::skin_segment(grid, c, s), {}, &grid::SkinCut::segment);
    crossed |= grid::Segments(is_crossed) << s;
  }
  return crossed;
}

/// No hole: what bounds a side of a cell is a closed line now where nothing of it is cut, and crosses a closed surface
/// evenly.
void require_no_hole(const Subject& subject, const cut::SweepCuts& found) {
  for (const auto c : ids<grid::CellId>(subject.grid().n_cells())) {
    const grid::CellCuts cuts = grid::cuts_of(subject.solid, c);
    const grid::Segments crossed = crossed_in(subject.grid(), c, found);
    for (const auto& side : cuts.skeleton().side) {
      grid::Segments border = 0;
      for (int i = 0; i < side.n; ++i)
        border |= grid::Segments(1) << side.segments[i];
      if ((border & cuts.blades) == 0 && std::popcount(border & crossed) % 2 != 0)
        throw Violation("a closed surface cuts " + std::to_string(std::popcount(border & crossed)) + " of " +
                        std::to_string(side.n) + " segments of a side of cell " + std::to_string(c.value));
    }
  }
}

double height(const cut::Plane& plane, const Vec3& p) { return plane.normal.dot(p - plane.point); }

/// Each cut lies where the plane meets the current edge.
void require_on_plane(const Subject& subject, const cut::Plane& plane, const std::vector<grid::EdgeCut>& found) {
  for (const auto& cut : found) {
    const auto [lower, upper] = cut::ends_of(subject.solid, cut.edge).corners;
    const Vec3 &p = subject.x[lower.value], &q = subject.x[upper.value];
    const double off = std::abs(height(plane, p + cut.t * (q - p)));
    if (!(off < 1e-13 * (p.norm() + q.norm() + plane.point.norm())))
      throw Violation("edge " + std::to_string(cut.edge.value) + " is cut " + std::to_string(off) + " m off the plane");
  }
}

/// Where nothing had been cut before, and no shaving stays where a folded body lets the plane pass twice
/// (cut/shreds.h), a plane leaves no nodes joined across it: not by edges, nor by the skin. Nodes that it meets to
/// round-off may be on either side.
void require_parted(const Subject& subject, const cut::Plane& plane) {
  const Items& items = subject.specimen.items;
  constexpr std::int8_t unknown = 0, above = 1, below = 2, both = 3;
  std::vector<std::int8_t> side(items.n_names, unknown);
  for (const auto c : ids<grid::CellId>(subject.grid().n_cells()))
    for (int v = 0; v < grid::cube::n_vertices; ++v)
      if (const Item item = items.name[c][v]; item != Items::none) {
        const auto corner = subject.solid.complex.real_corner[subject.grid().nodes(c)[v]];
        const Vec3& at = subject.x[corner.value];
        const double off = height(plane, at), round_off = 1e-13 * (at.norm() + plane.point.norm());
        side[item] = std::abs(off) < round_off ? unknown : off > 0 ? above : below;
      }
  const ItemLinks links = fuzz::links(subject.solid, items);
  for (bool has_spread = true; has_spread;) {
    has_spread = false;
    for (const auto& [a, b] : links)
      if (side[a] != side[b]) {
        side[a] = side[b] = static_cast<std::int8_t>(side[a] | side[b]);
        if (side[a] == both)
          throw Violation("a plane leaves material joined across it");
        has_spread = true;
      }
  }
}

class Run {
 public:
  Run(const Case& one, const std::vector<Specimen>& specimens, Tally& tally, Outcome& outcome)
    : case_(one),
      random_(generator(one.seed, 0)),
      subject_(make_subject(specimens[draw(random_, static_cast<int>(specimens.size()))], tally)),
      release_(one.has_fronts() ? Release::one : static_cast<Release>(draw(random_, 3))),
      fronts_(one.has_fronts() ? static_cast<cut::Fronts>(1 + draw(random_, 2)) : cut::Fronts::at_faces),
      tally_(tally),
      outcome_(outcome) {
    is_gentle_ = one.has_fronts() && draw(random_, 3) > 0;
    tell(subject_.specimen.name + ", " + (is_gentle_ ? "at rest" : put_into_state(subject_, random_)) + ", " +
         release_names[static_cast<std::size_t>(release_)] + ", " + front_names[static_cast<std::size_t>(fronts_)]);
    std::uint32_t n_labels = 0;
    for (const std::uint32_t number : one.sweeps)
      n_labels = std::max(n_labels, one.has_fronts() ? 2 * number + 2 : number + 1);
    subject_.cutter =
      cut::Cutter(n_labels, release_ == Release::at_once ? cut::Release::at_once : cut::Release::queued, fronts_);
    subject_.cutter.begin(subject_.solid, subject_.x);
    for (std::uint32_t label = 1; label <= n_labels; ++label)
      strokes_.push_back({static_cast<grid::CutLabel>(label)});
  }

  void all_sweeps(const Judge& judge) {
    for (const std::uint32_t number : case_.sweeps) {
      ++outcome_.n_done;
      if (case_.has_fronts())
        sweep_with_fronts(number);
      else
        sweep(number);
      ++tally_.n_sweeps;
      if (judge)
        judge(subject_.solid, false);
    }
    drain();
    if (judge)
      judge(subject_.solid, true);
    tally_.n_left_whole += subject_.solid.cuts.n_left_whole();
    if (case_.has_fronts()) // else each sweep says
      tally_.n_double_crossings += subject_.cutter.counts().n_double_crossings;
    require_untouched_elsewhere();
    if (!case_.has_fronts())
      require_same_in_any_order();
    outcome_.digest = digest(subject_, outcome_.digest);
  }

 private:
  void tell(const std::string& line) { outcome_.story += "  " + line + '\n'; }

  void sweep(const std::uint32_t number) {
    Random random = generator(case_.seed, number + 1);
    const auto label = static_cast<grid::CutLabel>(number + 1);
    const std::string motion = move(subject_, random);
    const NamedSweep swept = random_sweep(subject_, last_, random);
    tell("sweep " + std::to_string(number) + ": " + motion + ", " + swept.name);
    const auto found = meet(subject_, swept.sweep, label);
    require_sound_cuts(subject_, found);
    if (swept.extent == Extent::closed)
      require_no_hole(subject_, found);
    const cut::Plane* const plane = plane_of(swept.sweep);
    const bool is_first = subject_.solid.cuts.all().size() == subject_.specimen.body.cuts.all().size() &&
                          subject_.solid.cuts.skin_cuts().empty();
    if (plane)
      require_on_plane(subject_, *plane, found.cuts);
    tally_.n_double_crossings += found.n_double_crossings;
    tally_.n_idle_sweeps += found.cuts.empty() && found.of_skin.empty();
    last_ = swept;
    if (const auto* const surface = std::get_if<cut::CutSurface>(&swept.sweep)) {
      cut_at_once(*surface, label);
      if (plane && is_first && subject_.solid.cuts.n_left_whole() == 0)
        require_parted(subject_, *plane);
    } else {
      const std::vector<cut::SweptTriangle> strip = strip_of(swept.sweep);
      step({label, found, strip});
      tally_.n_most_waiting = std::max(tally_.n_most_waiting, subject_.cutter.n_waiting());
      now_ = {label, {}, strip};
      if (release_ == Release::drained)
        drain();
    }
    subject_.cutter.stand(subject_.x);
    outcome_.digest = digest(subject_, outcome_.digest);
  }

  /// Blades in steps between which the body may move, or a surface at once.
  void sweep_with_fronts(const std::uint32_t number) {
    Random random = generator(case_.seed, number + 1);
    const auto label = static_cast<grid::CutLabel>(2 * number + 1);
    const std::string prefix = "sweep " + std::to_string(number) + ": ";
    if (draw(random, 3) == 0) {
      const std::string motion = moved(random);
      const NamedSweep surface = random_surface(subject_, random);
      tell(prefix + motion + ", " + surface.name);
      cut_at_once(std::get<cut::CutSurface>(surface.sweep), label);
      require_sound_fronts();
      return;
    }
    const Strokes strokes = random_strokes(subject_, label, random);
    const bool moves = draw(random, 2) == 0;
    tell(prefix + strokes.name + (moves ? " through a moving body" : ""));
    for (std::size_t k = 1; k < strokes.times.size(); ++k) {
      if (moves)
        tell("  " + moved(random));
      const auto made = [&](Subject& s) {
        return s.cutter.step(s.solid, strokes.blades, strokes.times[k - 1], strokes.times[k], s.x);
      };
      cut(subject_, made, tally_);
      ++tally_.n_steps;
      tally_.n_most_waiting = std::max(tally_.n_most_waiting, subject_.cutter.n_waiting());
      require_sound_fronts();
    }
    const std::span<const cut::Blade> none;
    for (int n = 0; n < 100 && subject_.cutter.n_waiting() > 0; ++n)
      cut(
        subject_, [&](Subject& s) { return s.cutter.step(s.solid, none, 0, 0, s.x); }, tally_);
    if (subject_.cutter.n_waiting() > 0)
      throw Violation("cuts wait although all blades have gone");
    require_sound_fronts();
  }

  std::string moved(Random& random) { return is_gentle_ ? move_gently(subject_, random) : move(subject_, random); }

  static bool goes_on_from(const grid::Front& before, const grid::Front& front) {
    return front.passed >= before.passed &&
           std::ranges::equal(front.reached, before.reached, std::greater_equal<>()) &&
           std::ranges::equal(front.held, before.held, std::less_equal<>());
  }

  /// A front has come some part of the way, goes on only, and ties corners of one node.
  void require_sound_fronts() {
    std::map<grid::CellId, grid::Front> now;
    for (const grid::Front& front : subject_.solid.cuts.fronts()) {
      const auto before = fronts_before_.find(front.cell);
      tally_.n_fronts += before == fronts_before_.end();
      const bool goes_on = before == fronts_before_.end() || before->second.label != front.label ||
                           goes_on_from(before->second, front);
      const bool is_held = std::ranges::all_of(front.held, [](const double at) { return at > 0 && std::isfinite(at); });
      if (!(front.passed > 0 && front.passed <= 1) || !is_held || front.ahead == 0 || !goes_on ||
          !(std::abs(front.normal.norm() - 1) < 1e-9) || !front.point.allFinite())
        throw Violation("the front in cell " + std::to_string(front.cell.value) + " is none");
      now.emplace(front.cell, front);
    }
    fronts_before_ = std::move(now);
    const grid::CellComplex& complex = subject_.solid.complex;
    const auto ties = grid::ties(subject_.solid);
    for (const grid::Tie& tie : ties)
      if (tie.a == tie.b || complex.node[tie.a] != complex.node[tie.b] || !(tie.length >= 0) ||
          !std::isfinite(tie.length))
        throw Violation("a tie is none");
    tally_.n_most_ties = std::max(tally_.n_most_ties, ties.size());
  }

  static const cut::Plane* plane_of(const Sweep& sweep) {
    const auto* const surface = std::get_if<cut::CutSurface>(&sweep);
    return surface ? std::get_if<cut::Plane>(&surface->shape) : nullptr;
  }

  static std::vector<cut::SweptTriangle> strip_of(const Sweep& sweep) {
    std::vector<cut::SweptTriangle> strip;
    if (const auto* const soup = std::get_if<Soup>(&sweep))
      for (const auto& triangle : *soup)
        strip.push_back({triangle});
    if (const auto* const path = std::get_if<cut::BladePath>(&sweep))
      return cut::swept_triangles(*path);
    return strip;
  }

  void cut_at_once(cut::CutSurface surface, const grid::CutLabel label) {
    surface.label = label;
    cut(
      subject_, [&](Subject& s) { return s.cutter.at_once(s.solid, surface, s.x); }, tally_);
  }

  /// One blade, while all others have gone.
  void step(const cut::Stroke& stroke) {
    std::vector<cut::Stroke> strokes = strokes_;
    if (!strokes.empty())
      strokes[stroke.label - 1] = stroke;
    cut(
      subject_, [&](Subject& s) { return s.cutter.step(s.solid, strokes, s.x); }, tally_);
  }

  void drain() {
    while (const std::size_t n_waiting = subject_.cutter.n_waiting()) {
      step(now_);
      if (subject_.cutter.n_waiting() == n_waiting)
        throw Violation("nothing is released although cuts wait");
    }
  }

  /// The ledger was kept up to date in the cells around new cuts alone.
  void require_untouched_elsewhere() const {
    for (const auto c : ids<grid::CellId>(subject_.grid().n_cells()))
      if (require_sound_volumes(subject_.solid, c) != subject_.volumes[c])
        throw Violation("cell " + std::to_string(c.value) + " changed without a cut");
  }

  void require_same_in_any_order() {
    grid::histories::Plan plan;
    for (const auto& cut : subject_.solid.cuts.all())
      if (cut.label != grid::skin_label)
        plan.cuts.push_back(cut);
    plan.of_skin.assign(subject_.solid.cuts.skin_cuts().begin(), subject_.solid.cuts.skin_cuts().end());
    Subject other = make_subject(subject_.specimen, tally_);
    for (const auto& step : grid::histories::dealt(random_, plan, 1 + draw(random_, 6)))
      if (!step.empty())
        cut(other, step, tally_);
    std::vector<grid::CellId> cells; // of later cuts at segments that were cut before the plan says nothing
    for (const auto c : ids<grid::CellId>(subject_.grid().n_cells())) {
      const auto *const is = subject_.solid.cuts.joined(c), *const was = other.solid.cuts.joined(c);
      if (!is && !was)
        continue;
      other.solid.cuts.set_joined(c, is ? *is : std::vector<grid::Joined>());
      cells.push_back(c);
    }
    grid::update_complex(other.solid, {}, {}, cells);
    require_same(subject_.solid.complex, other.solid.complex);
  }

  const Case& case_;
  Random random_;
  Subject subject_;
  Release release_;
  cut::Fronts fronts_;
  bool is_gentle_ = false; // the body moves as solids do
  std::map<grid::CellId, grid::Front> fronts_before_;
  Tally& tally_;
  Outcome& outcome_;
  std::optional<NamedSweep> last_;
  std::vector<cut::Stroke> strokes_; // by label: of blades that have gone
  cut::Stroke now_;                  // where the last blade is
};

} // namespace

Case whole_case(const std::uint32_t seed) {
  Random random = generator(seed, 0);
  Case one{seed, std::vector<std::uint32_t>(1 + random() % 12)};
  std::iota(one.sweeps.begin(), one.sweeps.end(), 0u);
  return one;
}

Case parse_case(const std::string& text) {
  const std::size_t colon = text.find(':');
  const auto seed = static_cast<std::uint32_t>(std::stoul(text));
  if (colon == std::string::npos)
    return whole_case(seed);
  Case one{seed, {}};
  std::istringstream numbers(text.substr(colon + 1));
  for (std::string number; std::getline(numbers, number, ',');)
    one.sweeps.push_back(static_cast<std::uint32_t>(std::stoul(number)));
  return one;
}

std::string to_string(const Case& one) {
  std::string text = std::to_string(one.seed) + ':';
  for (std::size_t i = 0; i < one.sweeps.size(); ++i)
    text += (i == 0 ? "" : ",") + std::to_string(one.sweeps[i]);
  return text;
}

Outcome run(const Case& one, const std::vector<Specimen>& specimens, Tally& tally, const Judge& judge) {
  Outcome outcome;
  try {
    ++tally.n_cases;
    Run run(one, specimens, tally, outcome);
    run.all_sweeps(judge);
  } catch (const std::exception& error) {
    outcome.failure = error.what();
  }
  return outcome;
}

Case shrunk(Case failing, const std::vector<Specimen>& specimens) {
  Tally unused;
  const auto cut_off = [&](const Case& one) {
    const Outcome outcome = run(one, specimens, unused);
    Case prefix = one;
    prefix.sweeps.resize(outcome.n_done);
    return std::pair(outcome.failure.has_value(), prefix);
  };
  failing = cut_off(failing).second;
  for (std::size_t i = failing.sweeps.size(); i-- > 0;) {
    Case shorter = failing;
    shorter.sweeps.erase(shorter.sweeps.begin() + static_cast<std::ptrdiff_t>(i));
    if (const auto [fails, prefix] = cut_off(shorter); fails) {
      failing = prefix;
      i = std::min(i, failing.sweeps.size());
    }
  }
  return failing;
}

} // namespace kerf::fuzz
