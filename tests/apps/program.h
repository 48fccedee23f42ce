#pragma once

/// Runs the program in a folder of its own, and what tests ask of the way it ends.

#include "apps/commands.h"
#include "geometry/triangle_mesh.h"
#include "tests/output/samples.h"
#include "tests/scene/scene_text.h"

#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace kerf::apps {

using scene::all_outputs;
using scene::cube_scene;
using scene::falling_blade;
using scene::line_of;
using scene::mesh_path;
using Words = std::vector<std::string>;

/// The program under test; the environment may name another build of it: KERF_PROGRAM=build/asan/apps/kerf.
inline std::string program_file() {
  const char* const other = std::getenv("KERF_PROGRAM");
  return other ? std::filesystem::absolute(other).string() : KERF_PROGRAM;
}

struct Result {
  int exit_code = -1; ///< -1 when a signal ended it
  int signal = 0;
  std::string out, err;
};

inline std::string read_text(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// The text with the first `from` replaced.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

inline void write_off(const std::filesystem::path& path, const geometry::TriangleMesh& mesh) {
  std::ofstream out(path);
  out << "OFF\n" << mesh.vertices.size() << ' ' << mesh.triangles.size() << " 0\n";
  for (const Vec3& v : mesh.vertices)
    out << v[0] << ' ' << v[1] << ' ' << v[2] << '\n';
  for (const Triangle& t : mesh.triangles)
    out << "3 " << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
}

/// The program, in a folder that goes away.
class Program : public testing::Test {
 protected:
  /// Runs `kerf arguments...`, after the shell commands `before`, such as a limit, where there are any.
  Result kerf(const Words& arguments, const std::string& before = "") const {
    int status = 0;
    waitpid(before.empty() ? start(arguments) : start_after(before, arguments), &status, 0);
    Result result{.out = read_text(folder / "stdout"), .err = read_text(folder / "stderr")};
    if (WIFEXITED(status))
      result.exit_code = WEXITSTATUS(status);
    else
      result.signal = WTERMSIG(status);
    return result;
  }

  /// Starts `kerf arguments...` beside this process.
  pid_t start(const Words& arguments) const {
    Words words = {"kerf"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    const std::vector<char*> pointers = pointers_to(words);
    const bool is_loaded = !needs_its_file(arguments);
    std::fflush(nullptr);
    const pid_t id = fork();
    if (id == 0) {
      if (chdir((folder / "").c_str()) != 0 || !std::freopen("stdout", "w", stdout) ||
          !std::freopen("stderr", "w", stderr))
        _exit(127);
      setenv("GTEST_FILTER", "-*", 1); // of the tests, if the program starts itself all the same: none
      if (is_loaded)
        std::exit(apps::program(static_cast<int>(words.size()), pointers.data()));
      execv(program_file().c_str(), pointers.data());
      _exit(127);
    }
    return id;
  }

  void write(const std::string& name, const std::string& text) const { std::ofstream(folder / name) << text; }

  /// Runs a scene into the folder "out", in place of what an earlier run has left there.
  Result run(const std::string& scene, Words more = {}, const std::string& before = "") const {
    write("scene.prm", scene);
    const Words start = {"run", "scene.prm", "--output", "out", "--force"};
    more.insert(more.begin(), start.begin(), start.end());
    return kerf(more, before);
  }

  /// A scene that must be refused before anything is written.
  void expect_refused(const std::string& scene, const Words& parts, const Words& more = {}) const {
    expect_error(run(scene, more), 1, parts);
    EXPECT_FALSE(std::filesystem::exists(folder / "out"));
  }

  /// The last word of the program is one line for users that holds all the parts.
  static void expect_error(const Result& result, const int exit_code, const Words& parts) {
    EXPECT_EQ(result.signal, 0);
    EXPECT_EQ(result.exit_code, exit_code);
    EXPECT_TRUE(result.err.starts_with("kerf: ")) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    for (const std::string& part : parts)
      EXPECT_NE(result.err.find(part), std::string::npos) << "no '" << part << "' in: " << result.err;
    for (const char* inner : {"internal error", "terminate", "what()", "std::", "dealii", "Eigen", "Stack", "HDF5-DIAG",
                              "Message:", "nan", "0.000000"})
      EXPECT_EQ(result.err.find(inner), std::string::npos) << "'" << inner << "' in: " << result.err;
  }

  output::TemporaryFolder folder;

  /// As exec takes them; good as long as the words are.
  static std::vector<char*> pointers_to(Words& words) {
    std::vector<char*> pointers;
    for (std::string& word : words)
      pointers.push_back(word.data());
    pointers.push_back(nullptr);
    return pointers;
  }

 private:
  /// A child is the program as it was linked into the tests, which have loaded its libraries: a third of a second. Not
  /// so where another build is asked for, or where the program starts itself (jobs, rows, several scenes) or looks beside
  /// itself (Python).
  static bool needs_its_file(const Words& arguments) {
    const auto asks_for = [&](const char* const word) {
      return std::find(arguments.begin(), arguments.end(), word) != arguments.end();
    };
    const auto n_files = std::count_if(arguments.begin(), arguments.end(),
                                       [](const std::string& word) { return word.ends_with(".prm"); });
    return std::getenv("KERF_PROGRAM") || n_files > 1 || asks_for("--jobs") || asks_for("study") ||
           asks_for("report") || asks_for("export") || asks_for("inspect");
  }

  pid_t start_after(const std::string& before, const Words& arguments) const {
    const std::string script =
      "cd '" + (folder / "").string() + "' && exec >stdout 2>stderr && " + before + " && exec \"$0\" \"$@\"";
    Words words = {"/bin/sh", "-c", script, program_file()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    const std::vector<char*> pointers = pointers_to(words);
    const pid_t id = fork();
    if (id == 0) {
      execv(pointers[0], pointers.data());
      _exit(127);
    }
    return id;
  }
};

} // namespace kerf::apps
