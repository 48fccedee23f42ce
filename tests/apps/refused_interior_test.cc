// Insides that cannot be: the exit code, and one line that says where, what, which rule and what to do.

#include "image/file.h"
#include "tests/apps/program.h"

namespace kerf::apps {
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

TEST_F(RefusedInterior, PinsThatDoNotFit) {
  const std::string two = exemplar("one", "good.png", "-0.1, -0.1, 0.01") +
                          exemplar("two", "good.png", "0.01, -0.1, -0.1", "0, 0.0065, 0", "0, 0, 0.0065");
  const auto pin = [](const std::string& to, const std::string& from) {
    return "    subsection Pin nose\n      set From exemplar = one\n      set To exemplar = " + to +
           "\n      set From [m] = " + from + "\n      set To [m] = 0.01, 0.02, 0.05\n    end\n";
  };
  expect_refused(scene(two + pin("two", "0.9, 0, 0.01")), {"scene.prm:", "Pin nose/From [m]", "outside"});
  expect_refused(scene(two + pin("three", "0.05, 0, 0.01")),
                 {"scene.prm:", "Pin nose/To exemplar", "names no exemplar"});
}

TEST_F(RefusedInterior, TheTextureCommand) {
  write("scene.prm", scene(exemplar("one", "good.png", "-0.1, -0.1, 0.01")));
  write("plain.prm", cube_scene());
  expect_error(kerf({"texture", "scene.prm"}), 1, {"--plane", "a point and a normal"});
  expect_error(kerf({"texture", "scene.prm", "--plane", "0, 0, 0; 0, 0, 0"}), 1, {"--plane", "must have a length"});
  expect_error(kerf({"texture", "scene.prm", "--plane", "0, 0, 9; 0, 0, 1"}), 1, {"--plane", "misses the body"});
  expect_error(kerf({"texture", "plain.prm", "--plane", "0, 0, 0; 0, 0, 1"}), 1, {"no body", "Interior"});
  expect_error(kerf({"texture", "scene.prm", "--plane", "0, 0, 0; 0, 0, 1", "--output", "x.bmp"}), 2,
               {"x.bmp", ".png"});
  const Result painted = kerf({"texture", "scene.prm", "--plane", "0, 0, 0.02; 0, 0.2, 1", "--output", "x.png"});
  EXPECT_EQ(painted.exit_code, 0) << painted.err;
  const image::Image picture = image::read_image((folder / "x.png").string());
  EXPECT_GT(picture.width(), 20);
  EXPECT_NEAR(picture.colours(picture.width() / 2, picture.height() / 2)[0], 0.8, 0.01);
}

} // namespace
} // namespace kerf::apps
