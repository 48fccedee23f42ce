// `kerf texture`: the inside of a scene's body on any plane, as a picture, without a simulation.

#include "commands.h"
#include "scene_arguments.h"

#include "base/error.h"
#include "base/parallel.h"
#include "base/parameters.h"
#include "image/file.h"
#include "scene/compose_interior.h"
#include "scene/progress.h"

#include <Eigen/Geometry>

#include <chrono>
#include <cstdio>

namespace kerf::apps {

namespace {

/// What is asked for beside the scene.
struct Options {
  Points plane = {}; ///< a point [m], a normal, and perhaps where columns run to
  double pixel = 0;  ///< [m]; 0: that of the exemplars
  std::string output = "texture.png";
  std::string body = {}; ///< empty: the first one with an inside
  int n_threads = 0;
  void describe(Parameters& p) {
    p.points("--plane", plane, "A point [m] and a normal; if there is a third one, columns run along it.");
    p.number("--pixel", pixel, positive, "Side of a pixel [m].");
    p.text("--output", output, "PNG or JPEG.");
    p.text("--body", body, "Name of a body that has an interior; without, the first one.");
    p.integer("--threads", n_threads, {1, 1024}, "Threads.");
  }
};

/// Takes our options out of the arguments; what is left are a scene and --set.
Options take_options(Arguments& arguments) {
  Options options;
  Parameters parameters;
  options.describe(parameters);
  for (const Parameter& p : parameters.list())
    for (std::size_t i = 0; i < arguments.size(); ++i)
      if (arguments[i] == p.name) {
        if (i + 1 == arguments.size())
          throw ParameterError(Complaint{.value = p.name, .rule = "needs a value", .remedy = p.text});
        if (const std::string wrong = p.assign(arguments[i + 1]); !wrong.empty())
          throw ParameterError(Complaint{.path = p.name, .value = arguments[i + 1], .rule = wrong, .remedy = p.text});
        arguments.erase(arguments.begin() + static_cast<int>(i), arguments.begin() + static_cast<int>(i) + 2);
        break;
      }
  return options;
}

texture::Frame frame_of(const Options& options) {
  const auto refuse = [](const std::string& rule) {
    throw ParameterError(Complaint{
      .path = "--plane", .rule = rule, .remedy = "Write --plane \"x, y, z; normal x, y, z\", in metres, rest frame"});
  };
  if (options.plane.size() != 2 && options.plane.size() != 3)
    refuse("must be a point and a normal, and perhaps a direction of columns");
  const Vec3& normal = options.plane[1];
  if (!(normal.norm() > 0))
    refuse("the normal must have a length");
  const Vec3 n = normal.normalized();
  const Vec3 wanted =
    options.plane.size() == 3 ? options.plane[2] : Vec3(std::abs(n[0]) < 0.9 ? Vec3::UnitX() : Vec3::UnitY());
  const Vec3 x = wanted - n.dot(wanted) * n;
  if (!(x.norm() > 1e-6 * wanted.norm()))
    refuse("columns must not run along the normal");
  return {options.plane[0], x.normalized(), n.cross(x.normalized())};
}

} // namespace

int texture(const Arguments& arguments) {
  Arguments rest = arguments;
  const Options options = take_options(rest);
  const texture::Frame frame = frame_of(options);
  const SceneArguments parsed = parse_scene_arguments(rest);
  if (options.n_threads > 0)
    set_n_threads(options.n_threads);
  const scene::LookedInto body = [&] {
    const scene::LongWork preparing("Matching the exemplars", stdout);
    return scene::compose_inside(read_text(parsed), options.body);
  }();
  for (const std::string& line : body.composition)
    std::printf("%s\n", line.c_str());
  const texture::Interior& inside = body.interior->inside;
  const texture::Patch patch =
    texture::patch_over(body.mesh, frame, options.pixel > 0 ? options.pixel : inside.pixel());
  if (patch.width == 0)
    throw ParameterError(Complaint{
      .path = "--plane", .rule = "misses the body", .remedy = "Move it into the body, rest frame, in metres"});
  const auto start = std::chrono::steady_clock::now();
  const image::Image picture =
    texture::picture_of(inside, body.mesh, patch, body.interior->detail.get(), inside.options().blending);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  image::write_image(picture, options.output);
  std::printf("%d x %d points of %g m in %.3f s, in %s\n", patch.width, patch.height, patch.column.norm(),
              seconds.count(), options.output.c_str());
  return 0;
}

} // namespace kerf::apps
