#pragma once

/// Strict scene files. A grammar says which kinds of sections there are and what their keys are; a file is checked
/// against it as a whole, so that a misspelt key, an unknown section, a bad value or a missing key is a ParameterError
/// with file, line, parameter path, value, rule and remedy. The result is a tree of sections that fill parameter
/// structs and remember what was read: a section or key that nothing reads is an error too.
///
/// Method: text_scan finds which sections exist, and where; text_grammar checks all of it; then
/// dealii::ParameterHandler gets the declarations of these sections and their text, and gives the values.

#include "base/error.h"
#include "base/parameters.h"
#include "scene/text_grammar.h"
#include "scene/text_scan.h"

#include <optional>
#include <set>
#include <string>
#include <vector>

namespace kerf::scene {

/// A section that the scene wrote, checked against the grammar, with defaults filled in.
class Section {
 public:
  const std::string& kind() const { return kind_; } ///< "Body"; empty at the root
  const std::string& name() const { return name_; } ///< "liver"; empty for sections that occur once
  const std::string& path() const { return path_; } ///< "Body liver/Material"
  const Origin& origin() const { return origin_; }

  const std::vector<Section>& sections() const { return sections_; } ///< in the order of the file
  std::vector<const Section*> all(const std::string& kind) const;
  /// The first section of this kind; nullptr when the scene does not write it.
  const Section* find(const std::string& kind) const;
  /// As find; throws ParameterError when the scene does not write it.
  const Section& require(const std::string& kind) const;

  /// Whether the scene writes the key (otherwise it has its default).
  bool writes(const std::string& key) const;

  /// Fills the keys that `fields` describes, and marks them as read.
  template <class Fields>
  void read(Fields& fields) const {
    Parameters parameters;
    fields.describe(parameters);
    assign(parameters);
  }
  template <class Fields>
  Fields read() const {
    Fields fields;
    read(fields);
    return fields;
  }
  /// For a section that is used without a struct.
  void mark_read() const { read_ = true; }

  /// For what can only be seen later: an error about a key (at its line when the scene writes it) or about the section.
  ParameterError complaint(const std::string& key, const std::string& rule, const std::string& remedy) const;
  ParameterError complaint(const std::string& rule, const std::string& remedy) const;

  /// Every section that nothing read, and every written key that nothing read in a section that was. A section without
  /// keys of its own counts as read when it has sections.
  std::vector<Complaint> unread() const;
  /// Throws the first of unread() as a ParameterError.
  void require_all_read() const;

 private:
  friend class SectionReader;
  void assign(const Parameters& parameters) const;

  struct Value {
    std::string key, text;
    std::optional<Origin> origin; // where the scene writes it
  };
  const Value* find_value(const std::string& key) const;

  std::string kind_, name_, path_;
  Origin origin_;
  std::vector<Value> values_; // of every key of the grammar, in its order
  std::vector<Section> sections_;
  // Bookkeeping, no part of the value: reading is const for those who read.
  mutable bool read_ = false;
  mutable std::set<std::string> read_keys_;

  friend Section parse_scene(const SceneText& scene, const std::vector<SectionKind>& grammar);
  friend std::string effective_text(const Section& root);
};

/// Checks a text against the grammar. The root section has the grammar's kinds as sections and no keys. Throws
/// ParameterError.
Section parse_scene(const SceneText& scene, const std::vector<SectionKind>& grammar);

/// The scene as .prm text with every default and override written out: parses to the same values.
std::string effective_text(const Section& root);

} // namespace kerf::scene
