#pragma once

/// Cases of a change that are written as values of one key: a list of words, or a range of numbers.

#include "study/choices.h"

namespace kerf::study {

/// A case a value, named like it; none where the change names no key. Throws ParameterError for a key without values
/// and values without a key, for both a list and a range, and for a range that is empty.
std::vector<Choice> read_values(const scene::Section& change);

} // namespace kerf::study
