#include "tests/fuzz/cases.h"

#include "cut/pending.h"
#include "grid/cube.h"
#include "tests/fuzz/invariants.h"
#include "tests/fuzz/states.h"
#include "tests/fuzz/sweeps.h"
#include "tests/support/placed.h"

#include <algorithm>
#include <numeric>
#include <sstream>

namespace kerf::fuzz {

namespace {

/// How what a sweep cuts is released: at most two edges of a cell at once as in scene/body.cc, one release a sweep;
/// the same, but until nothing waits; or all of it at once.
enum class Release { one, drained, at_once };

constexpr std::array<const char*, 3> release_names = {"one release a sweep", "released until nothing waits", "at once"};

/// Number 0 draws the case itself, number k + 1 its sweep k.
Random generator(const std::uint32_t seed, const std::uint32_t number) {
  std::seed_seq numbers = {seed, number};
  return Random(numbers);
}

/// What a sweep finds must be what its header promises.
void require_sound_cuts(const Subject& subject, const cut::SweepCuts& found) {
  for (std::size_t i = 0; i < found.cuts.size(); ++i) {
    const grid::EdgeCut& cut = found.cuts[i];
    if (i > 0 && !(found.cuts[i - 1].edge < cut.edge))
      throw Violation("cuts are not ordered by edge");
    if (subject.cuts.is_cut(cut.edge) || !support::is_inner(subject.specimen.body, cut.edge))
      throw Violation("an edge is cut again, or outside of the material");
    if (!(cut.t >= 0 && cut.t <= 1) || !(std::abs(cut.normal.norm() - 1) < 1e-12))
      throw Violation("edge " + std::to_string(cut.edge.value) + " is cut at t = " + std::to_string(cut.t) +
                      " with a normal of length " + std::to_string(cut.normal.norm()));
  }
}

/// No hole: the edges round a face of the lattice are a closed line now, and cross a closed surface evenly.
void require_no_hole(const Subject& subject, const std::vector<grid::EdgeCut>& found) {
  const grid::Grid& grid = subject.grid();
  Table<grid::EdgeId, std::uint8_t> crossed(grid.n_edges(), 0);
  for (const auto& cut : found)
    crossed[cut.edge] = 1;
  for (const auto c : ids<grid::CellId>(grid.n_cells()))
    for (const auto& lines : grid::cube::face_lines) {
      int n_crossed = 0, n_cut = 0;
      for (const int line : lines) {
        n_crossed += crossed[grid.edges(c)[line]];
        n_cut += subject.cuts.is_cut(grid.edges(c)[line]);
      }
      if (n_cut == 0 && n_crossed % 2 != 0)
        throw Violation("a closed surface cuts an odd number of edges of a face of cell " + std::to_string(c.value));
    }
}

class Run {
 public:
  Run(const Case& one, const std::vector<Specimen>& specimens, Tally& tally, Outcome& outcome)
    : case_(one),
      random_(generator(one.seed, 0)),
      subject_(make_subject(specimens[draw(random_, static_cast<int>(specimens.size()))], tally)),
      release_(static_cast<Release>(draw(random_, 3))),
      tally_(tally),
      outcome_(outcome) {
    tell(subject_.specimen.name + ", " + put_into_state(subject_, random_) + ", " +
         release_names[static_cast<std::size_t>(release_)]);
    subject_.x_before = subject_.x;
  }

  void all_sweeps() {
    for (const std::uint32_t number : case_.sweeps) {
      ++outcome_.n_done;
      sweep(number);
      ++tally_.n_sweeps;
    }
    drain();
    require_untouched_elsewhere();
    require_same_in_any_order();
    outcome_.digest = digest(subject_, outcome_.digest);
  }

 private:
  void tell(const std::string& line) { outcome_.story += "  " + line + '\n'; }

  void sweep(const std::uint32_t number) {
    Random random = generator(case_.seed, number + 1);
    const std::string motion = move(subject_, random);
    const NamedSweep swept = random_sweep(subject_, last_, random);
    tell("sweep " + std::to_string(number) + ": " + motion + ", " + swept.name);
    const auto found = meet(subject_, swept.sweep, static_cast<grid::CutLabel>(number + 1));
    require_sound_cuts(subject_, found);
    if (swept.extent == Extent::closed)
      require_no_hole(subject_, found.cuts);
    tally_.n_double_crossings += found.n_double_crossings;
    tally_.n_idle_sweeps += found.cuts.empty();
    last_ = swept;
    if (release_ == Release::at_once || std::holds_alternative<cut::CutSurface>(swept.sweep)) {
      cut_now(found.cuts);
    } else {
      pending_.push(found.cuts);
      cut_now(pending_.release(subject_.grid(), subject_.cuts));
      tally_.n_most_waiting = std::max(tally_.n_most_waiting, pending_.size());
      if (release_ == Release::drained)
        drain();
    }
    subject_.x_before = subject_.x;
    outcome_.digest = digest(subject_, outcome_.digest);
  }

  void cut_now(const std::vector<grid::EdgeCut>& cuts) {
    if (!cuts.empty())
      cut(subject_, cuts, tally_);
  }

  void drain() {
    while (pending_.size() > 0) {
      const auto released = pending_.release(subject_.grid(), subject_.cuts);
      if (released.empty() && pending_.size() > 0)
        throw Violation("nothing is released although cuts wait");
      cut_now(released);
    }
  }

  /// The ledger was kept up to date in the cells around new cuts alone.
  void require_untouched_elsewhere() const {
    for (const auto c : ids<grid::CellId>(subject_.grid().n_cells()))
      if (require_positive_octants(subject_.grid(), subject_.cuts, c) != subject_.octants[c])
        throw Violation("cell " + std::to_string(c.value) + " changed without a cut");
  }

  void require_same_in_any_order() {
    std::vector<grid::EdgeCut> cuts;
    for (const auto& cut : subject_.cuts.all())
      if (cut.label != grid::skin_label)
        cuts.push_back(cut);
    std::shuffle(cuts.begin(), cuts.end(), random_);
    Subject other = make_subject(subject_.specimen, tally_);
    for (std::size_t i = 0; i < cuts.size();) {
      const auto n = static_cast<int>(cuts.size() - i);
      const std::size_t n_now = draw(random_, 3) == 0 ? n : 1 + draw(random_, n);
      cut(other, std::span(cuts).subspan(i, n_now), tally_);
      i += n_now;
    }
    require_same(subject_.complex, other.complex);
  }

  const Case& case_;
  Random random_;
  Subject subject_;
  Release release_;
  Tally& tally_;
  Outcome& outcome_;
  cut::PendingCuts pending_;
  std::optional<NamedSweep> last_;
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

Outcome run(const Case& one, const std::vector<Specimen>& specimens, Tally& tally) {
  Outcome outcome;
  try {
    ++tally.n_cases;
    Run(one, specimens, tally, outcome).all_sweeps();
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
