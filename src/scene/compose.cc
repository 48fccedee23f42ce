#include "scene/compose.h"

#include "base/interrupt.h"
#include "scene/compose_body.h"
#include "scene/compose_cut_surface.h"
#include "scene/compose_loads.h"
#include "scene/compose_output.h"
#include "scene/compose_tools.h"

#include <algorithm>
#include <cmath>

namespace kerf::scene {

namespace {

/// Between two things that take long to compose.
void end_if_asked() {
  if (const int signal = wish_to_end(); signal != 0)
    throw Interrupted(signal, " while the scene was composed: no step was run, the results folder is as it was");
}

void compose_time(const Section& section, World& world) {
  const auto parameters = section.read<TimeParameters>();
  const double steps = std::round(parameters.end_time / parameters.time_step);
  if (steps < 1)
    throw section.complaint("End time [s]", "must be at least one time step", "Use a later end or a smaller time step");
  if (steps > 1e9)
    throw section.complaint("Time step [s]", "must lead to the end within 1e9 steps", "Use a larger time step");
  world.time_step = parameters.time_step;
  const std::string key = "Time step [s]";
  const Complaint place = section.complaint(key, "", "").complaint();
  world.time_step_place = {key, place.file, place.path, place.line};
  world.n_steps = static_cast<int>(steps);
}

/// A line for each section that can be left out: there, or not there and what that means.
void say_what_there_is(const Section& root, World& world) {
  const auto say = [&](const std::string& kind, const std::string& present, const std::string& absent) {
    if (root.find(kind) && !present.empty())
      world.composition.push_back(present);
    if (!root.find(kind))
      world.composition.push_back("left out: " + kind + " (" + absent + ")");
  };
  say("Gravity", "gravity", "no field");
  say("Floor", "a floor", "no contact");
  const bool cuts_otherwise = root.find("Cut surface") || root.find("Scissors");
  say("Blade", "", cuts_otherwise ? "no blade by itself" : "no cut machinery in memory");
  say("Scissors", "", "no blades on a pivot");
  say("Forceps", "", "nothing is gripped");
  say("Cut surface", "", "nothing is cut at once");
  say("Observables", line(world.bodies.front().observables.size(), " series of the first body"), "no series but time");
  if (std::none_of(world.bodies.begin(), world.bodies.end(), [](const Body& body) { return body.interior != nullptr; }))
    world.composition.push_back("left out: Interior (revealed faces have one colour)");
  say("Surface file", "surface files for ParaView", "no file for ParaView");
  say("Images", "images: off-screen OpenGL", "no GL context");
}

/// The blades of the world are those of the sections `Blade`, one each, then those of `Scissors`, two each.
void require_meeting_of_all(const Section& root, const World& world) {
  const std::span<const cut::Blade> blades = world.blades;
  std::size_t first = 0;
  for (const auto& [kind, n] : {std::pair("Blade", 1), std::pair("Scissors", 2)})
    for (const Section* section : root.all(kind)) {
      require_meeting(*section, blades.subspan(first, n), world);
      first += n;
    }
}

void require_static_answers(const Section& root, World& world) {
  const auto sections = root.all("Body");
  for (std::size_t i = 0; i < sections.size(); ++i)
    if (sections[i]->read<BodyParameters>().integrator == "quasi-static") {
      hold(world.bodies[i], world.forceps, 1, 0);
      require_static_answer(*sections[i], world.bodies[i]);
    }
}

} // namespace

World compose(const SceneText& text) {
  const Section root = parse_scene(text, grammar());
  World world;
  compose_time(root.require("Time"), world);
  const Section* gravity_section = root.find("Gravity");
  const auto gravity = read_if_written<GravityParameters>(root, "Gravity");
  root.require("Body");

  for (const Section* section : root.all("Blade"))
    compose_blade(*section, world);
  for (const Section* section : root.all("Scissors"))
    compose_scissors(*section, world);
  for (const Section* section : root.all("Cut surface")) {
    world.cut_surfaces.push_back(compose_cut_surface(*section, world));
    const TimedSurface& timed = world.cut_surfaces.back();
    world.composition.push_back(
      line("cut surface ", timed.surface.name, ": cuts at ", (timed.step - 1) * world.time_step, " s"));
  }
  for (const Section* body : root.all("Body")) {
    end_if_asked();
    world.bodies.push_back(compose_body(*body, gravity_section ? &gravity : nullptr, root.all("Floor"), world));
  }
  end_if_asked();
  const auto h = [](const Body& body) { return body.solid.grid.h(); };
  for (cut::Blade& blade : world.blades)
    cut::divide_edge_of_turning(blade, h(*std::ranges::min_element(world.bodies, {}, h)));
  for (const Section* section : root.all("Forceps"))
    compose_forceps(*section, world);
  require_meeting_of_all(root, world);
  require_static_answers(root, world);

  if (const Section* section = root.find("Output"))
    compose_output(*section, world);
  if (const Section* section = root.find("Surface file"))
    world.surface_file = section->read<SurfaceFileParameters>();
  if (const Section* section = root.find("Observables"))
    compose_observables(*section, world);
  if (const Section* section = root.find("Images")) {
    world.images = compose_images(*section);
  }
  say_what_there_is(root, world);
  root.require_all_read();
  return world;
}

} // namespace kerf::scene
