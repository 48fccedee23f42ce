// Insides that cannot be: the exit code, and one line that says where, what, which rule and what to do.

#include "image/file.h"
#include "tests/apps/program.h"

namespace kerf::apps::refused_interior_test {
namespace {

class RefusedInterior : public Program {
 protected:
  void SetUp() override {
    image::write_image(image::Colours(32, 32, image::Rgb(0.8f, 0.4f, 0.2f)), (folder / "good.png").string());
  }

  static std::string exemplar(const std::string& name, const std::string& picture, const std::string& origin,
                              const std::string& column = "0.0065, 0, 0", const std::string& row = "0, 0.0065, 0",
                              const std::string& more = "") {
    return "    subsection Exemplar " + name + "\n      set Image = " + picture + "\n      set Origin [m] = " + origin +
           "\n      set Column [m] = " + column + "\n      set Row [m] = " + row + "\n" + more + "    end\n";
  }

  static std::string scene(const std::string& inside) {
    std::string scene = cube_scene();
    const std::string end = "end\n";
    return scene.replace(scene.rfind(end), end.size(),
                         "  subsection Interior\n    set Resolution [m] = 0.01\n" + inside + "  end\n" + end);
  }

  void expect_bad_file(const std::string& picture, const Words& parts) const {
    expect_error(run(scene(exemplar("one", picture, "-0.1, -0.1, 0.01"))), 2, parts);
  }
};

using AcceptedInterior = RefusedInterior;

TEST_F(RefusedInterior, PicturesThatAreNone) {
  expect_bad_file("nothing.png", {"scene.prm:", "Interior/Exemplar one/Image", "nothing.png", "there is no such file"});
  write("text.png", "no picture at all, although its name says so");
  expect_bad_file("text.png", {"scene.prm:", "Exemplar one/Image", "neither a PNG nor a JPEG", "Convert"});
}

TEST_F(RefusedInterior, PicturesThatShowNothing) {
  image::write_image(image::Colours(1, 1, image::Rgb::Ones()), (folder / "dot.png").string());
  expect_refused(scene(exemplar("one", "dot.png", "-0.1, -0.1, 0.01")),
                 {"scene.prm:", "Exemplar one/Image", "at least 8 x 8 pixels"});
  image::Image empty{image::Colours(32, 32, image::Rgb::Ones()), image::Grey(32, 32, 0)};
  image::write_image(empty, (folder / "empty.png").string());
  expect_refused(scene(exemplar("one", "empty.png", "-0.1, -0.1, 0.01")),
                 {"scene.prm:", "Exemplar one/Image", "its mask is empty"});
}

TEST_F(RefusedInterior, PlanesThatDoNotFit) {
  expect_refused(scene(exemplar("one", "good.png", "-0.1, -0.1, 5")),
                 {"scene.prm:", "Exemplar one/Origin [m]", "misses the body"});
  expect_refused(scene(exemplar("one", "good.png", "-0.1, -0.1, 0", "0, 0, 0")),
                 {"scene.prm:", "Exemplar one/Column [m]", "must have a length"});
  expect_refused(scene(exemplar("one", "good.png", "-0.1, -0.1, 0", "0.01, 0, 0", "0.02, 0, 0")),
                 {"scene.prm:", "Exemplar one/Row [m]", "parallel"});
  expect_refused(
    scene(exemplar("one", "good.png", "-0.1, -0.1, 0.01") + exemplar("two", "good.png", "-0.1, -0.1, 0.01")),
    {"scene.prm:", "Exemplar two/Origin [m]", "lies in the plane of exemplar one"});
  expect_refused(
    scene(exemplar("one", "good.png", "-0.1, -0.1, 0.01", "0.0065, 0, 0", "0, 0.0065, 0", "      set Sweep = axis\n")),
    {"scene.prm:", "Exemplar one/Axis [1]", "some length"});
  expect_refused(scene(""), {"scene.prm:", "Body cube/Interior", "at least one exemplar"});
}

TEST_F(RefusedInterior, TheTextureCommand) {
  write("scene.prm", scene(exemplar("one", "good.png", "-0.1, -0.1, 0.01")));
  write("plain.prm", cube_scene());
  expect_error(kerf({"texture", "scene.prm"}), 1, {"--plane", "a point and a normal"});
  expect_error(kerf({"texture", "scene.prm", "--plane", "0, 0, 0; 0, 0, 0"}), 1, {"--plane", "must have a length"});
  expect_error(kerf({"texture", "scene.prm", "--plane", "0, 0, 9; 0, 0, 1"}), 1, {"--plane", "misses the body"});
  expect_error(kerf({"texture", "scene.prm", "--plane", "0, 0, 0; 0, 0, 1", "--body", "sphere"}), 1,
               {"no body 'sphere'", "Interior"});
  expect_error(kerf({"texture", "plain.prm", "--plane", "0, 0, 0; 0, 0, 1"}), 1, {"no body", "Interior"});
  expect_error(kerf({"texture", "scene.prm", "--plane", "0, 0, 0; 0, 0, 1", "--output", "x.bmp"}), 2,
               {"x.bmp", ".png"});
  const Result painted = kerf({"texture", "scene.prm", "--plane", "0, 0, 0.02; 0, 0.2, 1", "--output", "x.png"});
  EXPECT_EQ(painted.exit_code, 0) << painted.err;
  const image::Image picture = image::read_image((folder / "x.png").string());
  EXPECT_GT(picture.width(), 20);
  EXPECT_NEAR(picture.colours(picture.width() / 2, picture.height() / 2)[0], 0.8, 0.01);
}

/// A picture that is red on its left half: where columns run, and how fine they are.
TEST_F(AcceptedInterior, PixelsAndColumnsOfTheTextureCommand) {
  image::Colours halves(32, 32, image::Rgb(0, 0, 1));
  for (int r = 0; r < 32; ++r)
    for (int c = 0; c < 16; ++c)
      halves(c, r) = image::Rgb(1, 0, 0);
  image::write_image(halves, (folder / "halves.png").string());
  write("scene.prm", scene(exemplar("one", "halves.png", "-0.1, -0.1, 0.01")));
  const auto painted = [&](const std::string& plane, const std::string& pixel) {
    const Result result =
      kerf({"texture", "scene.prm", "--plane", plane, "--pixel", pixel, "--output", "x.png", "--threads", "1"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return image::read_image((folder / "x.png").string());
  };
  const image::Image along_x = painted("0, 0, 0.01; 0, 0, 1; 1, 0, 0", "0.002");
  const image::Image along_y = painted("0, 0, 0.01; 0, 0, 1; 0, 1, 0", "0.002");
  const image::Image finer = painted("0, 0, 0.01; 0, 0, 1; 1, 0, 0", "0.001");
  EXPECT_NEAR(along_x.width(), 101, 1); // of a cube of 0.2 m
  EXPECT_NEAR(finer.width(), 201, 1);
  EXPECT_GT(along_x.colours(10, 50)[0], 0.99f); // columns along x: red on the left
  EXPECT_GT(along_x.colours(90, 50)[2], 0.99f);
  EXPECT_EQ(along_y.colours(10, 50)[0], along_y.colours(90, 50)[0]); // columns along y: rows run along -x
  EXPECT_GT(along_y.colours(50, 90)[0], 0.99f);
  EXPECT_GT(along_y.colours(50, 10)[2], 0.99f);
  expect_error(kerf({"texture", "scene.prm", "--plane", "0, 0, 0; 0, 0, 1; 0, 0, 2"}), 1,
               {"--plane", "must not run along the normal"});
  expect_error(kerf({"texture", "scene.prm", "--plane", "0, 0, 0; 0, 0, 1", "--pixel", "0"}), 1, {"--pixel", "> 0"});
  for (const std::string tiny : {"1e-6", "1e-12", "1e-300"})
    expect_error(kerf({"texture", "scene.prm", "--plane", "0, 0, 0; 0, 0, 1", "--pixel", tiny}), 1,
                 {"--pixel", "16384 pixels", "larger"});
}

} // namespace
} // namespace kerf::apps::refused_interior_test
