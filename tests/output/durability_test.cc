// What is left of a run's files when its process is killed, or its disk is full.

#include "base/error.h"
#include "output/reader.h"
#include "output/run_file.h"
#include "output/surface_file.h"
#include "tests/output/child.h"
#include "tests/output/samples.h"
#include "tests/output/surface_steps.h"

#include <gtest/gtest.h>

#include <sys/resource.h>
#include <fstream>
#include <random>

namespace kerf::output::durability_test {
namespace {

constexpr std::size_t n_copies = 60, n_kills = 20;

/// Output step i; every fifth one has a new complex.
void append_sample(RunFile& file, const std::size_t i) {
  const auto complex = sample_complex(n_copies, i / 5);
  const auto positions = sample_points(8 * n_copies, i), velocities = sample_points(8 * n_copies, i + 1);
  const std::vector<double> observables = {double(i), -double(i)};
  BodyStep body{"liver", positions, velocities, {}, i % 5 == 0 ? &complex : nullptr, nullptr};
  file.append({0.1 * double(i), static_cast<std::int64_t>(i), {{"cut", 0.5}}, observables, {body}});
}

/// Every output step of the file is there, whole.
void expect_whole(const Reader& reader, const std::size_t n_steps) {
  ASSERT_EQ(reader.n_steps(), n_steps);
  ASSERT_EQ(reader.steps().size(), n_steps);
  ASSERT_EQ(reader.timing("cut"), std::vector<double>(n_steps, 0.5));
  if (n_steps == 0)
    return;
  ASSERT_EQ(reader.n_frames("liver"), n_steps);
  const auto volume = reader.observable("volume"), energy = reader.observable("energy");
  for (std::size_t i = 0; i < n_steps; ++i) {
    const auto frame = reader.frame("liver", i);
    ASSERT_EQ(frame.step, static_cast<std::int64_t>(i));
    ASSERT_EQ(frame.positions, sample_points(8 * n_copies, i));
    ASSERT_EQ(frame.velocities, sample_points(8 * n_copies, i + 1));
    ASSERT_EQ(frame.complex, i / 5);
    ASSERT_EQ(reader.complex("liver", frame.complex).cells, sample_complex(n_copies, i / 5).cells);
    ASSERT_EQ(volume.at(i), double(i));
    ASSERT_EQ(energy.at(i), -double(i));
  }
}

TEST(Durability, ARunsFileSurvivesKills) {
  const TemporaryFolder folder;
  std::mt19937 random(2);
  for (std::size_t run = 0; run < n_kills; ++run) {
    const auto path = folder / ("run" + std::to_string(run) + ".h5");
    Child child([&](Report& report) {
      RunFile file(path, sample_info(), sample_schema());
      for (std::uint32_t i = 0;; ++i) {
        append_sample(file, i);
        report.send(i + 1);
      }
    });
    ASSERT_EQ(child.receive(), 1u);
    child.kill_after(std::chrono::microseconds(random() % 20000));
    const auto n_reported = std::max(1u, child.last());

    const Reader reader(path);
    EXPECT_EQ(reader.outcome(), Outcome::running);
    ASSERT_GE(reader.n_steps(), n_reported);
    ASSERT_LE(reader.n_steps(), n_reported + 1); // appended, and killed before it could say so
    expect_whole(reader, reader.n_steps());
  }
}

TEST(Durability, AKilledRunGoesOn) {
  const TemporaryFolder folder;
  const auto path = folder / "run.h5";
  Child child([&](Report& report) {
    RunFile file(path, sample_info(), sample_schema());
    for (std::uint32_t i = 0;; ++i) {
      append_sample(file, i);
      report.send(i + 1);
    }
  });
  ASSERT_EQ(child.receive(), 1u);
  child.kill_after(std::chrono::milliseconds(20));
  const auto n_before = Reader(path).n_steps();
  {
    RunFile file(path);
    for (auto i = n_before; i < n_before + 7; ++i)
      append_sample(file, i);
    file.complete();
  }
  const Reader reader(path);
  EXPECT_EQ(reader.outcome(), Outcome::completed);
  expect_whole(reader, n_before + 7);
}

TEST(Durability, ASurfaceSurvivesKills) {
  const TemporaryFolder folder;
  std::mt19937 random(3);
  for (std::size_t run = 0; run < n_kills; ++run) {
    const auto path = folder / ("surface" + std::to_string(run) + ".vtkhdf");
    Child child([&](Report& report) {
      SurfaceFile file(path);
      for (std::uint32_t i = 0;; ++i) {
        append_surface(file, i);
        report.send(i + 1);
      }
    });
    ASSERT_EQ(child.receive(), 1u);
    child.kill_after(std::chrono::microseconds(random() % 20000));
    const auto n_reported = std::max(1u, child.last());

    const SurfaceReader reader(path);
    ASSERT_GE(reader.n_steps(), n_reported);
    ASSERT_LE(reader.n_steps(), n_reported + 1);
    for (std::size_t i = 0; i < reader.n_steps(); ++i)
      ASSERT_TRUE(reader.holds(surface_at(i), i)) << "step " << i;
  }
}

/// The largest size of a file that this process and its children may write; the signal becomes an error.
void limit_file_size(const std::size_t bytes) {
  const rlimit limit = {bytes, bytes};
  setrlimit(RLIMIT_FSIZE, &limit);
  std::signal(SIGXFSZ, SIG_IGN);
}

/// Appends until the disk is full, which must show as a DataError that says what to do, and show again.
template <class Append>
void fill_disk(const std::size_t n_bytes, const Report& report, const Append& append) {
  limit_file_size(n_bytes);
  for (std::uint32_t i = 0; i < 100000; ++i) {
    try {
      append(i);
      report.send(i + 1);
    } catch (const DataError& error) {
      const std::string text = error.what();
      for (const auto* part : {"full.", "bytes more", "bytes are free", "Free disk space"})
        if (text.find(part) == std::string::npos)
          throw;
      try {
        append(i);
      } catch (const DataError&) {
        return;
      }
      throw std::runtime_error("a full disk took more");
    }
  }
  throw std::runtime_error("the disk never got full");
}

TEST(Durability, AFullDiskKeepsTheRunsFile) {
  const TemporaryFolder folder;
  const auto path = folder / "full.h5";
  Child child([&](Report& report) {
    RunFile file(path, sample_info(), sample_schema());
    fill_disk(400000, report, [&](const std::size_t i) { append_sample(file, i); });
  });
  ASSERT_EQ(child.exit_code(), 0);
  const auto n_steps = child.last();
  ASSERT_GT(n_steps, 5u);
  expect_whole(Reader(path), n_steps);

  RunFile file(path); // with room again, it goes on
  append_sample(file, n_steps);
  expect_whole(Reader(path), n_steps + 1);
}

TEST(Durability, AFullDiskKeepsTheSurface) {
  const TemporaryFolder folder;
  const auto path = folder / "full.vtkhdf";
  Child child([&](Report& report) {
    SurfaceFile file(path);
    fill_disk(600000, report, [&](const std::size_t i) { append_surface(file, i); });
  });
  ASSERT_EQ(child.exit_code(), 0);
  const auto n_steps = child.last();
  ASSERT_GT(n_steps, 5u);
  const SurfaceReader reader(path);
  ASSERT_EQ(reader.n_steps(), n_steps);
  for (std::size_t i = 0; i < n_steps; ++i)
    ASSERT_TRUE(reader.holds(surface_at(i), i)) << "step " << i;
}

TEST(Durability, AnUnwritablePlaceIsNamed) {
  const TemporaryFolder folder;
  std::ofstream(folder / "file") << "not a folder";
  for (const auto& path : {folder / "missing" / "run.h5", folder / "file" / "run.h5", folder / ""}) {
    try {
      RunFile(path, sample_info(), sample_schema());
      FAIL() << path << " was written";
    } catch (const DataError& error) {
      const std::string text = error.what();
      EXPECT_NE(text.find(path.string()), std::string::npos) << text;
      EXPECT_NE(text.find("Name a file in a folder that exists"), std::string::npos) << text;
    }
    EXPECT_THROW(SurfaceFile{path}, DataError);
  }
}

} // namespace
} // namespace kerf::output::durability_test
