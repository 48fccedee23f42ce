#include "batch.h"
#include "grid/in_use.h"
#include "run_info.h"
#include "scene_arguments.h"

#include "base/parallel.h"
#include "dynamics/sound_steps.h"
#include "scene/compose.h"
#include "scene/crack_report.h"
#include "scene/inputs.h"
#include "scene/run.h"

#include <algorithm>
#include <cstdio>

namespace kerf::apps {

namespace {

void print_body(const scene::Body& body, const scene::Watch& watch) {
  const double volume = surface::enclosed_volume(scene::positions(body), body.surface.triangles);
  const double rest = surface::enclosed_volume(body.surface.rest, body.surface.triangles);
  std::printf("body %s: %zu cells, %zu copies, %u pieces, %zu surface triangles\n", body.name.c_str(),
              body.solid.grid.n_cells(), grid::n_copies_in_use(body.solid.complex), grid::n_pieces(body.solid.complex),
              body.surface.triangles.size());
  std::printf("  volume: mesh %.6e m^3; grid %+.3f %%; cuts changed the rest volume by %+.2e; deformed now %+.3f %%\n",
              body.mesh_volume, 100 * (body.first_volume / body.mesh_volume - 1), rest / body.first_volume - 1,
              100 * (volume / rest - 1));
  std::printf("  energy: elastic %.4e J, kinetic %.4e J\n", body.physics->model().energy(body.state.x),
              scene::find_observable("kinetic energy")->value(body));
  if (body.initial && !watch.is_sound)
    std::printf("  it has not come back from its initial state: parts of it are still crushed or inside out\n");
  if (body.n_divided > 0)
    std::printf(
      "  %d steps taken again, in substeps or by implicit Euler: whole ones failed or gained energy that nothing "
      "gave\n",
      body.n_divided);
  const auto now = [&](const char* name) { return scene::find_observable(name)->value(body); };
  constexpr double much = 0.1; // symplectic Euler takes and gives back as much, near its stable step
  const double gained = now("energy gained"), part = gained / (now("elastic energy") + now("kinetic energy"));
  if (part > much && gained > dynamics::noise_of_steps(body.physics->model(), body.state.x))
    std::printf("  warning: the integrator has gained %.0f %% of the body's kinetic and elastic energy, step by step: "
                "use a smaller time step, or an integrator that gains none\n",
                100 * part);
  if (const std::size_t n = surface::n_bodies(body.surface), n_pieces = grid::n_pieces(body.solid.complex);
      n > n_pieces)
    std::printf("  its %zu pieces are drawn as %zu bodies: what joins them is thinner than the grid resolves. Use a "
                "smaller cube edge\n",
                n_pieces, n);
  if (const std::size_t n = body.interior ? body.interior->atlas.n_coarse() : 0; n > 0)
    std::printf("  %zu triangles have colours farther apart than asked for, %d to a side: use a smaller cube edge\n", n,
                texture::Atlas::max_parts);
  for (const std::string& line : scene::fronts_that_cuts_missed(body))
    std::printf("  warning: %s\n", line.c_str());
  if (body.n_lost_shells > 0)
    std::printf("  %zu shells of the mesh hold no grid node and are lost: use a smaller cube edge\n",
                body.n_lost_shells);
  if (body.n_thin_walls + body.n_thin_gaps + body.n_triple_crossings > 0)
    std::printf(
      "  between nodes: %zu grid edges pass through walls or crests that are lost, %zu through gaps or grooves that are "
      "filled, %zu cross the skin more than once\n",
      body.n_thin_walls, body.n_thin_gaps, body.n_triple_crossings);
}

void print_cut(const scene::World& world, const grid::CutLabel label, const std::string& what,
               const std::string& remedy) {
  std::size_t n = 0, n_passed = 0, n_of_skin = 0, n_left_whole = 0;
  double between = 0;
  for (const scene::Body& body : world.bodies) {
    const auto of_label = [&](const auto& left) { return left.second.label == label; };
    n_left_whole += static_cast<std::size_t>(std::ranges::count_if(body.solid.cuts.edges_left_whole(), of_label) +
                                             std::ranges::count_if(body.solid.cuts.segments_left_whole(), of_label));
    n += body.cutter->counts().n_cut_edges[label - 1];
    between += body.cutter->counts().between[label - 1];
    n_passed += body.cutter->n_passed_cells(label);
    n_of_skin +=
      static_cast<std::size_t>(std::ranges::count(body.solid.cuts.skin_cuts(), label, &grid::SkinCut::label));
  }
  const std::string why = n > 0          ? ""
                          : n_of_skin > 0
                            ? ": it cut " + std::to_string(n_of_skin) + " parts of the skin between them"
                          : n_passed > 0 ? ": it passed between them. Use a smaller cube edge, or cut deeper"
                          : n_left_whole > 0 ? ": what it met was left whole. " + remedy
                                         : ": it never met a body. " + remedy;
  std::printf("%s: cut %zu grid edges%s\n", what.c_str(), n, why.c_str());
  if (between >= 1)
    std::printf("  nearer than a cube to earlier cuts: a neighbour has some %.3g cubes of what lies between. Use a "
                "smaller cube edge\n",
                between);
}

void print_cutting(const scene::World& world) {
  for (const cut::Blade& blade : world.blades)
    print_cut(world, blade.label, "blade " + blade.name, "Check its key frames");
  for (const auto& [surface, step] : world.cut_surfaces)
    print_cut(world, surface.label, "cut surface " + surface.name, "Check its place and time");
  std::size_t n_double = 0, n_waiting = 0, n_passed = 0, n_left_whole = 0, n_crumbs = 0;
  for (const scene::Body& body : world.bodies)
    if (body.cutter) {
      n_double += body.cutter->counts().n_double_crossings;
      n_waiting += body.cutter->n_waiting();
      n_left_whole += body.solid.cuts.n_left_whole();
      n_passed += body.cutter->n_passed_cells();
      n_crumbs += body.physics->crumbs().size();
    }
  if (n_double + n_waiting > 0)
    std::printf("  %zu edges crossed twice by one cut and left whole, %zu cuts still waiting\n", n_double, n_waiting);
  if (n_left_whole > 0)
    std::printf("  %zu edges left whole: behind them are shavings with less material than a cube, or none\n",
                n_left_whole);
  if (n_crumbs > 0)
    std::printf("  %zu crumbs, pieces that the grid cannot deform: they moved as rigid bodies\n", n_crumbs);
  if (n_passed > 0)
    std::printf("  %zu cells passed without a cut: the blade met none of their edges\n", n_passed);
}

void print_summary(const scene::World& world, const Timings& seconds, const int n_steps,
                   const SceneArguments& arguments) {
  for (std::size_t b = 0; b < world.bodies.size(); ++b)
    print_body(world.bodies[b], world.watches[b]);
  print_cutting(world);
  double all = 0, recording = 0;
  std::printf("time per stage [s]:");
  for (const std::string& stage : scene::stages()) {
    const auto s = seconds.find(stage);
    const double value = s == seconds.end() ? 0 : s->second;
    std::printf("  %s %.2f", stage.c_str(), value);
    all += value;
    recording += stage == "images" || stage == "output" ? value : 0;
  }
  std::printf("\n%.1f steps/s without images and files, %.1f with\n", n_steps / (all - recording), n_steps / all);
  std::printf("results in %s\n", arguments.output.c_str());
}

} // namespace

int run(const Arguments& arguments) {
  const SceneArguments parsed = parse_scene_arguments(arguments, Scenes::several);
  if (parsed.scenes.size() > 1)
    return run_batch(parsed);
  if (parsed.n_threads > 0)
    set_n_threads(parsed.n_threads);
  const scene::SceneText text = read_text(parsed);
  output::require_claimable(parsed.output, parsed.earlier);
  const auto source = [&] {
    return scene::Source{run_info("run", arguments), scene::standalone_text(text, scene::grammar()),
                         scene::hashes_of_inputs(text, scene::grammar())};
  };
  if (parsed.earlier == output::Earlier::resume && scene::is_complete(parsed.output)) {
    scene::require_same(parsed.output, source());
    std::printf("%s holds a complete run: nothing is left to resume\n", parsed.output.c_str());
    return 0;
  }
  scene::World world = [&] {
    const scene::LongWork composing("Composing the scene", stdout);
    return scene::compose(text);
  }();
  for (const std::string& line : world.composition)
    std::printf("%s\n", line.c_str());
  std::fflush(stdout);

  scene::Recorder recorder(parsed.output, world, source(), parsed.earlier);
  scene::Progress progress(world.n_steps, world.n_steps * world.time_step, scene::progress_style(stdout), stdout);
  const Timings seconds = scene::run(world, recorder, progress);
  print_summary(world, seconds, progress.n_taken(), parsed);
  return 0;
}

} // namespace kerf::apps
