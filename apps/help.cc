#include "commands.h"

#include <map>

namespace kerf::apps {

namespace {

const char* const exit_codes = "exit codes: 1 the scene, 2 a file, 3 the computation; 128 + n: ended by signal n\n";

const char* const of_run = R"(usage: kerf run SCENE.prm... [options]
Runs a scene, or several, each into a folder of its own.

  --set "Section/Key=value"  changes a key of the scene; as often as wanted       none
  --output DIR               folder of the results         results/SCENE; of several scenes DIR/SCENE, in results
  --threads N                1 to 1024         as many as there are processors; of several scenes, shared by --jobs
  --jobs N                   so many of several scenes at a time                  1
  --force                    deletes what Kerf has made in the folder, and begins anew
  --resume                   goes on from the last checkpoint, to the bits of a run that nobody disturbed
Without --force or --resume a folder that holds results is refused.

Where --resume finds
  nothing, or no step yet    it begins, and says so
  steps, and no checkpoint had been written (killed within the first Output/Checkpoint interval [s]; or that is 0)
                             it begins anew, says so, and compares with what is recorded
  a checkpoint               it says from which step it goes on
  a checkpoint or surface file gone that was written     it refuses: bring it back, or --force
  a complete run             it leaves it as it is
)";

const char* const of_check = R"(usage: kerf check SCENE.prm [options]
Reads and composes a scene, says what it holds, and runs nothing.

  --set "Section/Key=value"  changes a key of the scene; as often as wanted       none
)";

const char* const of_study = R"(usage: kerf study STUDY.prm [options]
Runs a scene in variants: error against run time, as a table. `kerf params study` lists the keys.

  --set "Section/Key=value"  changes a key of the study; as often as wanted       none
  --jobs N                   N rows at a time, where their times do not count      1
  --row K                    the K-th row alone, for an array of jobs; --resume without it gathers them
  --output DIR               folder of the results                                results/STUDY
  --threads N                1 to 1024                                            as many as there are processors
  --force                    deletes what Kerf has made in the folder, and begins anew
  --resume                   takes the finished rows, and goes on with the one that was under way; its CPU time is the
                             sum of all processes that it took
Without --force or --resume a folder that holds results is refused.
)";

const char* const of_bench = R"(usage: kerf bench [options]
Measures each hot path of the program on cubes of about 200 cells and more: seconds a call, items a second, and what part that
is of the additions and multiplications, and of the bytes, that this machine does at most, which is measured too. Medians of
samples on the clock: leave the machine alone meanwhile.

  --only PATH                only the paths whose name has this                   all
  --largest CELLS            of a body, 216 to 1e6                                1e5
  --samples N                of each path and size, 1 to 1000                     7
  --threads N                1 to 1024                                            1
  --output DIR               folder of bench.h5 and bench.csv                     results/bench
  --against FILE.h5          an earlier bench.h5: names what is slower by more than 10 %
                             and than its samples spread, and what is not measured now
  --force                    replaces the results of an earlier one
)";

const char* const of_weights = R"(usage: kerf weights WEIGHTS.prm [options]
Weights of a point near simple cuts by every criterion of visibility, as images, and of a pair as a cut grows, as a table.

  --set "Section/Key=value"  changes a key of the file; as often as wanted        none
  --output DIR               folder of the images and of weights.h5               results/WEIGHTS
Images and table of an earlier call there are replaced.
)";

const char* const of_texture = R"(usage: kerf texture SCENE.prm --plane "x, y, z; normal x, y, z" [options]
What is inside of a body, on any plane, as a picture, without a simulation.

  --plane "POINT; NORMAL"    the plane at rest, in m; "POINT; NORMAL; DIRECTION" says where columns run to as well
  --body NAME                one with a subsection Interior                       the first such
  --pixel M                  side of a pixel [m]                                  that of the exemplars
  --output FILE.png          or .jpg                                              texture.png
  --set "Section/Key=value"  changes a key of the scene; as often as wanted       none
  --threads N                1 to 1024                                            as many as there are processors
)";

const char* const of_params = R"(usage: kerf params [study]
Prints every section and key of a scene, or of a study, with its default, its rule and what it means; and the
observables that a scene can have.
)";

const char* const of_table = R"(usage: kerf table --output FILE.h5
Writes the Splitting Cubes table: which triangles each cut of a cube has.
)";

} // namespace

std::string help_of(const std::string& command) {
  static const std::map<std::string, const char*> pages = {
    {"run", of_run},         {"check", of_check},     {"study", of_study},   {"bench", of_bench},
    {"weights", of_weights}, {"texture", of_texture}, {"params", of_params}, {"table", of_table}};
  const auto page = pages.find(command);
  return page == pages.end() ? "" : page->second + std::string(exit_codes);
}

} // namespace kerf::apps
