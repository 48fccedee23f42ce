#include "scene/compose_tools.h"

#include "cut/blade_edge.h"
#include "cut/scissors.h"
#include "geometry/box_tree.h"
#include "scene/held.h"
#include "scene/support_report.h"
#include "scene/tool_shapes.h"

#include <algorithm>
#include <limits>
#include <map>

namespace kerf::scene {

namespace {

std::vector<cut::KeyFrame> read_key_frames(const Section& section) {
  const auto motion = section.read<MotionParameters>();
  const std::string must_match = line("must be as many as Times [s], which are ", motion.times.size());
  if (motion.positions.size() != motion.times.size())
    throw section.complaint("Positions [m]", must_match, "Write one position for each time, separated by semicolons");
  if (!motion.rotations.empty() && motion.rotations.size() != motion.times.size())
    throw section.complaint("Rotations [degrees]", must_match + ", or none",
                            "Write one rotation vector for each time, separated by semicolons");
  std::vector<cut::KeyFrame> frames;
  for (std::size_t i = 0; i < motion.times.size(); ++i)
    frames.push_back(
      {motion.times[i], motion.positions[i], motion.rotations.empty() ? Vec3(Vec3::Zero()) : motion.rotations[i]});
  return frames;
}

Points read_edge(const Section& section, const std::string& key, const Points& points, const std::string& form) {
  if (form == "polyline")
    return points;
  try {
    return cut::arcs(points);
  } catch (const ParameterError& error) {
    throw placed(section, key, error);
  }
}

/// The key of a section that a complaint of cut/ is about.
std::string key_of(const Complaint& complaint) {
  static const std::map<std::string, std::string> keys = {{"Key frames", "Times [s]"},
                                                          {"Rotations", "Rotations [degrees]"},
                                                          {"Angles", "Openings [degrees]"},
                                                          {"Angle times", "Opening times [s]"}};
  const std::string name = complaint.path.substr(complaint.path.find('/') + 1);
  const auto key = keys.find(name);
  return key == keys.end() ? name : key->second;
}

std::array<cut::Blade, 2> make_blades(const Section& section, const cut::Scissors& scissors,
                                      const grid::CutLabel label) {
  try {
    return cut::blades(scissors, label);
  } catch (const ParameterError& error) {
    const bool is_about_second = error.complaint().path.find(" second/Edge") != std::string::npos;
    throw placed(section, is_about_second ? "Second edge [m]" : key_of(error.complaint()), error);
  }
}

std::vector<cut::AngleFrame> openings(const Section& section, const ScissorsParameters& parameters) {
  if (parameters.openings.size() != parameters.opening_times.size())
    throw section.complaint("Openings [degrees]",
                            line("must be as many as Opening times [s], which are ", parameters.opening_times.size()),
                            "Write one angle for each time, separated by commas");
  std::vector<cut::AngleFrame> frames;
  for (std::size_t i = 0; i < parameters.openings.size(); ++i)
    frames.push_back({parameters.opening_times[i], parameters.openings[i]});
  return frames;
}

/// From a blade's first key frame to its last, whichever list it is in [s].
std::pair<double, double> times_of_motion(const cut::Blade& blade) {
  double first = blade.key_frames.front().time, last = blade.key_frames.back().time;
  if (blade.hinge) {
    first = std::min(first, blade.hinge->angles.front().time);
    last = std::max(last, blade.hinge->angles.back().time);
  }
  return {first, last};
}

/// How far a body may go until a time, but for its fall [m]: by half its size as it deforms, as it was thrown, and as
/// supports carry it; anywhere where other loads or tools move it.
double way_until(const double time, const Body& body, const World& world) {
  constexpr double anywhere = 1e9;
  if (!body.load_makers.empty() || !world.forceps.empty())
    return anywhere;
  const Box box = geometry::box_around(positions(body));
  double fastest = 0, carried = 0;
  for (const Vec3& v : body.state.v)
    fastest = std::max(fastest, v.norm());
  for (const dynamics::Support& support : body.loads.supports) {
    constexpr int n_times = 100;
    for (int i = 0; i <= n_times; ++i)
      for (const Vec3& rest : support.rest)
        carried = std::max(carried, (support.places(i * time / n_times)(rest) - rest).norm());
  }
  return 0.5 * (box.upper - box.lower).norm() + fastest * time + carried;
}

/// Of what stands where it is first all the time.
void warn_of_times(const std::string& what, const cut::Blade& blade, World& world) {
  const auto [first, last] = times_of_motion(blade);
  const double end = world.n_steps * world.time_step;
  if (first < last && first >= end)
    world.composition.push_back(line("warning: ", what, ": its first key frame is at ", first,
                                     " s, when the run has ended at ", end,
                                     " s, so nothing of it moves. Let it come earlier, or the run end later"));
}

bool comes_near(const cut::Blade& blade, const Body& body, const World& world) {
  const auto [first, last] = times_of_motion(blade);
  Points path = cut::world_points(blade, first);
  for (const auto& triangle : cut::sweep(blade, first, last))
    path.insert(path.end(), triangle.begin(), triangle.end());
  const Box swept = geometry::box_around(path), box = geometry::box_around(positions(body));
  const double time = std::min(last, world.n_steps * world.time_step);
  const Vec3 slack = Vec3::Constant(way_until(time, body, world)), fall = 0.5 * time * time * body.loads.gravity;
  return geometry::overlap(swept, Box{box.lower - slack + fall.cwiseMin(0), box.upper + slack + fall.cwiseMax(0)});
}

/// The particles of all bodies that rest in a region [m].
Points held_in(const Region& region, const World& world) {
  Points held;
  for (const Body& body : world.bodies)
    for (const auto i : particles_in(body, region))
      held.push_back(body.physics->rest()[i]);
  return held;
}

void check_times(const Section& section, const Forceps& forceps, const World& world) {
  if (forceps.grip_step > world.n_steps)
    throw section.complaint(
      "Grip time [s]",
      line("must be before the last step, which begins at ", (world.n_steps - 1) * world.time_step, " s"),
      "Grip earlier, or let the run end later");
  if (forceps.release_step <= forceps.grip_step)
    throw section.complaint("Release time [s]", "must be at least a step after Grip time [s]",
                            "Release later, or not at all: leave it out");
}

} // namespace

void compose_blade(const Section& section, World& world) {
  const auto parameters = section.read<BladeParameters>();
  cut::Blade blade{.name = section.name(),
                   .edge = read_edge(section, "Edge [m]", parameters.edge, parameters.edge_form),
                   .key_frames = read_key_frames(section),
                   .label = static_cast<grid::CutLabel>(world.blades.size() + 1),
                   .spine = parameters.spine};
  try {
    cut::check(blade);
  } catch (const ParameterError& error) {
    throw placed(section, key_of(error.complaint()), error);
  }
  if (blade.spine.isZero(0))
    blade.spine = usual_spine(blade);
  world.composition.push_back("blade " + section.name());
  warn_of_times("blade " + section.name(), blade, world);
  world.blades.push_back(std::move(blade));
}

void compose_scissors(const Section& section, World& world) {
  const auto parameters = section.read<ScissorsParameters>();
  const Points& second = parameters.second_edge.empty() ? parameters.edge : parameters.second_edge;
  cut::Scissors scissors{.name = section.name(),
                         .pivot = parameters.pivot,
                         .axis = parameters.axis.stableNormalized(),
                         .edges = {read_edge(section, "Edge [m]", parameters.edge, parameters.edge_form),
                                   read_edge(section, "Second edge [m]", second, parameters.edge_form)},
                         .spines = {parameters.spine, Vec3(-parameters.spine)},
                         .openings = openings(section, parameters),
                         .key_frames = read_key_frames(section)};
  if (const Vec3 spine = usual_spine(scissors); parameters.spine.isZero(0))
    scissors.spines = {spine, Vec3(-spine)};
  world.scissors.push_back({world.blades.size(), scissors.pivot, scissors.axis, parameters.handle});
  for (cut::Blade& blade : make_blades(section, scissors, static_cast<grid::CutLabel>(world.blades.size() + 1)))
    world.blades.push_back(std::move(blade));
  world.composition.push_back("scissors " + section.name() + ": two blades on a pivot");
  warn_of_times("scissors " + section.name(), world.blades.back(), world);
}

void compose_forceps(const Section& section, World& world) {
  const auto parameters = section.read<ForcepsParameters>();
  Forceps forceps{.name = section.name(),
                  .region = read_region(section, parameters.region),
                  .key_frames = read_key_frames(section),
                  .grip_step = first_step_from(parameters.grip_time, world.time_step, world.n_steps),
                  .release_step = first_step_from(parameters.release_time, world.time_step, world.n_steps),
                  .jaws = parameters.jaws,
                  .handle = parameters.handle};
  check_times(section, forceps, world);
  try {
    cut::check_key_frames(forceps.key_frames, section.path());
  } catch (const ParameterError& error) {
    throw placed(section, key_of(error.complaint()), error);
  }
  const Points held = held_in(forceps.region, world);
  if (held.empty())
    throw section.complaint("the region holds no corner or phyxel of a body",
                            "Move or enlarge it: it is meant in the rest configuration, in metres");
  complete_shape(forceps, world, parameters.grip_time);
  world.composition.push_back(line("forceps ", forceps.name, ": hold ", held.size(), " corners or phyxels from step ",
                                   forceps.grip_step, ", ", extent(held)));
  for (const Body& body : world.bodies)
    for (const std::string& warning : warn_of_layers(body, "forceps " + forceps.name, forceps.region))
      world.composition.push_back(warning);
  world.forceps.push_back(std::move(forceps));
}

void require_meeting(const Section& section, const std::span<const cut::Blade> blades, const World& world) {
  for (const cut::Blade& blade : blades)
    for (const Body& body : world.bodies)
      if (comes_near(blade, body, world))
        return;
  throw section.complaint("the blade never comes near a body",
                          "Check units and key frames: positions are in metres, in the world frame");
}

} // namespace kerf::scene
