#pragma once

/// Studies that go on after a kill: rows of an earlier run are taken as they are, where everything that they depend on
/// is what it was.

#include "base/error.h"
#include "output/records.h"
#include "scene/text_grammar.h"

#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

namespace kerf::study {

/// A hash of what the rows of a study depend on: the program, the study's text, the scene of each row with its changes,
/// the files that these name. Of a file that cannot be read only its name counts: its rows fail.
std::string made_of(const output::RunInfo& program, const std::string& study,
                    const std::vector<const scene::SceneText*>& scenes);

/// The rows that a study's file holds; none where there is no file. `read` reads its table. Throws DataError where it
/// cannot be read, ParameterError where it was not made of `wanted`.
template <class Table>
auto earlier_rows(const std::filesystem::path& file, Table (*read)(const std::filesystem::path&),
                  const std::string& wanted) {
  std::error_code error;
  if (!std::filesystem::exists(file, error))
    return decltype(Table::rows){};
  Table table = read(file);
  if (table.made_of != wanted)
    throw ParameterError(
      Complaint{.file = file.string(),
                .rule = "cannot be resumed: the study, its scene, a file that it names, or the program is another one",
                .remedy = "Give all of it as it was, or start again with --force"});
  return std::move(table.rows);
}

} // namespace kerf::study
