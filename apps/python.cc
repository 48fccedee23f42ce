#include "commands.h"

#include "base/error.h"

#include <unistd.h>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <system_error>

namespace kerf::apps {

namespace {

/// The package beside the installed program, or in the sources that the program was built from.
std::filesystem::path find_package() {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  for (const auto& folder :
       {program.parent_path() / KERF_PYTHON_FROM_PROGRAM, std::filesystem::path(KERF_PYTHON_IN_SOURCES)})
    if (std::filesystem::exists(folder / "main.py", error))
      return folder / "main.py";
  throw DataError(Complaint{.file = (program.parent_path() / KERF_PYTHON_FROM_PROGRAM).string(),
                            .rule = "the Python package is not there",
                            .remedy = "Install Kerf whole: cmake --install BUILD --prefix DIR"});
}

/// Debian's, which has Debian's packages, unless the environment names another.
std::string find_python() {
  const char* named = std::getenv("KERF_PYTHON");
  if (named != nullptr && *named != '\0')
    return named;
  return access("/usr/bin/python3", X_OK) == 0 ? "/usr/bin/python3" : "python3";
}

} // namespace

void become_python(const std::string& command, const Arguments& arguments) {
  const std::string python = find_python();
  std::vector<std::string> words = {python, find_package().string(), command};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> raw;
  for (std::string& word : words)
    raw.push_back(word.data());
  raw.push_back(nullptr);
  execvp(python.c_str(), raw.data());
  throw DataError(Complaint{.file = python,
                            .rule = "cannot be run: " + std::generic_category().message(errno),
                            .remedy = "Install python3, or name a Python with KERF_PYTHON"});
}

} // namespace kerf::apps
