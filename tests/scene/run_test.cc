// What a run leaves in its files: times of its stages, energies that fit, and the story of its failure.

#include "base/error.h"
#include "tests/scene/worlds.h"

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <numeric>

#include <unistd.h>

namespace kerf::scene::run_test {
namespace {

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

TEST(Run, TimesEveryStageOfEveryStep) {
  const output::TemporaryFolder folder;
  const auto start = std::chrono::steady_clock::now();
  World world = world_of(cube_scene() + falling_blade() + all_outputs());
  const Timings total = run_silently(world, folder / "out");
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  const output::Reader reader(folder / "out/run.h5");
  EXPECT_EQ(reader.steps(), (std::vector<std::int64_t>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(reader.schema().stages, stages());
  double all = 0;
  for (const std::string& stage : stages()) {
    const auto seconds = reader.timing(stage);
    EXPECT_EQ(seconds.size(), 6u) << stage;
    for (const double s : seconds)
      EXPECT_GE(s, 0) << stage;
    if (stage == "colour") { // of what is inside, which this scene does not say
      EXPECT_FALSE(total.contains(stage));
      continue;
    }
    EXPECT_GT(total.at(stage), 0) << stage;
    // Composing stands with step 0 and is not the run's; what writing the last step took comes too late for the file.
    EXPECT_LE(sum(seconds) - seconds.at(0), total.at(stage) * (1 + 1e-12)) << stage;
    all += total.at(stage);
  }
  EXPECT_LT(all, wall);
}

TEST(Run, RecordsSeriesEveryStepAndFramesWhenDue) {
  const output::TemporaryFolder folder;
  World world = world_of(cube_scene() + falling_blade() + all_outputs(), {"Output/Frames every [1]=2"});
  run_silently(world, folder / "out");
  const output::Reader reader(folder / "out/run.h5");
  for (const Observable& o : world.bodies.at(0).observables) {
    const std::string name = "cube " + o.name;
    EXPECT_EQ(reader.observable(name).size(), 6u) << name;
    EXPECT_EQ(reader.observable(name).back(), o.value(world.bodies[0])) << name;
    EXPECT_EQ(reader.attribute("/observables/" + name, "unit"), o.unit);
    EXPECT_EQ(reader.attribute("/observables/" + name, "source"), o.source);
  }
  std::vector<std::int64_t> steps;
  for (std::size_t i = 0; i < reader.n_frames("cube"); ++i)
    steps.push_back(reader.frame("cube", i).step);
  EXPECT_EQ(steps, (std::vector<std::int64_t>{0, 2, 4, 5}));
  EXPECT_NEAR(reader.times().back(), 0.05, 1e-15);
}

TEST(Run, AFramesComplexAndSurfaceBelongToItsCorners) {
  const output::TemporaryFolder folder;
  World world = world_of(cube_scene() + falling_blade() + all_outputs());
  run_silently(world, folder / "out");
  const output::Reader reader(folder / "out/run.h5");
  EXPECT_EQ(reader.n_complexes("cube"), world.bodies[0].n_recuts + 1u);
  EXPECT_GT(world.bodies[0].n_recuts, 1);
  for (std::size_t i = 0; i < reader.n_frames("cube"); ++i) {
    const output::Frame frame = reader.frame("cube", i);
    EXPECT_EQ(reader.complex("cube", frame.complex).rest_positions.size(), frame.positions.size());
    const output::Surface surface = reader.surface("cube", frame.complex);
    EXPECT_EQ(surface.weights.start.size(), surface.rest_positions.size() + 1);
    for (const std::uint32_t column : surface.weights.columns)
      EXPECT_LT(column, frame.positions.size());
  }
}

TEST(Run, ClearsImagesOfAnEarlierRun) {
  const output::TemporaryFolder folder;
  World earlier = world_of(cube_scene() + all_outputs());
  run_silently(earlier, folder / "out");
  std::filesystem::copy_file(folder / "out/frames/000005.png", folder / "out/frames/000077.png");
  std::ofstream(folder / "out/frames/notes.txt") << "mine";
  World world = world_of(cube_scene() + all_outputs());
  run_silently(world, folder / "out");
  EXPECT_FALSE(std::filesystem::exists(folder / "out/frames/000077.png"));
  EXPECT_TRUE(std::filesystem::exists(folder / "out/frames/notes.txt"));
  EXPECT_TRUE(std::filesystem::exists(folder / "out/frames/000005.png"));
}

/// Both integrators lose m g^2 dt t / 2 in free fall, exactly: v_n = n g dt, x_n = x_0 + g dt^2 n (n + 1) / 2.
TEST(Run, FreeFallKeepsItsEnergyToTheSchemesAccuracy) {
  for (const std::string integrator : {"implicit Euler", "symplectic Euler"})
    for (const double dt : {1e-3, 5e-4}) {
      SCOPED_TRACE(integrator + ", time step " + std::to_string(dt));
      Overrides overrides = {"Time/Time step [s]=" + std::to_string(dt), "Body cube/Integrator=" + integrator};
      if (integrator == "implicit Euler")
        overrides.push_back("Body cube/Implicit Euler/CG tolerance [1]=1e-13");
      const output::TemporaryFolder folder;
      World world = world_of(cube_scene() + all_outputs(), overrides);
      world.images.reset();
      run_silently(world, folder / "out");
      const output::Reader reader(folder / "out/run.h5");
      const auto kinetic = reader.observable("cube kinetic energy"),
                 potential = reader.observable("cube gravity energy"),
                 elastic = reader.observable("cube elastic energy"), times = reader.times();
      const double m = 8, g = 9.81, fallen = 0.5 * m * g * g * times.back() * times.back();
      EXPECT_NEAR(kinetic.back(), fallen, 1e-9 * fallen);
      for (std::size_t i = 0; i < times.size(); ++i) {
        EXPECT_NEAR(kinetic[i] + potential[i] - potential[0], -0.5 * m * g * g * dt * times[i], 1e-8 * fallen);
        EXPECT_LE(elastic[i], 1e-8 * fallen);
      }
    }
}

/// With mass damping alpha alone, momentum falls by 1 / (1 + alpha dt) a step, whatever the body does inside.
TEST(Run, MassDampingBrakesAsItShould) {
  for (const std::string integrator : {"implicit Euler", "symplectic Euler"}) {
    SCOPED_TRACE(integrator);
    const output::TemporaryFolder folder;
    World world = world_of(
      cube_scene() + "subsection Observables\n set Names = momentum x\nend\n",
      {"Time/Time step [s]=0.001", "Body cube/Damping/Mass damping [1/s]=10", "Body cube/Integrator=" + integrator});
    set_in_motion(world.bodies[0], Vec3::UnitX(), 0.01);
    run_silently(world, folder / "out");
    const auto momentum = output::Reader(folder / "out/run.h5").observable("cube momentum x");
    for (std::size_t n = 0; n < momentum.size(); ++n)
      EXPECT_NEAR(momentum[n], momentum[0] * std::pow(1.01, -static_cast<double>(n)), 1e-5 * momentum[0]);
  }
}

/// Energy that is left after a while in a cube that quivers, over that at its start.
double energy_left(const Overrides& overrides) {
  const output::TemporaryFolder folder;
  Overrides all = {"Time/Time step [s]=0.0005", "Time/End time [s]=0.02"};
  all.insert(all.end(), overrides.begin(), overrides.end());
  World world =
    world_of(cube_scene() + "subsection Observables\n set Names = kinetic energy, elastic energy\nend\n", all);
  set_in_motion(world.bodies[0], Vec3::Zero(), 0.1);
  run_silently(world, folder / "out");
  const output::Reader reader(folder / "out/run.h5");
  const auto kinetic = reader.observable("cube kinetic energy"), elastic = reader.observable("cube elastic energy");
  return (kinetic.back() + elastic.back()) / (kinetic.front() + elastic.front());
}

TEST(Run, DampingTakesEnergy) {
  const std::string explicit_one = "Body cube/Integrator=symplectic Euler";
  const double free = energy_left({explicit_one});
  EXPECT_NEAR(free, 1, 0.1); // symplectic: it swings, and does not drift
  EXPECT_LT(energy_left({explicit_one, "Body cube/Damping/Mass damping [1/s]=20"}), 0.7 * free);
  EXPECT_LT(energy_left({explicit_one, "Body cube/Damping/Stiffness damping [s]=0.001"}), 0.9 * free);
  EXPECT_LT(energy_left({}), 1);
  EXPECT_LT(energy_left({"Body cube/Damping/Stiffness damping [s]=0.01"}), 0.9 * energy_left({}));
}

TEST(Run, TellsWhenAndWhyItFailed) {
  const output::TemporaryFolder folder;
  World world = world_of(cube_scene() + all_outputs(), {"Body cube/Integrator=symplectic Euler",
                                                        "Body cube/Symplectic Euler/Beyond the stable step=go on",
                                                        "Time/Time step [s]=0.5", "Time/End time [s]=200"});
  world.images.reset();
  set_in_motion(world.bodies[0], Vec3::Zero(), 0.1);
  std::string message;
  try {
    run_silently(world, folder / "out");
    FAIL() << "ran to its end";
  } catch (const NumericalError& error) {
    message = error.what();
  }
  const output::Reader reader(folder / "out/run.h5");
  EXPECT_EQ(reader.outcome(), output::Outcome::failed);
  const auto failure = reader.failure();
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->text, message);
  EXPECT_NEAR(failure->time, 0.5 * failure->step, 1e-12);
  EXPECT_NE(message.find("body cube, step " + std::to_string(failure->step) + ", time "), std::string::npos) << message;
  EXPECT_EQ(reader.n_steps(), static_cast<std::size_t>(failure->step)); // steps 0 .. the one before
  EXPECT_EQ(reader.n_frames("cube"), static_cast<std::size_t>(failure->step));
  for (const Vec3& x : reader.frame("cube", failure->step - 1).positions)
    EXPECT_TRUE(x.allFinite());
}

/// Not the material, the loads or the time step.
TEST(Run, AFunctionOfTimeThatIsNotFiniteIsNamed) {
  World world = world_of(cube_scene(), {"Body cube/Support top/Lower [m]=-1, -1, 0.05",
                                        "Body cube/Support top/Upper [m]=1, 1, 1",
                                        "Body cube/Support top/Displacement [m]=0; 0; sqrt((t - 0.012) * (t - 0.024))"});
  const output::TemporaryFolder folder;
  try {
    run_silently(world, folder / "out");
    FAIL() << "nothing was thrown";
  } catch (const ParameterError& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find("Support top/Displacement [m]"), std::string::npos) << what;
    EXPECT_NE(what.find("not at t = 0.02"), std::string::npos) << what;
  }
}

TEST(Run, NeedsAFolderThatCanBeMade) {
  const output::TemporaryFolder folder;
  std::ofstream(folder / "file") << "no folder";
  World world = world_of(cube_scene());
  EXPECT_THROW(run_silently(world, folder / "file/out"), DataError);
  EXPECT_THROW(output::require_claimable(folder / "file/out", output::Earlier::refuse), DataError);
  EXPECT_THROW(output::require_claimable(folder / "file", output::Earlier::refuse), DataError);
  std::filesystem::create_directory(folder / "locked");
  std::filesystem::permissions(folder / "locked", std::filesystem::perms::owner_read);
  if (geteuid() != 0) { // root may write everywhere
    EXPECT_THROW(output::require_claimable(folder / "locked/out", output::Earlier::refuse), DataError);
  }
  std::filesystem::permissions(folder / "locked", std::filesystem::perms::owner_all);
  EXPECT_NO_THROW(output::require_claimable(folder / "a/b/c", output::Earlier::refuse));
  EXPECT_NO_THROW(output::require_claimable(folder / ".", output::Earlier::refuse));
  EXPECT_FALSE(std::filesystem::exists(folder / "a")) << "asking makes nothing";
}

} // namespace
} // namespace kerf::scene::run_test
