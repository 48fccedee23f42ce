#pragma once

/// Writes what a run makes into its folder: run.h5, the surfaces for ParaView, the images, checkpoints.
///
/// A resumed run starts from its last checkpoint, whose steps all files hold already; they may hold more. Until the run
/// comes to what they do not hold, it writes nothing into them, but compares: so what they hold is what an undisturbed
/// run would have written, bit by bit, or the run ends with an error.
///
/// Where there are two threads, files are written beside the steps: what a step's record needs is copied, at most two
/// records are kept, and checkpoints wait for them. What fails is told with one of the next records, at last with the
/// run's last one.

#include "base/archive.h"
#include "base/work_thread.h"
#include "output/results_folder.h"
#include "output/run_file.h"
#include "output/surface_file.h"
#include "scene/recorded_samples.h"
#include "scene/world.h"

#include <chrono>
#include <filesystem>
#include <functional>
#include <utility>

namespace kerf::scene {

/// What a run's file tells of where it comes from.
struct Source {
  output::RunInfo info;
  std::string scene;               ///< standalone_text()
  std::vector<std::string> inputs; ///< hashes_of_inputs()
};

/// Of a run, or of one of the processes that it took.
struct Cost {
  double cpu_seconds = 0; ///< of all threads [s]
  double peak_memory = 0; ///< [byte]
};

/// Where a run begins.
struct Start {
  int step = -1;                  ///< that of its checkpoint; -1 without one
  std::vector<std::string> lines; ///< what there is to say of it, where it was to be resumed
};

class Recorder {
 public:
  /// Makes the folder and the files that the world asks for, or opens those that are to be gone on with. Throws as
  /// output::ResultsFolder, and ParameterError where they are of another scene or other inputs.
  Recorder(const std::filesystem::path& folder, const World& world, const Source& source, output::Earlier earlier);

  /// How the cost of this process until now is measured; checkpoints carry it on. What recording costs itself does not
  /// count.
  void measure(std::function<Cost()> cost) { cost_ = std::move(cost); }
  /// Of all processes that the run has taken until now.
  Cost total_cost() const;

  /// Brings a world that has just been composed to its last checkpoint.
  Start resume(World& world);

  /// Records step `step` of the world, with the seconds of its stages. What recording itself takes (output, images:
  /// where they are made in threads of their own, how long they were waited for) stands in `seconds` afterwards, in
  /// place of those stages, and so counts with the next step. The last step is always recorded in full.
  void record(const World& world, int step, Timings& seconds);

  /// Writes a checkpoint after step `step`, which has been recorded, if one is due; its seconds count as output. By the
  /// clock, none is due before all of them together would take 1 % of the time.
  void keep(World& world, int step, Timings& seconds);
  /// Writes one in any case.
  void keep_now(World& world, int step);

  /// Then there is nothing to resume any more.
  void complete();
  void fail(const std::string& text, int step, double time);
  void interrupt(const std::string& text, int step, double time);

  /// The last step that the files held when they were opened; -1: none.
  int last_earlier_step() const { return static_cast<int>(ends_); }
  const std::filesystem::path& folder() const { return folder_.path(); }

 private:
  struct BodyFiles {
    int complex_written = -1, surface_written = -1; ///< Body::n_recuts of what the files hold last
    RecordedSamples samples;                        ///< of what is inside
    std::optional<output::SurfaceFile> surface_file;
    std::optional<double> surface_ends; ///< what the surface file held when it was opened [s]

    void archive(Archive& a) { a(complex_written, surface_written, samples); }
  };
  using Clock = std::chrono::steady_clock;

  Cost cost() const;
  void open_surface_files(const World& world);
  std::vector<std::string> warn_of_lost_images(const World& world, int step) const;
  void compare(int step, std::span<const double> values) const;
  void record_all(const World& world, int step, Timings& seconds);

  using Fields = std::vector<std::vector<output::Field>>; ///< of the corners, each body

  void append_step(const World& world, int step, const Timings& seconds, const Fields* fields);
  void append_surfaces(const World& world, int step, const Fields& fields);
  void write_image(const World& world, int step);
  /// Beside the steps, where there is a thread for it.
  static void write(const std::unique_ptr<WorkThread>& thread, std::function<void()> work);
  /// Until all that was recorded stands in its files, or has failed.
  void wait();

  output::ResultsFolder folder_;
  output::Earlier earlier_;
  bool goes_on_; ///< with files that are there
  bool has_noted_checkpoint_ = false;
  std::function<Cost()> cost_; ///< empty: nobody asks
  Cost earlier_cost_;          ///< up to the checkpoint that this process goes on from
  double recording_cpu_ = 0;   ///< of this process [s]
  output::RunFile run_file_;
  std::vector<BodyFiles> bodies_;
  std::string program_, inputs_;
  std::int64_t ends_ = -1;                    ///< the last step that run.h5 held when it was opened
  std::vector<std::vector<double>> recorded_; ///< the series that it held
  Clock::time_point next_checkpoint_;
  /// For images, and for run.h5 and the surface files, which one library writes; null: one thread does all. Last: they
  /// use the others.
  std::unique_ptr<WorkThread> image_thread_, file_thread_;
};

/// The file of checkpoints in a run's folder.
std::filesystem::path checkpoint_file(const std::filesystem::path& folder);

/// Whether a folder holds a run that has come to its end: nothing of it can be resumed.
bool is_complete(const std::filesystem::path& folder);
/// Throws ParameterError where the run that a folder holds is of another scene or other inputs.
void require_same(const std::filesystem::path& folder, const Source& source);

/// The stages that a run's seconds are divided into.
const std::vector<std::string>& stages();

} // namespace kerf::scene
