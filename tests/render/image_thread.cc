#include "render/image_thread.h"

#include "base/error.h"
#include "tests/output/samples.h"
#include "tests/render/shapes.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

using namespace kerf;
using namespace kerf::render;

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

} // namespace

TEST(ImageThread, WritesWhatIsWrittenWithoutIt) {
  const output::TemporaryFolder folder;
  const Renderer renderer({.eye = {4, 0, 0}, .width = 80, .height = 60}, {});
  const auto path = [&](const std::string& name, const int i) {
    return (folder / (name + std::to_string(i) + ".png")).string();
  };
  constexpr int n = 8;
  {
    ImageThread thread(renderer);
    for (int i = 0; i < n; ++i)
      thread.write(sphere_at(renderer, 0.2 * i - 0.8), path("beside", i));
    thread.wait();
    EXPECT_TRUE(std::filesystem::exists(path("beside", n - 1)));
    thread.write(sphere_at(renderer, 0), path("last", 0));
  }
  EXPECT_TRUE(std::filesystem::exists(path("last", 0))); // nothing that was handed over is lost
  for (int i = 0; i < n; ++i) {
    write_png(renderer.draw_batch(sphere_at(renderer, 0.2 * i - 0.8)), path("alone", i));
    EXPECT_EQ(bytes_of(path("beside", i)), bytes_of(path("alone", i))) << i;
  }
}

TEST(ImageThread, TellsOnceThatAFileCannotBeWritten) {
  const output::TemporaryFolder folder;
  const Renderer renderer({.eye = {4, 0, 0}, .width = 8, .height = 6}, {});
  ImageThread thread(renderer);
  thread.write(sphere_at(renderer, 0), (folder / "no folder" / "image.png").string());
  EXPECT_THROW(thread.wait(), DataError);
  thread.write(sphere_at(renderer, 0), (folder / "image.png").string());
  EXPECT_NO_THROW(thread.wait());
  EXPECT_TRUE(std::filesystem::exists(folder / "image.png"));
}
