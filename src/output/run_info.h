#pragma once

/// Where a file comes from, as attributes of its root.

#include "output/h5.h"
#include "output/records.h"

namespace kerf::output {

void write_info(const h5::Object& root, const RunInfo& info);
RunInfo read_info(const h5::Object& root);
/// The attribute `outcome`; throws DataError for an unknown word.
Outcome read_outcome(const h5::Object& root);

} // namespace kerf::output
