#include "tests/verification/calculix.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <vector>

#include <unistd.h>

namespace kerf::verification::calculix {

namespace {

/// Nodes sit at the points of a lattice twice as fine that have at most one odd coordinate (20 an element), or none
/// (8).
class Writer {
 public:
  explicit Writer(const Deck& deck) : deck_(deck) {}

  std::string text(const std::vector<Probe>& probes) {
    const std::string elements = element_lines(), loads = load_lines();
    std::ostringstream out;
    out << "*NODE, NSET=NALL\n" << node_lines();
    out << "*ELEMENT, TYPE=" << type() << ", ELSET=EALL\n" << elements;
    out << "*NSET, NSET=PROBE\n";
    for (const Probe& p : probes)
      out << id({2 * p.node[0], 2 * p.node[1], 2 * p.node[2]}, p.side) << "\n";
    out << "*MATERIAL, NAME=M\n*ELASTIC\n" << deck_.youngs_modulus << ", " << deck_.poissons_ratio;
    out << "\n*DENSITY\n" << deck_.density << "\n*SOLID SECTION, ELSET=EALL, MATERIAL=M\n";
    out << "*BOUNDARY\n" << support_lines() << "*STEP\n*CONTROLS, PARAMETERS=FIELD\n1e-9, 1e-9\n*STATIC\n" << loads;
    out << "*NODE PRINT, NSET=PROBE\nU\n*END STEP\n";
    return out.str();
  }

  int id(const Index3& i, const Probe::Side side) const {
    const int across = 2 * deck_.n[0] + 1, along = 2 * deck_.n[1] + 1, up = 2 * deck_.n[2] + 1;
    const bool is_twin = side == Probe::Side::above && i[2] == 2 * deck_.slit_layer && i[0] < 2 * deck_.slit_length &&
                         deck_.slit_layer > 0;
    return 1 + i[0] + across * (i[1] + along * i[2]) + (is_twin ? across * along * up : 0);
  }

 private:
  const char* type() const {
    return deck_.element == Element::C3D8 ? "C3D8" : deck_.element == Element::C3D8I ? "C3D8I" : "C3D20R";
  }
  bool is_quadratic() const { return deck_.element == Element::C3D20R; }
  Probe::Side side_of(const int cell_z) const {
    return cell_z >= deck_.slit_layer ? Probe::Side::above : Probe::Side::below;
  }

  /// Places of an element's nodes on the fine lattice, from its lowest one, in CalculiX's order.
  static const std::vector<Index3>& local_nodes() {
    static const std::vector<Index3> all = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 2}, {2, 0, 2}, {2, 2, 2},
                                            {0, 2, 2}, {1, 0, 0}, {2, 1, 0}, {1, 2, 0}, {0, 1, 0}, {1, 0, 2}, {2, 1, 2},
                                            {1, 2, 2}, {0, 1, 2}, {0, 0, 1}, {2, 0, 1}, {2, 2, 1}, {0, 2, 1}};
    return all;
  }

  std::string element_lines() {
    std::ostringstream out;
    int element = 0;
    for (int k = 0; k < deck_.n[2]; ++k)
      for (int j = 0; j < deck_.n[1]; ++j)
        for (int i = 0; i < deck_.n[0]; ++i) {
          out << ++element;
          for (int a = 0; a < (is_quadratic() ? 20 : 8); ++a) {
            const Index3& l = local_nodes()[a];
            const Index3 at = {2 * i + l[0], 2 * j + l[1], 2 * k + l[2]};
            nodes_[id(at, side_of(k))] = at;
            out << "," << (a == 10 ? "\n" : "") << id(at, side_of(k));
          }
          out << "\n";
          press_slit(element, {i, j, k});
        }
    return out.str();
  }

  void press_slit(const int element, const Index3& cell) {
    if (deck_.slit_pressure == 0 || cell[0] >= deck_.slit_length)
      return;
    if (cell[2] == deck_.slit_layer)
      pressed_ << element << ", P1, " << deck_.slit_pressure << "\n";
    if (cell[2] == deck_.slit_layer - 1)
      pressed_ << element << ", P2, " << deck_.slit_pressure << "\n";
  }

  std::string node_lines() const {
    std::ostringstream out;
    out.precision(15);
    for (const auto& [node, at] : nodes_) {
      const Vec3 X = deck_.place(0.5 * Vec3(at[0], at[1], at[2]));
      out << node << ", " << X[0] << ", " << X[1] << ", " << X[2] << "\n";
    }
    return out.str();
  }

