/// What colours cost while a liver is cut: params/liver.prm with three sections of a brain drawn to its own, at 1 mm,
/// without and with small features and relief. Share of colour in the time of the frames that reveal faces: the mean of
/// all their time, the median and the worst of them; and what the worst one filled. Nothing is written or drawn. The
/// same steps are run several times, and of each frame the shortest times count: what else the machine does makes them
/// longer. Times are the processor's: colour is timed on an atlas of our own, which is filled once more when the next
/// frame has been: what it reads is then as cold as it was. Scenes that are named are measured instead, with the
/// insides that they have.
///
///     bench_texture_share [THREADS [RUNS [SCENE...]]]

#include "base/parallel.h"
#include "scene/compose.h"
#include "scene/run.h"
#include "tests/support/checkout.h"

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <string>

namespace {

using namespace kerf;
using namespace kerf::scene;

std::string exemplar(const std::string& file, const std::string& origin, const std::string& column,
                     const std::string& row) {
  return "    subsection Exemplar " + file + "\n      set Image = sections/brain/" + file +
         ".png\n      set Background = black\n      set Fit = rigid\n      set Origin [m] = " + origin +
         "\n      set Column [m] = " + column + "\n      set Row [m] = " + row + "\n    end\n";
}

std::string interior(const std::string& more) {
  return "  subsection Interior\n    set Resolution [m] = 0.001\n    set Components = together\n" + more +
         exemplar("axial_z75", "0.05, 0, 0.075", "0.0007, 0, 0", "0, 0.0005, 0") +
         exemplar("sagittal_x60", "0.1, 0, 0", "0, 0.0005, 0", "0, 0, 0.0005") +
         exemplar("coronal_y140", "0.05, 0.08, 0", "0.0007, 0, 0", "0, 0, 0.0005") + "  end\n";
}

/// A scene that writes and draws nothing, with an inside put before a line of it.
World world_of(const std::string& file, const std::string& inside = "", const std::string& before = "") {
  std::string lines = read_scene_text(file, {}).text;
  if (!inside.empty())
    lines.insert(lines.find(before), inside);
  for (const char* output : {"subsection Surface file", "subsection Images"}) {
    const std::size_t at = lines.find(output);
    if (at != std::string::npos)
      lines.erase(at, lines.find("\nend", at) + 5 - at);
  }
  return compose(scan_scene_text(lines, file, {}));
}

World liver_with(const std::string& more) {
  return world_of(support::checkout() + "/params/liver.prm", interior(more), "  subsection Support back");
}

struct Frame {
  int step = 0;
  std::size_t n_samples = 0;
  double colour = 0, all = 0; ///< [s]
  double share() const { return colour / all; }
};

template <class Function>
double processor_seconds(const Function& f) {
  const std::clock_t start = std::clock();
  f();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

std::size_t n_samples_of_last_fill(const texture::Atlas& atlas) {
  std::size_t n = 0;
  for (std::size_t t = 0; t < atlas.first().size(); ++t)
    n += atlas.fill_of()[t] == atlas.n_fills() ? texture::n_samples(atlas.parts()[t]) : 0;
  return n;
}

std::vector<Frame> revealing_frames(World& world) {
  const Body& body = world.bodies.front();
  const BodyInterior& interior = *body.interior;
  texture::Atlas again = interior.atlas;
  surface::Surface revealed;
  std::vector<Frame> frames;
  const auto time_colour = [&] {
    frames.back().colour = processor_seconds([&] {
      again.fill({revealed.rest, revealed.triangles, revealed.labels},
                 {&interior.inside, interior.detail.get(), nullptr, interior.relief});
    });
  };
  for (int step = 1; step <= world.n_steps; ++step) {
    const std::uint32_t before = interior.atlas.n_fills();
    Timings timings;
    const double seconds = processor_seconds([&] { advance(world, step, timings); });
    if (interior.atlas.n_fills() == before)
      continue;
    if (!frames.empty())
      time_colour();
    frames.push_back({step, n_samples_of_last_fill(interior.atlas), 0, seconds});
    revealed = body.surface;
  }
  time_colour();
  return frames;
}

template <class Make>
std::vector<Frame> shortest_frames(const Make& make, const int n_runs) {
  std::vector<Frame> frames;
  for (int run = 0; run < n_runs; ++run) {
    World world = make();
    const std::vector<Frame> again = revealing_frames(world);
    frames.resize(again.size(), {0, 0, 1e300, 1e300});
    for (std::size_t i = 0; i < frames.size(); ++i)
      frames[i] = {again[i].step, again[i].n_samples, std::min(frames[i].colour, again[i].colour),
                   std::min(frames[i].all, again[i].all)};
  }
  return frames;
}

template <class Make>
void measure(const std::string& what, const int n_runs, const Make& make) {
  std::vector<Frame> frames = shortest_frames(make, n_runs);
  std::sort(frames.begin(), frames.end(), [](const Frame& a, const Frame& b) { return a.share() < b.share(); });
  double colour = 0, all = 0, samples = 0;
  for (const Frame& frame : frames) {
    colour += frame.colour;
    all += frame.all;
    samples += static_cast<double>(frame.n_samples);
  }
  const Frame& worst = frames.back();
  std::printf("%-34s %6zu %9.2f %9.2f %9.2f   step %d: %zu samples in %.2f of %.2f ms; %.3g samples/s\n", what.c_str(),
              frames.size(), 100 * colour / all, 100 * frames[frames.size() / 2].share(), 100 * worst.share(),
              worst.step, worst.n_samples, 1e3 * worst.colour, 1e3 * worst.all, samples / colour);
}

} // namespace

int main(const int argc, char** const argv) {
  set_n_threads(argc > 1 ? std::atoi(argv[1]) : 1);
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  std::printf("%-34s %6s %9s %9s %9s\n", "share of colour [%]", "frames", "mean", "median", "worst");
  const int n_runs = argc > 2 ? std::atoi(argv[2]) : 5;
  for (int i = 3; i < argc; ++i)
    measure(argv[i], n_runs, [&] { return world_of(argv[i]); });
  if (argc > 3)
    return 0;
  const std::string detail = "    set Small features = yes\n";
  measure("plain", n_runs, [] { return liver_with(""); });
  measure("small features", n_runs, [&] { return liver_with(detail); });
  measure("small features and relief", n_runs, [&] { return liver_with(detail + "    set Relief [m] = 0.0005\n"); });
  return 0;
}
