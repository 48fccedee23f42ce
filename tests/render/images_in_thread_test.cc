#include "base/work_thread.h"
#include "render/image.h"
#include "render/renderer.h"
#include "tests/output/samples.h"
#include "tests/render/shapes.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

namespace kerf::render::images_in_thread_test {
namespace {

const std::vector<DrawnBlade> no_blades;

Batch sphere_at(const Renderer& renderer, const double y) {
  auto mesh = shapes::sphere(0.5, 3);
  for (Vec3& p : mesh.positions)
    p.y() += y;
  const std::vector surfaces = {mesh.drawn()};
  return renderer.prepare({surfaces, no_blades, {}});
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(Renderer, DrawsTheSameInAThreadOfItsOwn) {
  const output::TemporaryFolder folder;
  const Renderer renderer({.eye = {4, 0, 0}, .width = 80, .height = 60}, {});
  const auto path = [&](const std::string& name, const int i) {
    return (folder / (name + std::to_string(i) + ".png")).string();
  };
  constexpr int n = 8;
  WorkThread thread;
  for (int i = 0; i < n; ++i)
    thread.give([&renderer, batch = sphere_at(renderer, 0.2 * i - 0.8), file = path("beside", i)] {
      write_png(renderer.draw_batch(batch), file);
    });
  thread.wait();
  for (int i = 0; i < n; ++i) {
    write_png(renderer.draw_batch(sphere_at(renderer, 0.2 * i - 0.8)), path("alone", i));
    EXPECT_EQ(bytes_of(path("beside", i)), bytes_of(path("alone", i))) << i;
  }
}

} // namespace
} // namespace kerf::render::images_in_thread_test
