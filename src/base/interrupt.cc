#include "base/interrupt.h"

#include <csignal>

namespace kerf {

namespace {

volatile std::sig_atomic_t asked = 0; // all that a signal handler may write

void note(const int signal) { asked = signal; }

std::string name_of(const int signal) {
  return signal == SIGINT    ? "SIGINT"
         : signal == SIGTERM ? "SIGTERM"
         : signal == SIGHUP  ? "SIGHUP"
                             : std::to_string(signal);
}

} // namespace

void heed_signals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {
    }, before{};
    action.sa_handler = note;
    action.sa_flags = SA_RESTART | static_cast<int>(SA_RESETHAND);
    if (sigaction(signal, nullptr, &before) == 0 && before.sa_handler != SIG_IGN)
      sigaction(signal, &action, nullptr);
  }
}

int wish_to_end() { return asked; }

Interrupted::Interrupted(const int signal, const std::string& more)
  : Error("interrupted by " + name_of(signal) + more, 128 + signal) {}

} // namespace kerf
