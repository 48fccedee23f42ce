#pragma once

/// The series of a run's file, in the order in which they were named: HDF5 itself keeps links by name only.

#include "output/h5_array.h"
#include "output/records.h"

namespace kerf::output {

void write_order(const h5::Object& root, const Schema& schema);
Schema read_schema(const h5::Object& root);

} // namespace kerf::output
