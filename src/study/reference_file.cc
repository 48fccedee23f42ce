#include "study/reference_file.h"

#include "scene/composing.h"
#include "study/units.h"

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

namespace kerf::study {

namespace {

using scene::Section;

struct ReferenceFileParameters {
  std::string file;
  std::string column;
  int line = 0;
  int node = 0, minus_node = 0;
  std::string axis = "z";
  double factor = 1;
  void describe(Parameters& p) {
    p.file("File", file, "Values separated by commas below a line of their names, or CalculiX's .dat or .frd.");
    p.require_last();
    p.text("Column", column, "Of separated values: its name, without the unit that may follow it in brackets.");
    p.integer("Line [1]", line, {.min = 0}, "Below the names, from 1. 0: the last.");
    p.integer("Node [1]", node, {.min = 0},
              "Of CalculiX: the node whose displacement, printed or stored last, is the reference.");
    p.integer("Minus node [1]", minus_node, {.min = 0}, "The displacement of this node is subtracted. 0: none.");
    p.choice("Axis", axis, {"x", "y", "z"}, "The component that is asked for.");
    p.number("Factor [1]", factor, any_number,
             "What stands in the file is multiplied by it, to have the study's unit.");
  }
};

std::vector<std::string> lines_of(const std::string& path) {
  std::ifstream in(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);)
    lines.push_back(line.ends_with('\r') ? line.substr(0, line.size() - 1) : line);
  if (lines.empty())
    throw DataError(
      Complaint{.file = path, .rule = "cannot be read, or is empty", .remedy = "Name a file that holds the reference"});
  return lines;
}

/// Between commas, without blanks and quotes around; commas in quotes part nothing.
std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  bool in_quotes = false;
  for (const char c : line)
    if (c == '"')
      in_quotes = !in_quotes;
    else if (c == ',' && !in_quotes)
      cells.emplace_back();
    else if (c != ' ' || !cells.back().empty())
      cells.back() += c;
  for (std::string& cell : cells)
    cell.erase(cell.find_last_not_of(' ') + 1);
  return cells;
}

/// "rise [m]": name and unit.
std::pair<std::string, std::string> name_and_unit(const std::string& head) {
  const std::size_t at = head.rfind(" [");
  if (at == std::string::npos || !head.ends_with(']'))
    return {head, ""};
  return {head.substr(0, at), head.substr(at + 2, head.size() - at - 3)};
}

std::size_t column_of(const ReferenceFileParameters& p, const std::string& head, const std::string& unit,
                      const Section& section) {
  const auto heads = cells_of(head);
  std::string names;
  for (std::size_t i = 0; i < heads.size(); ++i) {
    const auto [name, its_unit] = name_and_unit(heads[i]);
    names += (names.empty() ? "" : ", ") + name;
    if (name != p.column)
      continue;
    if (!its_unit.empty() && !is_same_unit(its_unit, unit) && !section.writes("Factor [1]"))
      throw section.complaint("Column", "has the unit " + its_unit + ", and the study " + unit,
                              "Write 'set Factor [1] = ...', which makes one of the other");
    return i;
  }
  throw section.complaint("Column", "there is no such column", "Name one of the file's: " + names);
}

double from_values(const ReferenceFileParameters& p, const std::vector<std::string>& lines, const std::string& unit,
                   const Section& section) {
  const std::size_t column = column_of(p, lines.front(), unit, section);
  const std::size_t line = p.line == 0 ? lines.size() - 1 : static_cast<std::size_t>(p.line);
  if (line == 0 || line >= lines.size())
    throw section.complaint("Line [1]", "the file has " + std::to_string(lines.size() - 1) + " lines below its names",
                            "Write a line that it has");
  const auto cells = cells_of(lines[line]);
  double value = 0;
  std::istringstream text(column < cells.size() ? cells[column] : "");
  if (!(text >> value) || !(text >> std::ws).eof())
    throw section.complaint("Column", "line " + std::to_string(line) + " has no number there",
                            "Choose a line that has one");
  return value;
}

using Displacements = std::map<int, Vec3>;

/// "node ux uy uz" below a line that speaks of displacements; the last one of a node counts.
Displacements printed(const std::vector<std::string>& lines) {
  Displacements found;
  bool is_displacement = false;
  for (const std::string& line : lines) {
    std::istringstream words(line);
    int node = 0;
    Vec3 u;
    if (line.find(" for set ") != std::string::npos)
      is_displacement = line.find("displacements") != std::string::npos;
    else if (is_displacement && words >> node >> u[0] >> u[1] >> u[2])
      found[node] = u;
  }
  return found;
}

/// Columns of fixed width: " -1", ten for the node, twelve for each number, in blocks that begin with " -4  DISP" and
/// end with " -3".
Displacements stored(const std::vector<std::string>& lines) {
  Displacements found;
  bool is_displacement = false;
  for (const std::string& line : lines) {
    if (line.starts_with(" -4"))
      is_displacement = line.find("DISP") != std::string::npos;
    else if (line.starts_with(" -3"))
      is_displacement = false;
    else if (is_displacement && line.starts_with(" -1") && line.size() >= 49)
      found[std::stoi(line.substr(3, 10))] =
        Vec3(std::stod(line.substr(13, 12)), std::stod(line.substr(25, 12)), std::stod(line.substr(37, 12)));
  }
  return found;
}

double at_nodes(const ReferenceFileParameters& p, const Displacements& u, const Section& section) {
  const auto at = [&](const char* key, const int node) {
    const auto found = u.find(node);
    if (found == u.end())
      throw section.complaint(key, "the file has no displacement of this node",
                              "Let CalculiX print it: *NODE PRINT, NSET=..., U; or store it: *NODE FILE, U");
    return found->second[p.axis[0] - 'x'];
  };
  return at("Node [1]", p.node) - (p.minus_node > 0 ? at("Minus node [1]", p.minus_node) : 0);
}

} // namespace

scene::SectionKind reference_file_grammar() {
  return {"Reference file",
          scene::Occurrence::once,
          "A reference that another program has computed, for all rows that have no other.",
          scene::keys_of<ReferenceFileParameters>(),
          {}};
}

Reference read_reference_file(const Section& section, const std::string& unit) {
  const auto p = section.read<ReferenceFileParameters>();
  const std::string path = scene::resolved(p.file, section);
  const auto lines = lines_of(path);
  Reference found;
  const std::string name = std::filesystem::path(path).filename().string();
  if (path.ends_with(".dat") || path.ends_with(".frd")) {
    const bool is_stored = path.ends_with(".frd");
    found.value = p.factor * at_nodes(p, is_stored ? stored(lines) : printed(lines), section);
    found.source = "CalculiX, " + name + ", node " + std::to_string(p.node) + ", " + p.axis;
  } else {
    found.value = p.factor * from_values(p, lines, unit, section);
    found.source = name + ", column " + p.column;
  }
  if (found.value == 0)
    throw section.complaint("the number there is 0, of which no relative error can be told", "Choose another");
  return found;
}

} // namespace kerf::study
