#include "output/run_file.h"

#include "base/error.h"
#include "output/reader.h"
#include "tests/output/samples.h"

#include <gtest/gtest.h>

#include <fstream>

namespace kerf::output::run_file_test {
namespace {

const std::vector<double> two_values = {1, 2};

StepRecord step_with(const BodyStep& body) { return {0.5, 5, {}, two_values, {body}}; }

/// The message of the DataError that `f` throws; empty when it throws none.
template <class Function>
std::string complaint(const Function& f) {
  try {
    f();
    return "";
  } catch (const DataError& error) {
    return error.what();
  }
}

TEST(RunFile, KeepsWhereTheRunComesFrom) {
  const TemporaryFolder folder;
  const auto path = folder / "run.h5";
  const std::string scene = "# Übung\nset Young's modulus [Pa] = 5e4\n";
  {
    RunFile file(path, sample_info(), sample_schema());
    file.write_scene(scene);
    file.write_composition({"built: fem", "", "left out: gl, pba"});
  }
  const Reader reader(path);
  const auto info = reader.info(), expected = sample_info();
  EXPECT_EQ(info.version, expected.version);
  EXPECT_EQ(info.git_commit, expected.git_commit);
  EXPECT_EQ(info.command_line, expected.command_line);
  EXPECT_EQ(info.host, expected.host);
  EXPECT_EQ(info.compiler, expected.compiler);
  EXPECT_EQ(info.n_threads, expected.n_threads);
  EXPECT_EQ(info.seed, expected.seed);
  EXPECT_EQ(info.started, expected.started);
  ASSERT_EQ(info.libraries.size(), 2u);
  EXPECT_EQ(info.libraries[0].name, "Eigen");
  EXPECT_EQ(info.libraries[1].version, "9.4.1");
  EXPECT_EQ(reader.scene(), scene);
  EXPECT_EQ(reader.composition(), (std::vector<std::string>{"built: fem", "", "left out: gl, pba"}));
}

TEST(RunFile, KeepsTheSeriesWithTheirUnits) {
  const TemporaryFolder folder;
  const auto path = folder / "run.h5";
  const std::size_t n = 1300; // more than two chunks
  std::vector<double> volumes;
  {
    RunFile file(path, sample_info(), sample_schema());
    for (std::size_t i = 0; i < n; ++i) {
      const std::vector<double> values = {std::sqrt(double(i)), 0};
      volumes.push_back(values[0]);
      file.append({0.01 * double(i), static_cast<std::int64_t>(10 * i), {{"output", double(i)}}, values, {}});
    }
  }
  const Reader reader(path);
  ASSERT_EQ(reader.n_steps(), n);
  EXPECT_EQ(reader.times().back(), 0.01 * double(n - 1));
  EXPECT_EQ(reader.steps().back(), static_cast<std::int64_t>(10 * (n - 1)));
  EXPECT_EQ(reader.observable("volume"), volumes);
  EXPECT_EQ(reader.timing("output").back(), double(n - 1));
  EXPECT_EQ(reader.timing("cut"), std::vector<double>(n, 0));
  EXPECT_EQ(reader.attribute("/observables/volume", "unit"), "m^3");
  EXPECT_EQ(reader.attribute("/observables/energy", "source"), "elastic and kinetic");
  EXPECT_EQ(reader.attribute("/timing/cut", "unit"), "s");
  const auto schema = reader.schema();
  EXPECT_EQ(schema.stages, sample_schema().stages);
  ASSERT_EQ(schema.observables.size(), 2u);
  EXPECT_EQ(schema.observables[0].name, "volume");
  EXPECT_TRUE(reader.bodies().empty());
}

TEST(RunFile, KeepsBodiesThroughAChangeOfTopology) {
  const TemporaryFolder folder;
  const auto path = folder / "run.h5";
  const auto first = sample_complex(3, 0), second = sample_complex(5, 1);
  const auto surface = sample_surface();
  const auto x = sample_points(24, 1), v = sample_points(24, 2), y = sample_points(40, 3);
  const std::vector<Field> fields = {{"plastic", "1", 2, std::vector<double>(80, 0.25)}};
  {
    RunFile file(path, sample_info(), sample_schema());
    file.append({0, 0, {}, two_values, {{"liver", x, v, {}, &first, &surface}, {"cube", x, {}, {}, &first, nullptr}}});
    file.append({1, 1, {}, two_values, {{"liver", v, x, {}, nullptr, nullptr}}});
    file.append({2, 2, {}, two_values, {}});
    file.append({3, 3, {}, two_values, {{"liver", y, {}, fields, &second, nullptr}}});
  }
  const Reader reader(path);
  EXPECT_EQ(reader.bodies(), (std::vector<std::string>{"cube", "liver"}));
  ASSERT_EQ(reader.n_frames("liver"), 3u);
  EXPECT_EQ(reader.n_frames("cube"), 1u);
  EXPECT_EQ(reader.n_complexes("liver"), 2u);
  EXPECT_EQ(reader.n_surfaces("liver"), 1u);
  EXPECT_EQ(reader.n_surfaces("cube"), 0u);

  EXPECT_EQ(reader.frame("liver", 0).positions, x);
  EXPECT_EQ(reader.frame("liver", 1).velocities, x);
  EXPECT_EQ(reader.frame("liver", 1).complex, 0u);
  const auto last = reader.frame("liver", 2);
  EXPECT_EQ(last.time, 3);
  EXPECT_EQ(last.step, 3);
  EXPECT_EQ(last.complex, 1u);
  EXPECT_EQ(last.positions, y);
  EXPECT_TRUE(last.velocities.empty());
  ASSERT_EQ(last.fields.size(), 1u);
  EXPECT_EQ(last.fields[0].name, "plastic");
  EXPECT_EQ(last.fields[0].n_components, 2u);
  EXPECT_EQ(last.fields[0].values, fields[0].values);

  const auto complex = reader.complex("liver", 1);
  EXPECT_EQ(complex.corners, second.corners);
  EXPECT_EQ(complex.cells, second.cells);
  EXPECT_EQ(complex.nodes, second.nodes);
  EXPECT_EQ(complex.skin, second.skin);
  EXPECT_EQ(complex.rest_positions, second.rest_positions);
  const auto back = reader.surface("liver", 0);
  EXPECT_EQ(back.triangles, surface.triangles);
  EXPECT_EQ(back.labels, surface.labels);
  EXPECT_EQ(back.rest_positions, surface.rest_positions);
  EXPECT_EQ(back.weights.start, surface.weights.start);
  EXPECT_EQ(back.weights.columns, surface.weights.columns);
  EXPECT_EQ(back.weights.values, surface.weights.values);

  EXPECT_EQ(reader.attribute("/bodies/liver/frames/000002/position", "configuration"), "current");
  EXPECT_EQ(reader.attribute("/bodies/liver/frames/000002/complex/rest_position", "configuration"), "rest");
  EXPECT_EQ(reader.attribute("/bodies/liver/frames/000000/velocity", "unit"), "m/s");
}

TEST(RunFile, SaysHowTheRunEnded) {
  const TemporaryFolder folder;
  RunFile file(folder / "a.h5", sample_info(), sample_schema());
  EXPECT_EQ(Reader(folder / "a.h5").outcome(), Outcome::running);
  file.complete();
  EXPECT_EQ(Reader(folder / "a.h5").outcome(), Outcome::completed);
  EXPECT_FALSE(Reader(folder / "a.h5").failure().has_value());

  RunFile failing(folder / "b.h5", sample_info(), sample_schema());
  failing.fail({"liver: an element turned inside out", 17, 0.25});
  const Reader reader(folder / "b.h5");
  EXPECT_EQ(reader.outcome(), Outcome::failed);
  const auto failure = reader.failure();
  ASSERT_TRUE(failure.has_value());
  EXPECT_EQ(failure->text, "liver: an element turned inside out");
  EXPECT_EQ(failure->step, 17);
  EXPECT_EQ(failure->time, 0.25);
}

TEST(RunFile, RefusesWhatDoesNotFitAndTakesTheNext) {
  const TemporaryFolder folder;
  RunFile file(folder / "run.h5", sample_info(), sample_schema());
  const auto complex = sample_complex(2, 0);
  const auto x = sample_points(16, 0), shorter = sample_points(15, 0);
  const std::vector<Field> field = {{"heat", "K", 2, std::vector<double>(31)}};
  auto surface = sample_surface();
  surface.weights.values.pop_back();
  const std::vector<double> one_value = {1};

  EXPECT_NE(complaint([&] { file.append({0, 0, {}, one_value, {}}); }), "");
  EXPECT_NE(complaint([&] {
              file.append({0, 0, {{"cutting", 1}}, two_values, {}});
            }).find("cutting"),
            std::string::npos);
  EXPECT_NE(complaint([&] {
              file.append(step_with({"a/b", x, {}, {}, &complex, nullptr}));
            }).find("slash"),
            std::string::npos);
  EXPECT_NE(complaint([&] {
              file.append(step_with({"a", x, {}, {}, nullptr, nullptr}));
            }).find("first frame"),
            std::string::npos);
  EXPECT_NE(complaint([&] { file.append(step_with({"a", shorter, {}, {}, &complex, nullptr})); }), "");
  EXPECT_NE(complaint([&] { file.append(step_with({"a", x, shorter, {}, &complex, nullptr})); }), "");
  EXPECT_NE(complaint([&] {
              file.append(step_with({"a", x, {}, field, &complex, nullptr}));
            }).find("heat"),
            std::string::npos);
  EXPECT_NE(complaint([&] { file.append(step_with({"a", x, {}, {}, &complex, &surface})); }), "");
  EXPECT_EQ(Reader(folder / "run.h5").n_steps(), 0u);

  file.append(step_with({"a", x, x, {}, &complex, nullptr}));
  EXPECT_EQ(Reader(folder / "run.h5").n_frames("a"), 1u);
}

TEST(RunFile, RefusesASecondWriter) {
  const TemporaryFolder folder;
  const RunFile file(folder / "run.h5", sample_info(), sample_schema());
  EXPECT_NE(complaint([&] { RunFile(folder / "run.h5"); }).find("run.h5"), std::string::npos);
}

TEST(Reader, SaysWhatIsNotThere) {
  const TemporaryFolder folder;
  const auto path = folder / "run.h5";
  { RunFile(path, sample_info(), sample_schema()); }
  const Reader reader(path);
  for (const auto& text :
       {complaint([&] { reader.observable("mass"); }), complaint([&] { reader.timing("mass"); }),
        complaint([&] { reader.n_frames("mass"); }), complaint([&] { reader.frame("mass", 0); }),
        complaint([&] { reader.attribute("/mass", "unit"); }), complaint([&] { reader.attribute("/", "mass"); })}) {
    EXPECT_NE(text.find(path.string()), std::string::npos) << text;
    EXPECT_NE(text.find("mass"), std::string::npos) << text;
  }
}

TEST(Reader, RefusesWhatIsNoRunsFile) {
  const TemporaryFolder folder;
  std::ofstream(folder / "text.h5") << "this is not HDF5";
  EXPECT_NE(complaint([&] { Reader(folder / "missing.h5"); }).find("missing.h5"), std::string::npos);
  EXPECT_NE(complaint([&] { Reader(folder / "text.h5"); }).find("text.h5"), std::string::npos);

  const auto path = folder / "cut.h5";
  { RunFile(path, sample_info(), sample_schema()).write_scene(std::string(10000, 's')); }
  std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
  const auto text = complaint([&] { Reader{path}; });
  EXPECT_NE(text.find("truncated"), std::string::npos) << text;
}

} // namespace
} // namespace kerf::output::run_file_test
