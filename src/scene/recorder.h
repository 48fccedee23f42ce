#pragma once

/// Writes what a run makes into its folder: run.h5, the surfaces for ParaView, the images.

#include "output/run_file.h"
#include "output/surface_file.h"
#include "scene/world.h"

#include <filesystem>

namespace kerf::scene {

/// Throws DataError when a run's folder can neither be written nor made, as far as can be told without making it: for
/// whoever would know before a scene is composed.
void require_writable(const std::filesystem::path& folder);

class Recorder {
 public:
  /// Makes the folder and the files that the world asks for. Throws DataError when it cannot.
  Recorder(const std::filesystem::path& folder, const World& world, const output::RunInfo& info,
           const std::string& scene_text);

  /// Records step `step` of the world, with the seconds of its stages. What recording itself takes (images, output)
  /// stands in `seconds` afterwards, in place of those stages, and so counts with the next step. The last step is
  /// always recorded in full.
  void record(const World& world, int step, Timings& seconds);

  void complete() { run_file_.complete(); }
  void fail(const std::string& text, int step, double time) { run_file_.fail({text, step, time}); }

 private:
  struct BodyFiles {
    int complex_written = -1, surface_written = -1; ///< Body::n_recuts of what the files hold last
    std::size_t n_samples_written = 0;              ///< of the atlas of what is inside
    std::optional<output::SurfaceFile> surface_file;
    std::vector<output::Field> fields; ///< of the corners, at the step that is recorded
  };

  void append_step(const World& world, int step, const Timings& seconds, bool with_frames);
  void append_surfaces(const World& world, int step);
  void write_image(const World& world, int step);

  std::filesystem::path folder_;
  output::RunFile run_file_;
  std::vector<BodyFiles> bodies_;
};

/// The stages that a run's seconds are divided into.
const std::vector<std::string>& stages();

} // namespace kerf::scene
