#include "commands.h"

int main(const int argc, char** const argv) { return kerf::apps::program(argc, argv); }
