// Damaged files of results in this very process, so that the sanitizers see it: each is read, or refused with an error
// that says which file.

#include "base/archive.h"
#include "base/error.h"
#include "output/checkpoint_file.h"
#include "output/checksum.h"
#include "output/reader.h"
#include "output/run_file.h"
#include "tests/output/samples.h"
#include "tests/support/vandal.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

namespace kerf::output::mutations_test {
namespace {

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void write_sample(const std::filesystem::path& path) {
  RunFile file(path, sample_info(), sample_schema());
  for (std::size_t i = 0; i < 3; ++i) {
    const auto complex = sample_complex(20, i);
    const auto positions = sample_points(160, i);
    const std::vector<double> observables = {1, 2};
    const BodyStep body{"liver", positions, positions, {}, &complex, nullptr};
    file.append({0.1 * double(i), static_cast<std::int64_t>(i), {{"cut", 0.5}}, observables, {body}});
  }
}

void read_all(const Reader& reader) {
  reader.info();
  reader.outcome();
  reader.failure();
  if (reader.has_scene()) {
    reader.scene();
    reader.inputs();
    reader.composition();
  }
  reader.times();
  reader.steps();
  for (const Observable& o : reader.schema().observables)
    reader.observable(o.name);
  for (const std::string& body : reader.bodies()) {
    for (std::size_t i = 0; i < reader.n_frames(body); ++i)
      reader.frame(body, i);
    for (std::size_t i = 0; i < reader.n_complexes(body); ++i)
      reader.complex(body, i);
  }
}

TEST(DamagedResults, AreReadOrRefused) {
  const TemporaryFolder folder;
  const auto path = folder / "run.h5";
  write_sample(path);
  ASSERT_NO_THROW(read_all(Reader(path)));
  const std::string whole = bytes_of(path);
  ASSERT_GT(whole.size(), 1000u);
  std::size_t n_read = 0, n_refused = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::ofstream(path, std::ios::binary) << support::Vandal(seed).damaged(whole);
    try {
      read_all(Reader(path));
      ++n_read;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("run.h5"), std::string::npos) << seed << ": " << error.what();
      ++n_refused;
    }
  }
  EXPECT_GT(n_read, 0u);
  EXPECT_GT(n_refused, 100u);
}

struct Nested {
  std::vector<double> numbers = {1, 2, 3};
  std::vector<std::vector<std::int32_t>> lists = {{1}, {2, 3}, {}};
  std::map<std::string, Points> points = {{"velocity", Points(5, Vec3::Ones())}};
  std::string text = "some words";

  void archive(Archive& a) {
    a.name("nested");
    a(numbers, lists, points, text);
  }
};

/// Bytes that a checksum does not protect: whatever they promise, no more is taken than is there.
TEST(DamagedCheckpoints, AreReadOrRefused) {
  Archive writing;
  Nested nested;
  writing(nested);
  const std::string whole(reinterpret_cast<const char*>(writing.bytes().data()), writing.bytes().size());
  std::size_t n_refused = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    const std::string damaged = support::Vandal(seed).damaged(whole);
    const auto bytes = std::as_bytes(std::span(damaged));
    Archive reading({bytes.begin(), bytes.end()}, "a checkpoint");
    Nested other;
    try {
      reading(other);
    } catch (const DataError&) {
      ++n_refused;
    }
  }
  EXPECT_GT(n_refused, 100u);
}

} // namespace
} // namespace kerf::output::mutations_test
