#pragma once

/// HDF5 on top of a JournaledFile: a driver that hands every read and write of the library on to it.
/// Source: HDF5 1.10 reference, "Virtual File Layer".

#include "output/journaled_file.h"

namespace kerf::output::h5 {

/// Makes HDF5 files opened with this access property list live in `file`, which must outlive them.
void use_journal(std::int64_t access_list, JournaledFile& file);

} // namespace kerf::output::h5
