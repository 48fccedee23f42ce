#pragma once

/// What a scene file says, before anyone asks whether it makes sense: sections, keys, values, and where each was
/// written.
///
/// Syntax (deal.II's .prm): one of `subsection HEADING`, `set KEY = VALUE`, `end` a line; # starts a comment; a
/// backslash at the end of a line joins the next one. Stricter than deal.II: lower case only, no include, no key or
/// section twice, no `set` outside of a section, no comment that swallows the next line. Lines count from 1.

#include "base/error.h"

#include <string>
#include <vector>

namespace kerf::scene {

/// Where something was written: a line of a file; or line 0 and `--set "..."` for what the command line overrides.
struct Origin {
  std::string file;
  int line = 0; ///< 0: of what an override says

  bool is_override() const { return line == 0; }
};

/// Lines of the text, from the first to the last; 0, 0 for what only the command line says.
struct Lines {
  int first = 0, last = 0;
};

struct WrittenKey {
  std::string name;
  std::string value; ///< may be empty
  Origin origin;
  Lines lines = {}; ///< in the text, overridden or not
};

struct WrittenSection {
  std::string heading; ///< "Body liver"; empty at the root
  Origin origin;
  Lines lines = {}; ///< from `subsection` to `end`
  std::vector<WrittenKey> keys;
  std::vector<WrittenSection> sections;

  WrittenSection* find_section(const std::string& heading);
  WrittenKey* find_key(const std::string& name);
};

struct SceneText {
  std::string file;
  std::string text; ///< the file as it is, without overrides
  WrittenSection root;
};

/// Reads a file and lays overrides "Section/Sub section/Key=value" over it. A '/' or '=' in [brackets] separates
/// nothing; a later override of one key wins; sections that the file lacks are added. Throws DataError for a file that
/// cannot be read, ParameterError for what breaks the syntax.
SceneText read_scene_text(const std::string& path, const std::vector<std::string>& overrides);

/// The same for a text; `file` names it in errors.
SceneText scan_scene_text(const std::string& text, const std::string& file,
                          const std::vector<std::string>& overrides = {});

} // namespace kerf::scene
