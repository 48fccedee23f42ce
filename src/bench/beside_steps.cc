#include "bench/path.h"
#include "image/file.h"
#include "scene/recorder.h"
#include "scene/run.h"
#include "surface/surface.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

#include <unistd.h>

namespace kerf::bench {

namespace {

constexpr double dt = 1.0 / 60;

/// A folder of this process, until it goes.
class Folder {
 public:
  Folder() : path_(std::filesystem::temp_directory_path() / ("kerf_bench_" + std::to_string(getpid()))) {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~Folder() {
    std::error_code is_left;
    std::filesystem::remove_all(path_, is_left);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// From rest to the balance with gravity.
Ready equilibrium(scene::World& world) {
  scene::Body& body = world.bodies[0];
  const auto start = std::make_shared<dynamics::State>(body.state);
  return {body.solid.complex.n_copies(), [&body, start] {
            body.state = *start;
            body.physics->step(body.state, body.loads, 1);
          }};
}

/// Several seconds each in large bodies: few are enough.
Measured modes(const int n, const Options& options) {
  const auto world = world_of(cube_scene(n, 1, 1, " set Integrator = modal\n"));
  scene::Body& body = world->bodies[0];
  return {body.solid.complex.n_copies(),
          timed([&] { body.physics->step(body.state, body.loads, 1); }, std::min(options.n_samples, 3), options.least)};
}

Ready first_surface(scene::World& world) {
  const grid::Solid& solid = world.bodies[0].solid;
  const surface::Surface surface = surface::build_surface(solid);
  return {surface.triangles.size(), [&solid] { surface::build_surface(solid); }, {unknown, double(surface.n_bytes())}};
}

/// What a step leaves in the files of a run that is never at its end.
struct Recording {
  explicit Recording(const scene::World& of) : world(of) { record(); }
  void record() { recorder.record(world, step++, seconds); }

  const scene::World& world;
  Folder folder;
  scene::Recorder recorder = {folder.path() / "run", world, {}, output::Earlier::refuse};
  int step = 0;
  Timings seconds;
};
constexpr int no_end = 1'000'000; // steps

Path recording(const std::string& name, const std::string& item,
               const std::function<std::size_t(const scene::Body&)>& n) {
  return {name,
          item,
          [n](scene::World& world) {
            scene::Body& body = world.bodies[0];
            body.state.x = stirred(body.physics->rest(), body.solid.grid.h());
            return Ready{n(body), [kept = std::make_shared<Recording>(world)] { kept->record(); }};
          },
          {}};
}

/// Waves of three colours, whose length is a fifth of the picture.
void write_section(const std::filesystem::path& file, const int n, const double phase) {
  image::Colours colours(n, n, image::Rgb::Zero());
  for (int r = 0; r < n; ++r)
    for (int c = 0; c < n; ++c)
      for (int i = 0; i < 3; ++i)
        colours(c, r)[i] =
          static_cast<float>(0.5 + 0.25 * std::sin(31.0 * c / n + phase + i) + 0.25 * std::cos(31.0 * r / n - phase));
  image::write_image(colours, file.string());
}

/// A plane of the cube is revealed, four samples to an edge of its cells, between three sections.
Measured colours_of_the_inside(const int n, const Options& options) {
  constexpr int n_pixels = 128;
  constexpr double side = 1.1, pixel = side / (n_pixels - 1);
  const Folder folder;
  std::ostringstream body, cut;
  body << " subsection Interior\n  set Resolution [m] = " << 0.25 / n << "\n";
  for (const double height : {-0.3, 0.0, 0.3}) {
    const std::string name = "section_" + std::to_string(std::lround(10 * height) + 3);
    const std::filesystem::path file = folder.path() / (name + ".png");
    write_section(file, n_pixels, 2 * height);
    body << "  subsection Exemplar " << name << "\n   set Image = " << file.string()
         << "\n   set Background = none\n   set Origin [m] = " << -0.5 * side << ", " << -0.5 * side << ", " << height
         << "\n   set Column [m] = " << pixel << ", 0, 0\n   set Row [m] = 0, " << pixel << ", 0\n  end\n";
  }
  body << " end\n";
  cut << "subsection Cut surface saw\n set Time [s] = 0\n set Shape = plane\n set Point [m] = 0.013, 0, 0\n set Normal [1] = 1, 0.2, 0.1\nend\n";
  std::vector<double> seconds;
  std::size_t n_samples = 0;
  for (int i = 0; i < std::min(options.n_samples, 3); ++i) {
    const auto world = world_of(cube_scene(n, dt, 1, body.str(), cut.str()), (folder.path() / "cut.prm").string());
    Timings stages;
    scene::advance(*world, 1, stages);
    n_samples = world->bodies[0].interior->atlas.colours().size();
    seconds.push_back(stages["colour"]);
  }
  return {n_samples, sample_of(seconds)};
}

std::size_t n_triangles(const scene::Body& body) { return body.surface.triangles.size(); }

} // namespace

std::vector<Group> groups_beside_steps() {
  constexpr double few = 5.1e4, all = 1e9;
  const auto scene = [](const std::string& body, const std::string& beside = "") {
    return [=](const int n) { return cube_scene(n, dt, no_end, body, beside); };
  };
  return {
    {scene(" set Integrator = quasi-static\n"), all, {{"equilibrium, elements", "elements", equilibrium, {}}}},
    {nullptr, few, {{"six modes, elements", "elements", {}, modes}}},
    {scene(""), all, {{"surface of a body", "triangles", first_surface, {}}}},
    {scene("", "subsection Output\n set Frames every [1] = 1\nend\n"),
     all,
     {recording("a frame of run.h5", "corners",
                [](const scene::Body& body) { return body.solid.complex.n_corners(); })}},
    {scene("", "subsection Output\n set Frames every [1] = " + std::to_string(no_end) +
                 "\nend\nsubsection Images\n set Eye [m] = 3, -2, 1\n set Target [m] = 0, 0, 0\nend\n"),
     all,
     {recording("an image", "triangles", n_triangles)}},
    {nullptr, all, {{"colours of the inside", "samples", {}, colours_of_the_inside}}},
  };
}

} // namespace kerf::bench
