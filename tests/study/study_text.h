#pragma once

/// Studies that tests write themselves, on the cube that other tests run.

#include "study/study.h"
#include "tests/output/samples.h"
#include "tests/scene/scene_text.h"

#include <fstream>

namespace kerf::study {

/// A folder with scene.prm, a cube of 8 kg that falls freely for 0.05 s, and studies of it.
class CubeStudy {
 public:
  CubeStudy() {
    std::ofstream(folder_ / "scene.prm") << scene::cube_scene()
                                         << "subsection Gravity\n"
                                            "end\n"
                                            "subsection Observables\n"
                                            "  set Names = momentum z, largest displacement, kinetic energy\n"
                                            "end\n";
  }

  /// The section Study, with the momentum of free fall as answer and -m g t as reference.
  static std::string head(const std::string& more = "") {
    return "subsection Study\n"
           "  set Title            = Free fall\n"
           "  set Scene            = scene.prm\n"
           "  set Answer           = momentum z\n"
           "  set Unit             = kg m/s\n"
           "  set Reference        = -3.924\n"
           "  set Reference source = -m g t\n" +
           more + "end\n";
  }
  static std::string variant(const std::string& name, const std::string& set) {
    return "subsection Variant " + name + "\n  set Set = " + set + "\nend\n";
  }

  Plan plan(const std::string& text) const {
    return make_plan(scene::scan_scene_text(text, (folder_ / "study.prm").string()));
  }
  output::StudyTable run(const std::string& text) const {
    return run_study(plan(text), folder_ / "out", output::sample_info(), output::Earlier::replace,
                     [](const output::StudyRow&) {});
  }
  std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }

 private:
  output::TemporaryFolder folder_;
};

} // namespace kerf::study
