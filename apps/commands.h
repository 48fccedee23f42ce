#pragma once

/// The program, and its subcommands: each takes the arguments after its name and returns the exit code; errors are
/// thrown.

#include <string>
#include <vector>

namespace kerf::apps {

using Arguments = std::vector<std::string>;

/// What main does, with its arguments: the subcommand that the first one names. Errors are told on stderr. Returns the
/// exit code.
int program(int argc, const char* const* argv);

int run(const Arguments& arguments);
int check(const Arguments& arguments);
int study(const Arguments& arguments);
int weights(const Arguments& arguments);
int params(const Arguments& arguments);
int texture(const Arguments& arguments);
int table(const Arguments& arguments);
int bench(const Arguments& arguments);

/// The page of a command with many options, a line each with its default; empty for the others.
std::string help_of(const std::string& command);

/// Becomes the Python package's command of that name (python/main.py): report, export, inspect. Returns only by
/// throwing DataError, where the package or Python is not there.
[[noreturn]] void become_python(const std::string& command, const Arguments& arguments);

} // namespace kerf::apps