  std::string support_lines() const {
    std::ostringstream out;
    for (const auto& [node, at] : nodes_) {
      if (at[0] == (deck_.held == Deck::Held::lower_x ? 0 : 2 * deck_.n[0]))
        out << node << ", 1, 3\n";
      else if (deck_.walls == Deck::Walls::across_z)
        out << node << ", 3, 3\n";
    }
    return out.str();
  }

  /// A uniform traction on a face goes to its 4 corners alike, or -1/12 to its corners and 1/3 to its middles.
  std::map<int, double> end_shares() const {
    std::map<int, double> shares;
    for (int k = 0; k < deck_.n[2]; ++k)
      for (int j = 0; j < deck_.n[1]; ++j)
        for (int a = 0; a < (is_quadratic() ? 20 : 8); ++a) {
          const Index3& l = local_nodes()[a];
          if (l[0] == 2)
            shares[id({2 * deck_.n[0], 2 * j + l[1], 2 * k + l[2]}, side_of(k))] += !is_quadratic() ? 0.25
                                                                                    : a < 8         ? -1.0 / 12
                                                                                                    : 1.0 / 3;
        }
    for (auto& [node, share] : shares)
      share /= deck_.n[1] * deck_.n[2];
    return shares;
  }

  std::string load_lines() const {
    std::ostringstream out;
    out.precision(15);
    if (deck_.gravity.norm() > 0) {
      const Vec3 g = deck_.gravity.normalized();
      out << "*DLOAD\nEALL, GRAV, " << deck_.gravity.norm() << ", " << g[0] << ", " << g[1] << ", " << g[2] << "\n";
    }
    if (deck_.slit_pressure != 0)
      out << "*DLOAD\n" << pressed_.str();
    if (deck_.end_force.norm() > 0) {
      out << "*CLOAD\n";
      for (const auto& [node, share] : end_shares())
        for (int d = 0; d < 3; ++d)
          if (deck_.end_force[d] != 0)
            out << node << ", " << d + 1 << ", " << share * deck_.end_force[d] << "\n";
    }
    return out.str();
  }

  const Deck& deck_;
  std::map<int, Index3> nodes_; // that elements hold, by id
  std::ostringstream pressed_;
};

/// A folder of its own, gone at the end.
struct Folder {
  std::filesystem::path path;

  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "calculix-XXXXXX").string();
    if (!mkdtemp(name.data()))
      throw std::runtime_error("no temporary folder: " + name);
    path = name;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
};

std::string content(const std::filesystem::path& path) {
  std::ifstream in(path);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// Lines of four numbers: node and displacement.
std::map<int, Vec3> read_displacements(const std::filesystem::path& path) {
  std::ifstream in(path);
  std::map<int, Vec3> found;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    int node = 0;
    Vec3 u;
    if (words >> node >> u[0] >> u[1] >> u[2])
      found[node] = u;
  }
  return found;
}

} // namespace

bool is_installed() { return std::system("command -v ccx > /dev/null 2>&1") == 0; }

Points run(const Deck& deck, const std::vector<Probe>& probes) {
  const Folder folder;
  Writer writer(deck);
  std::ofstream(folder.path / "job.inp") << writer.text(probes);
  const std::string command =
    "cd '" + folder.path.string() + "' && OMP_NUM_THREADS=1 timeout 300 ccx -i job > log 2>&1";
  const bool failed = std::system(command.c_str()) != 0;
  const auto found = read_displacements(folder.path / "job.dat");
  Points u;
  for (const Probe& p : probes) {
    const auto it = found.find(writer.id({2 * p.node[0], 2 * p.node[1], 2 * p.node[2]}, p.side));
    if (failed || it == found.end()) {
      const std::string log = content(folder.path / "log");
      throw std::runtime_error("CalculiX failed: " + log.substr(log.size() > 1000 ? log.size() - 1000 : 0));
    }
    u.push_back(it->second);
  }
  return u;
}

double heavy_cantilever(const int n, const Element element, const double poissons_ratio) {
  const double h = 0.2 / n;
  const Deck deck{.element = element,
                  .n = {5 * n, n, n},
                  .place = [h](const Vec3& i) { return Vec3(h * i - Vec3(0, 0.1, 0.1)); },
                  .youngs_modulus = 1e6,
                  .poissons_ratio = poissons_ratio,
                  .gravity = Vec3(0, 0, -9.81)};
  return -run(deck, {{.node = {5 * n, n / 2, n / 2}}})[0][2];
}

} // namespace kerf::verification::calculix
