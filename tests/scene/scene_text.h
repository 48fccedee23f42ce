#pragma once

/// Scenes that tests write themselves.

#include "tests/support/checkout.h"

#include <string>
#include <vector>

namespace kerf::scene {

using Overrides = std::vector<std::string>;

/// A mesh of the example scenes.
inline std::string mesh_path(const std::string& name) { return support::checkout() + "/params/meshes/" + name; }

/// A free cube of edge 0.2 m around the origin, 4 cubes an edge, skin midway between nodes; five steps, and no more.
inline std::string cube_scene() {
  return "subsection Time\n"
         "  set Time step [s] = 0.01\n"
         "  set End time [s]  = 0.05\n"
         "end\n"
         "subsection Body cube\n"
         "  set Mesh          = " +
         mesh_path("cube.off") +
         "\n"
         "  set Cube edge [m] = 0.05\n"
         "  subsection Material\n"
         "    set Density [kg/m^3]     = 1000\n"
         "    set Young's modulus [Pa] = 1e4\n"
         "    set Poisson's ratio [1]  = 0.3\n"
         "  end\n"
         "end\n";
}

/// A blade along y that falls through the whole cube, a little beside its middle, within the five steps.
inline std::string falling_blade() {
  return "subsection Blade knife\n"
         "  set Edge [m]      = 0, -0.2, 0; 0, 0.2, 0\n"
         "  set Spine [m]     = 0, 0, 0.03\n"
         "  set Times [s]     = 0, 0.05\n"
         "  set Positions [m] = 0.003, 0, 0.13; 0.003, 0, -0.13\n"
         "end\n";
}

/// Everything a scene can have beside bodies and blades; the images are small.
inline std::string all_outputs() {
  return "subsection Gravity\n"
         "end\n"
         "subsection Observables\n"
         "  set Names = kinetic energy, elastic energy, gravity energy, mass, momentum x, pieces, cut edges\n"
         "end\n"
         "subsection Output\n"
         "  set Frames every [1] = 1\n"
         "end\n"
         "subsection Surface file\n"
         "end\n"
         "subsection Images\n"
         "  set Width [1]  = 64\n"
         "  set Height [1] = 48\n"
         "  set Eye [m]    = 0.3, -0.6, 0.3\n"
         "  set Target [m] = 0, 0, 0\n"
         "end\n";
}

/// Number of the first line, from 1, that holds `words`.
inline int line_of(const std::string& text, const std::string& words) {
  int line = 1;
  for (const char c : text.substr(0, text.find(words)))
    line += c == '\n' ? 1 : 0;
  return line;
}

} // namespace kerf::scene
