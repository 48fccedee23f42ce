#pragma once

/// The grammar as a page for people.

#include "scene/text_grammar.h"

#include <string>
#include <vector>

namespace kerf::scene {

/// Every section and key with default, rule and text, as .prm text with comments.
std::string print_parameters(const std::vector<SectionKind>& grammar);

/// What `Names` of the section Observables may hold, with unit and meaning, as comments of a .prm text.
std::string print_observables();

} // namespace kerf::scene
