#include "tests/grinder/grinder.h"

#include "base/error.h"
#include "base/parameters.h"
#include "scene/compose.h"
#include "scene/run.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

namespace kerf::grinder {

namespace {

void run(scene::World& world, const Scene& scene, const Until until, Outcome& outcome) {
  const scene::Body& body = world.bodies.at(0);
  Watch watch(scene, body);
  Timings timings;
  constexpr double least_between = 2e-3; // looks, which cost more than an explicit step [s]
  const int every = static_cast<int>(std::ceil(least_between / world.time_step));
  const auto is_over = [&] { return outcome.failure && (until == Until::first_failure || outcome.failure->is_final); };
  for (int step = 1; step <= world.n_steps && !is_over(); ++step) {
    std::optional<Failure> failure;
    try {
      scene::advance(world, step, timings);
      if (step % every == 0 || step == world.n_steps)
        failure = watch.after_step(body, step, world.time_step);
    } catch (const Error& error) {
      failure = Failure{"stopped", step, error.what(), true};
    }
    outcome.n_steps = step;
    if (!outcome.failure)
      outcome.failure = failure;
    else if (failure)
      outcome.failure->is_final = failure->is_final;
  }
  outcome.figures = watch.figures();
  outcome.n_cells = body.solid.grid.n_cells();
  outcome.n_pieces = grid::n_pieces(body.solid.complex);
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

/// When it was drawn out so far that it stopped [s].
std::optional<double> drawn_out_at(const Scene& scene, const Outcome& outcome) {
  if (!outcome.failure || outcome.failure->reason != "stopped" ||
      outcome.failure->words.find("is drawn out") == std::string::npos)
    return {};
  return outcome.failure->step * number_of(scene, "Time step [s]").value_or(1);
}

} // namespace

std::string name_of(const Case& one) { return one.solid->name + ':' + one.kind->name + ':' + std::to_string(one.seed); }

Outcome run(const Scene& scene, const std::vector<std::string>& changes, const Until until) {
  Outcome outcome;
  std::optional<scene::World> world;
  try {
    world = scene::compose(scene::scan_scene_text(text(scene), scene.file, changes));
  } catch (const Error& error) {
    outcome.refused = error.what();
    return outcome;
  }
  run(*world, scene, until, outcome);
  return outcome;
}

bool hangs_by_a_thread(const Scene& scene, const std::vector<std::string>& changes, const Outcome& outcome) {
  const auto time = drawn_out_at(scene, outcome);
  const auto has = [&](const char* words) { return text(scene).find(words) != std::string::npos; };
  if (!time || has("Backend = "))
    return false;
  const auto is_too = [&](const Scene& other, const std::vector<std::string>& with) {
    const auto other_time = drawn_out_at(other, run(other, with, Until::first_failure));
    return other_time && std::abs(*other_time - *time) <= 0.1 * *time;
  };
  std::vector<std::string> with_other_element = changes;
  with_other_element.push_back(std::string("Body solid/Element=") +
                               (has("Element = enhanced") ? "trilinear" : "enhanced"));
  return is_too(with_number(scene, "Time step [s]", 0.5 * number_of(scene, "Time step [s]").value_or(1)), changes) &&
         is_too(scene, with_other_element);
}

namespace {

/// The scene up to its failure; nothing when that is another or none.
std::optional<Scene> still_failing(const Scene& scene, const std::vector<std::string>& changes,
                                   const std::string& reason) {
  const Outcome outcome = run(scene, changes, Until::first_failure);
  if (!outcome.failure || outcome.failure->reason != reason)
    return {};
  return with_number(scene, "End time [s]", outcome.failure->step * number_of(scene, "Time step [s]").value_or(1));
}

} // namespace

Scene shrunk(const Scene& scene, const std::vector<std::string>& changes, const std::string& reason) {
  Scene least = still_failing(scene, changes, reason).value_or(scene);
  const auto try_out = [&](const Scene& smaller) {
    const auto failing = still_failing(smaller, changes, reason);
    least = failing.value_or(least);
    return failing.has_value();
  };
  for (std::size_t i = least.sections.size(); i-- > 0;)
    if (is_tool(least.sections[i])) {
      Scene smaller = least;
      smaller.sections.erase(smaller.sections.begin() + static_cast<std::ptrdiff_t>(i));
      try_out(smaller);
    }
  const std::string cell = "Cube edge [m]";
  for (const double factor : {2.0, 1.5, 1.2, 1.07})
    while (try_out(with_number(least, cell, factor * number_of(least, cell).value_or(1)))) {
    }
  return least;
}

void Harvest::add(const std::string& name, const std::string& kind, const Scene& scene,
                  const std::vector<std::string>& changes, const Outcome& outcome) {
  ++n_cases_;
  auto& counts = counts_[kind];
  ++counts["cases"];
  if (outcome.refused) {
    ++n_refused_;
    ++counts["refused"];
    refusals_.push_back(name + ": " + first_line(*outcome.refused));
    return;
  }
  Figures& most = healthy_[kind];
  if (!outcome.failure) {
    const Figures& f = outcome.figures;
    most = {std::max(most.fastest, f.fastest), std::max(most.stretch, f.stretch),
            std::max(most.runaway, f.runaway), std::max(most.outlier, f.outlier),
            std::max(most.volume, f.volume),   std::max(most.reach, f.reach),
            std::max(most.energy, f.energy),   std::max(most.cut_energy, f.cut_energy)};
    return;
  }
  if (hangs_by_a_thread(scene, changes, outcome)) {
    ++counts["by a thread"];
    hanging_.push_back(name + ": " + outcome.failure->words);
    return;
  }
  ++counts[outcome.failure->reason];
  failures_.push_back(name + ": " + outcome.failure->reason + " in step " + std::to_string(outcome.failure->step) +
                      ": " + outcome.failure->words + "; " + std::to_string(outcome.n_cells) + " cells, " +
                      std::to_string(outcome.n_pieces) + " pieces; " + scene.story + "; at most " +
                      to_text(outcome.figures.fastest) + " m/s");
  if (folder_.empty())
    return;
  std::filesystem::create_directories(folder_);
  std::string file = name + ".prm";
  std::replace(file.begin(), file.end(), ':', '.');
  std::ofstream(folder_ / file) << "# " << failures_.back() << '\n' << text(scene);
  std::ofstream(folder_ / "failures.txt", std::ios::app) << failures_.back() << '\n';
}

std::string Harvest::summary() const {
  std::ostringstream out;
  for (const auto& [kind, counts] : counts_) {
    out << kind << ':';
    for (const auto& [reason, n] : counts)
      out << ' ' << n << ' ' << reason << ';';
    if (const auto it = healthy_.find(kind); it != healthy_.end()) {
      const Figures& f = it->second;
      out << " of those that passed, the largest over what is allowed: speed " << f.runaway << ", outlier " << f.outlier
          << ", volume " << f.volume << ", reach " << f.reach << ", energy " << f.energy << ", of cuts " << f.cut_energy
          << "; stretched " << f.stretch << " times";
    }
    out << '\n';
  }
  for (const std::string& refusal : refusals_)
    out << "refused: " << refusal << '\n';
  for (const std::string& hanging : hanging_)
    out << "by a thread: " << hanging << '\n';
  return out.str();
}

} // namespace kerf::grinder
