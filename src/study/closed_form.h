#pragma once

/// References that a formula gives: beams, bars and cracks whose answer is known, by name. The section `Closed form` of
/// a study.

#include "scene/parameter_file.h"
#include "study/plan.h"

namespace kerf::study {

scene::SectionKind closed_form_grammar();

/// Throws ParameterError at the section for a number that the form asks for and that is missing, for one that it does
/// not read, and where its unit is not `unit`.
Reference evaluate_closed_form(const scene::Section& section, const std::string& unit);

} // namespace kerf::study
