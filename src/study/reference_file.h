#pragma once

/// References that another program has computed: a number of a file of comma-separated values, or a displacement that
/// CalculiX has printed (.dat, *NODE PRINT) or stored (.frd, *NODE FILE). The section `Reference file` of a study.

#include "scene/parameter_file.h"
#include "study/plan.h"

namespace kerf::study {

scene::SectionKind reference_file_grammar();

/// The number and where it stands. Throws DataError for a file that cannot be read, ParameterError at the section for a
/// column, line or node that it does not have, and for a column of another unit than `unit`.
Reference read_reference_file(const scene::Section& section, const std::string& unit);

} // namespace kerf::study
