#include "study/truth.h"

#include "base/sha256.h"
#include "reference/motion.h"
#include "reference/solution.h"
#include "study/measure.h"
#include "study/truth_problem.h"

#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <span>
#include <sstream>

namespace kerf::study {

namespace {

using scene::Section;

/// Changes where the same section would give another number, so that old files of the cache do not count.
constexpr char version[] = "3\n";

std::string text_of(const char* format, const double value) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

/// A section, what is asked beside it, and how finely it is solved.
struct Task {
  TruthParameters body;
  TruthAnswerParameters answer;
  reference::Problem problem;
  std::optional<reference::Problem> coarser; ///< with a layer less, where the body has layers
  Points points;             ///< Point, Minus point, then those of the study, in the section's frame [m]
  bool has_minus, frequency; ///< whether they are asked for
};

struct Fineness {
  int degree;
  double time_step; ///< [s]
};

/// Which axis of the scene each axis of the section stands for.
std::array<int, 3> scene_axes(const TruthAnswerParameters& p) {
  return {p.axes[0] - 'x', p.axes[1] - 'x', p.axes[2] - 'x'};
}

Vec3 from_scene(const TruthAnswerParameters& p, const Vec3& X) {
  const auto axis = scene_axes(p);
  return {X[axis[0]], X[axis[1]], X[axis[2]]};
}

Vec3 to_scene(const TruthAnswerParameters& p, const Vec3& u) {
  const auto axis = scene_axes(p);
  Vec3 turned;
  for (int d = 0; d < 3; ++d)
    turned[axis[d]] = u[d];
  return turned;
}

double asked(const Task& task, const Points& u) {
  const int axis = task.answer.axis[0] - 'x';
  return task.has_minus ? u[0][axis] - u[1][axis] : u[0][axis];
}

/// What a solution says of a task's problem.
struct Answer {
  double value = 0;                                         ///< [m]
  Points displacements = {};                                ///< of the task's points, at the end [m]
  double energy = std::numeric_limits<double>::quiet_NaN(); ///< in equilibrium [J]
  std::size_t n_unknowns = 0;                               ///< in equilibrium
};

Answer end_of(const Task& task, const std::vector<Points>& u) {
  std::vector<double> series;
  for (const Points& at_time : u)
    series.push_back(asked(task, at_time));
  AnswerParameters how;
  how.take = task.answer.take;
  return {take(series, how, task.body.time_step), u.back()};
}

Answer in_equilibrium(const Task& task, const reference::Problem& problem, const int degree) {
  const auto solution = reference::solve(problem, {degree, 0, task.answer.n_adaptations, 0.1});
  Points u;
  for (const Vec3& X : task.points)
    u.push_back(solution->displacement(X));
  Answer answer = end_of(task, {u});
  answer.energy = solution->energy() * task.answer.energy_factor;
  answer.n_unknowns = solution->n_unknowns();
  return answer;
}

Answer in_motion(const Task& task, const reference::Problem& problem, const Fineness& fineness) {
  const int n_steps = static_cast<int>(std::lround(task.body.end_time / fineness.time_step));
  return end_of(task, reference::motion(problem, {fineness.degree, 0, task.answer.n_adaptations, 0.1},
                                        {task.body.end_time / n_steps, n_steps, task.body.mass_damping}, task.points));
}

/// Of a body whose error is in proportion to its innermost layer, from the answers with n layers and with n - 1:
/// Richardson's.
Answer extrapolated(const Answer& fine, const Answer& coarse) {
  constexpr double factor = layer_ratio / (1 - layer_ratio);
  Answer answer = fine;
  answer.value += factor * (fine.value - coarse.value);
  answer.energy += factor * (fine.energy - coarse.energy);
  for (std::size_t i = 0; i < answer.displacements.size(); ++i)
    answer.displacements[i] += factor * (fine.displacements[i] - coarse.displacements[i]);
  return answer;
}

Answer answer_of(const Task& task, const Fineness& fineness) {
  const auto of = [&](const reference::Problem& problem) {
    return task.body.end_time > 0 ? in_motion(task, problem, fineness) : in_equilibrium(task, problem, fineness.degree);
  };
  const Answer fine = of(task.problem);
  return task.coarser ? extrapolated(fine, of(*task.coarser)) : fine;
}

/// By how much the same found less finely differs. Throws NumericalError where that is more than the tolerance.
std::string agreement(const Task& task, const std::string& what, const double best, const double other,
                      const std::string& how) {
  const std::string told = "degree " + std::to_string(task.answer.degree - 1) + how + text_of("%.1e", other / best - 1);
  if (!(std::abs(other / best - 1) <= task.answer.tolerance))
    throw NumericalError("the section Truth has no " + what + " within its tolerance: " + told +
                         ". Use more adaptations or cells, or a smaller time step");
  return told;
}

/// The lowest of the body, on cells that are refined once.
double frequency(const Task& task, const int degree) {
  return reference::lowest_frequencies(task.problem, {degree, 1, 0}, 1).front();
}

Reference solve(const Task& task, const Section& section) {
  const bool moves = task.body.end_time > 0;
  const int degree = task.answer.degree;
  const double dt = task.body.time_step;
  const Answer best = answer_of(task, {degree, dt}), other = answer_of(task, {degree - 1, 2 * dt});
  double largest = 0; // of the points, round-off of which the answer may be
  for (const Vec3& u : best.displacements)
    largest = std::max(largest, u.norm());
  if (!(std::abs(best.value) > 1e-10 * largest))
    throw section.complaint("Axis", "the displacement that is asked for is 0, which nothing can be measured by",
                            "Ask for another component or point");
  Reference found;
  found.value = best.value;
  found.energy = best.energy;
  found.source =
    "deal.II, degree " + std::to_string(degree) + ", " +
    (moves ? "time step " + text_of("%.3g", dt) + " s" : std::to_string(best.n_unknowns) + " unknowns") +
    (task.coarser ? ", extrapolated from layers" : "") + "; " +
    agreement(task, "answer", best.value, other.value, moves ? " and twice the time step differ by " : " differs by ");
  for (std::size_t i = task.has_minus ? 2 : 1; i < task.points.size(); ++i)
    found.displacements.push_back(to_scene(task.answer, best.displacements[i]));
  if (task.frequency) {
    found.frequency = frequency(task, degree);
    agreement(task, "lowest frequency", found.frequency, frequency(task, degree - 1), " differs by ");
  }
  return found;
}

/// Numbers in a line; what is not known is 0.
std::string text_of(const Reference& found) {
  const auto number = [](const double value) { return text_of("%.17g ", std::isfinite(value) ? value : 0.0); };
  std::string text = number(found.value) + number(found.energy) + number(found.frequency);
  for (const Vec3& u : found.displacements)
    text += number(u[0]) + number(u[1]) + number(u[2]);
  return text;
}

std::optional<Reference> kept(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string numbers, end;
  Reference found;
  if (!std::getline(in, numbers) || !std::getline(in, found.source) || !std::getline(in, end) || end != "end")
    return std::nullopt;
  std::istringstream values(numbers);
  if (!(values >> found.value >> found.energy >> found.frequency) || found.value == 0)
    return std::nullopt;
  for (double* other : {&found.energy, &found.frequency})
    if (*other == 0)
      *other = std::numeric_limits<double>::quiet_NaN();
  for (Vec3 u; values >> u[0] >> u[1] >> u[2];)
    found.displacements.push_back(u);
  return found;
}

/// Beside its name first, so that what is there is whole; what cannot be written is not kept.
void keep(const std::filesystem::path& file, const Reference& found) {
  std::error_code error;
  std::filesystem::create_directories(file.parent_path(), error);
  const std::filesystem::path beside = file.string() + "." + std::to_string(getpid());
  std::ofstream(beside) << text_of(found) << "\n" << found.source << "\nend\n";
  std::filesystem::rename(beside, file, error);
}

Task task_of(const Section& section, const TruthAsked& asked) {
  Task task{section.read<TruthParameters>(), section.read<TruthAnswerParameters>(), {}, {}, {}, false, asked.frequency};
  task.problem = problem_of(task.body, section);
  if (has_layers(task.body))
    task.coarser = problem_of(task.body, section, 1);
  task.has_minus = section.writes("Minus point [m]");
  task.points = {task.answer.point};
  if (task.has_minus)
    task.points.push_back(task.answer.minus_point);
  for (const Vec3& X : asked.points)
    task.points.push_back(from_scene(task.answer, X));
  return task;
}

std::filesystem::path name_of(const Section& section, const Task& task) {
  std::string text =
    version + scene::effective_text(section) + (task.has_minus ? "-" : "") + (task.frequency ? "f" : "");
  for (const Vec3& X : task.points)
    text += text_of("%.17g,", X[0]) + text_of("%.17g,", X[1]) + text_of("%.17g;", X[2]);
  return sha256(std::as_bytes(std::span(text))) + ".txt";
}

} // namespace

scene::SectionKind truth_grammar() {
  return {"Truth", scene::Occurrence::once,
          "A reference, found by deal.II on a mesh that is fitted to the body: elements of high degree, refined where "
          "their error "
          "is. It is a displacement at small strain. That of the study counts for all rows that have no other.",
          scene::keys_of<TruthParameters, TruthAnswerParameters>(), truth_parts()};
}

std::filesystem::path truth_cache() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache)
    return std::filesystem::path(cache) / "kerf/references";
  if (const char* home = std::getenv("HOME"); home && *home)
    return std::filesystem::path(home) / ".cache/kerf/references";
  return {};
}

Reference find_truth(const Section& section, const TruthAsked& asked, const std::filesystem::path& cache) {
  const Task task = task_of(section, asked); // whatever is in the cache, so that what is wrong is told
  const std::filesystem::path file = cache / name_of(section, task);
  if (const auto found = cache.empty() ? std::nullopt : kept(file))
    return *found;
  try {
    const Reference found = solve(task, section);
    if (!cache.empty())
      keep(file, found);
    return found;
  } catch (const ParameterError& error) {
    if (!error.complaint().file.empty())
      throw;
    throw section.complaint("Cells [1]", error.what(), "Write fewer");
  } catch (const DataError&) {
    throw section.complaint("Point [m]",
                            "this point, the one that is subtracted or one of the study lies outside of the body",
                            "Write a point of it");
  }
}

} // namespace kerf::study
