// Loaded before Mesa: no OpenGL context can be made, and whoever tries leaves a word.

#include <cstdio>

extern "C" void* OSMesaCreateContextAttribs(const int*, void*) {
  std::fputs("a context was asked for\n", stderr);
  return nullptr;
}
