#include "process.h"

#include "base/error.h"

#include <cstdlib>

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace kerf::apps {

Process start(const std::vector<std::string>& words, const int signal_at_our_end) {
  std::vector<char*> pointers;
  for (const std::string& word : words)
    pointers.push_back(const_cast<char*>(word.c_str()));
  pointers.push_back(nullptr);
  Process process;
  process.said = std::tmpfile();
  const int said = process.said ? fileno(process.said) : STDERR_FILENO;
  process.id = fork();
  if (process.id == 0) {
    prctl(PR_SET_PDEATHSIG, signal_at_our_end);
    dup2(said, STDOUT_FILENO);
    dup2(said, STDERR_FILENO);
    execv("/proc/self/exe", pointers.data());
    std::_Exit(127);
  }
  if (process.id < 0)
    throw DataError("no process can be started: the system has no more of them");
  return process;
}

int exit_code_of(const Process& process) {
  int status = 0;
  if (waitpid(process.id, &status, WNOHANG) != process.id)
    return -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

std::string last_words(Process& process) {
  std::string last, line;
  if (process.said)
    std::rewind(process.said);
  for (int c = 0; process.said && (c = std::fgetc(process.said)) != EOF;) {
    if (c == '\n') {
      last = line;
      line.clear();
    } else {
      line += static_cast<char>(c);
    }
  }
  if (process.said)
    std::fclose(process.said);
  process.said = nullptr;
  return line.empty() ? last : line;
}

} // namespace kerf::apps
