#pragma once

/// Small scenes with known answers: their text piece by piece, and what a run of them leaves.

#include "tests/scene/worlds.h"

#include <gtest/gtest.h>

#include <fstream>

namespace kerf::scene {

using Keys = std::vector<std::string>;

/// A section with its keys, and what stands inside it.
inline std::string section(const std::string& heading, const Keys& keys, const std::string& inside = "") {
  std::string text = "subsection " + heading + "\n";
  for (const std::string& key : keys)
    text += "  set " + key + "\n";
  return text + inside + "end\n";
}

inline std::string key(const std::string& name, const double value) { return name + " = " + to_text(value); }

inline std::string steps(const double dt, const int n) {
  return section("Time", {key("Time step [s]", dt), key("End time [s]", dt * n)});
}

inline std::string material(const double youngs_modulus, const double poissons_ratio,
                            const std::string& law = "corotational") {
  return section("Material", {key("Young's modulus [Pa]", youngs_modulus), key("Poisson's ratio [1]", poissons_ratio),
                              "Density [kg/m^3] = 1000", "Law = " + law});
}

inline std::string observe(const std::string& names) { return section("Observables", {"Names = " + names}); }

/// A box as the keys of a region.
inline Keys box(const std::string& lower, const std::string& upper) {
  return {"Lower [m] = " + lower, "Upper [m] = " + upper};
}

inline Keys operator+(Keys keys, const Keys& more) {
  keys.insert(keys.end(), more.begin(), more.end());
  return keys;
}

/// The bar [0, 1] x [0, 0.2]^2 m of the example scenes in `n` cubes across, an odd number, so that a layer of nodes
/// lies in each of its middle planes; along x the first one stands a thousandth of a cube inside its end.
inline Keys bar_keys(const int n = 3) {
  return {"Mesh = " + mesh_path("bar.off"), key("Cube edge [m]", 0.2 / n), "Lattice offset [1] = 0.001, 0.5, 0.5"};
}
constexpr double bar_area = 0.04; // [m^2]

/// The bar's end x = 0 held along x; its middle lines there held across: free to contract.
inline std::string sliding_end() {
  return section("Support wall", box("-1, -1, -1", "0.01, 1, 1") + Keys{"Hold = x"}) +
         section("Support y", box("-1, 0.099, -1", "0.01, 0.101, 1") + Keys{"Hold = y"}) +
         section("Support z", box("-1, -1, 0.099", "0.01, 1, 0.101") + Keys{"Hold = z"});
}

inline std::string clamped_end() { return section("Support wall", box("-1, -1, -1", "0.01, 1, 1")); }

/// The cube of 0.2 m around the origin, 3 cubes an edge: layers of nodes in its middle planes.
inline Keys cube_keys() { return {"Mesh = " + mesh_path("cube.off"), key("Cube edge [m]", 0.2 / 3)}; }
constexpr double cube_mass = 8, cube_face = 0.04; // [kg] at 1000 kg/m^3, [m^2]

inline Keys statics() { return {"Integrator = quasi-static"}; }

/// A world that has been run, and its series.
class Trial {
 public:
  explicit Trial(const std::string& text, const Overrides& overrides = {}) : world(world_of(text, overrides)) {
    run_silently(world, folder_ / "out");
    reader_.emplace(folder_ / "out/run.h5");
  }

  const Body& body() const { return world.bodies.at(0); }
  std::vector<double> series(const std::string& name) const { return reader_->observable(body().name + " " + name); }
  double last(const std::string& name) const { return series(name).back(); }
  const output::Reader& reader() const { return *reader_; }
  std::filesystem::path path(const std::string& file) const { return folder_ / "out" / file; }

  World world;

 private:
  output::TemporaryFolder folder_;
  std::optional<output::Reader> reader_;
};

} // namespace kerf::scene
