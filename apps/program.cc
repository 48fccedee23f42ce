#include "commands.h"
#include "streams.h"

#include "base/error.h"
#include "base/interrupt.h"
#include "base/parallel.h"
#include "scene/build_info.h"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <map>
#include <new>

namespace {

constexpr const char* usage = R"(usage:
  kerf run SCENE.prm... [--set "Section/Key=value"]... [--output DIR] [--threads N] [--force | --resume] [--jobs N]
                                                          one scene, or several: N at a time, each into DIR/SCENE;
                                                          --force replaces the results of an earlier run, --resume
                                                          goes on from its last checkpoint
  kerf check SCENE.prm [--set "Section/Key=value"]...     parse and compose, run nothing
  kerf study STUDY.prm [--set ...] [--output DIR] [--threads N] [--force | --resume] [--jobs N | --row K]
                                                          a scene in variants: error against run time, as a table;
                                                          --jobs gives each row a process, N at a time where times
                                                          do not count; --row runs one alone
  kerf weights WEIGHTS.prm [--set ...] [--output DIR]     weights of points near cuts, as images and a table
  kerf texture SCENE.prm --plane "x, y, z; normal x, y, z" [--pixel M] [--output FILE.png] [--set ...] [--threads N]
                                                          the inside of its first body that has one, on any plane
  kerf report FILE.h5|FOLDER... [--output DIR] [--force]  one page about runs and studies, and figures for a paper
  kerf export --volume RUN [--body NAME] [--output FILE]  a run's cells with fields over time, for ParaView
  kerf inspect FILE...                                    what is in a file of ours
  kerf bench [--only PATH] [--largest CELLS] [--against FILE.h5] [--threads N] [--output DIR] [--force]
                                                          how fast each hot path is here, over the size of a body
  kerf params [study]                                     every section and key of a scene, or of a study
  kerf table --output FILE.h5                             the Splitting Cubes table as a file
  kerf run --help                                         its options with their defaults; check and study too
  kerf --version                                          version, commit, compiler, libraries
exit codes: 1 the scene, 2 a file, 3 the computation; 128 + n: ended by signal n
)";

int print_version() {
  const kerf::output::RunInfo info = kerf::scene::build_info();
  std::printf("kerf %s, commit %s, %s", info.version.c_str(), info.git_commit.c_str(), info.compiler.c_str());
  for (const auto& [name, version] : info.libraries)
    std::printf(", %s %s", name.c_str(), version.c_str());
  std::printf("\n");
  return 0;
}

int dispatch(const kerf::apps::Arguments& arguments) {
  using Command = int (*)(const kerf::apps::Arguments&);
  const std::map<std::string, Command> commands = {{"run", kerf::apps::run},       {"check", kerf::apps::check},
                                                   {"study", kerf::apps::study},   {"weights", kerf::apps::weights},
                                                   {"params", kerf::apps::params}, {"texture", kerf::apps::texture},
                                                   {"table", kerf::apps::table},   {"bench", kerf::apps::bench}};
  if (!arguments.empty() && (arguments[0] == "report" || arguments[0] == "export" || arguments[0] == "inspect"))
    kerf::apps::become_python(arguments[0], {arguments.begin() + 1, arguments.end()});
  const auto asks_for_help = [](const std::string& word) { return word == "--help" || word == "-h"; };
  if (arguments.empty() || arguments[0] == "help" || std::any_of(arguments.begin(), arguments.end(), asks_for_help)) {
    const std::string page = arguments.empty() ? "" : kerf::apps::help_of(arguments[0]);
    std::printf("%s", page.empty() ? usage : page.c_str());
    return arguments.empty() ? 1 : 0;
  }
  if (arguments[0] == "--version")
    return print_version();
  const auto command = commands.find(arguments[0]);
  if (command == commands.end())
    throw kerf::ParameterError("there is no command '" + arguments[0] + "'.\n" + usage);
  return command->second({arguments.begin() + 1, arguments.end()});
}

} // namespace

int kerf::apps::program(const int argc, const char* const* const argv) {
  kerf::apps::make_streams_safe();
  kerf::heed_signals();
  std::signal(SIGXFSZ, SIG_IGN); // a file size limit is then an error of the write, like a full disk
  kerf::set_n_threads(kerf::n_processors()); // deal.II has counted those of the machine
  try {
    const int exit_code = dispatch({argv + 1, argv + argc});
    kerf::apps::finish_stdout();
    return exit_code;
  } catch (const kerf::Error& error) {
    std::fprintf(stderr, "kerf: %s\n", error.what());
    return error.exit_code();
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "kerf: out of memory. Use a larger cube edge.\n");
    return 3;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "kerf: internal error: %s\n", error.what());
    return 4;
  }
}
