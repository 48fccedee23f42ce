#include "tests/verification/ngsolve.h"
#include "tests/support/checkout.h"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <stdexcept>
#include <string>

namespace kerf::verification::ngsolve {

bool is_installed() { return std::system("python3 -c 'import ngsolve' > /dev/null 2>&1") == 0; }

Tip heavy_cantilever(const int n_over_height, const int order) {
  const std::string command = "python3 '" + support::checkout() + "/tests/verification/ngsolve_beam.py' " +
                              std::to_string(n_over_height) + " " + std::to_string(order) + " 2>&1";
  FILE* const out = popen(command.c_str(), "r");
  if (!out)
    throw std::runtime_error("no process for " + command);
  std::string text;
  std::array<char, 4096> part;
  while (std::fgets(part.data(), part.size(), out))
    text += part.data();
  Tip tip;
  if (pclose(out) != 0 || !(std::istringstream(text) >> tip.value >> tip.seconds))
    throw std::runtime_error("NGSolve failed: " + text);
  return tip;
}

} // namespace kerf::verification::ngsolve
