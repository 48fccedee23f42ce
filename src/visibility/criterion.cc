#include "visibility/criterion.h"

#include "base/error.h"
#include "visibility/cpu_rasteriser.h"
#include "visibility/extended.h"
#include "visibility/gl_rasteriser.h"
#include "visibility/line_of_sight.h"
#include "visibility/paths.h"

#include <algorithm>

namespace kerf::visibility {

namespace {

const std::vector<std::string> rasterisers = {"CPU", "OpenGL"};
constexpr Range at_least_1{1};
constexpr Range at_least_2{2};

std::string any_of(const std::vector<std::string>& words) {
  std::string rule = "must be one of: ";
  for (const std::string& word : words)
    rule += (&word == &words.front() ? "" : ", ") + word;
  return rule;
}

void require_word(const std::string& path, const std::string& value, const std::vector<std::string>& words) {
  if (std::find(words.begin(), words.end(), value) == words.end())
    throw ParameterError({.path = path, .value = value, .rule = any_of(words)});
}

double require_number(const std::string& path, const double value, const Range& range) {
  if (!range.contains(value))
    throw ParameterError({.path = path, .value = to_text(value), .rule = range.rule()});
  return value;
}

std::unique_ptr<Rasteriser> make_rasteriser(const std::string& name) {
  require_word("Masks by", name, rasterisers);
  if (name == "OpenGL")
    return std::make_unique<GlRasteriser>();
  return std::make_unique<CpuRasteriser>();
}

} // namespace

const std::vector<std::string>& criteria() {
  static const std::vector<std::string> names = {"visibility", "diffraction", "transparency", "extended visibility"};
  return names;
}

void CriterionChoice::describe(Parameters& p) {
  p.choice("Criterion", criterion, criteria(),
           "How a cut weakens the bonds of a pair of points, thesis §2.3.1, §2.6.2.");
  p.number("Diffraction exponent [1]", diffraction_exponent, at_least_1, "gamma of (2.34).");
  p.number("Transparency exponent [1]", transparency_exponent, at_least_2, "gamma of (2.35).");
  p.integer("Mask resolution [texels]", mask_resolution, {4, MaskShape::max_resolution},
            "Texels a side of a visibility disk; each pair takes so many words of 32 bits.");
  p.number("Disk radius [1]", disk_radius, positive, "Radius of the visibility disk in distances of its pair.");
  p.choice("Masks by", masks_by, rasterisers, "Who fills the masks; OpenGL is the way of thesis §2.6.3, and slower.");
}

std::unique_ptr<Criterion> make_criterion(const CriterionChoice& choice, const std::span<const Face> skin) {
  require_word("Criterion", choice.criterion, criteria());
  if (choice.criterion == "visibility")
    return std::make_unique<LineOfSight>();
  if (choice.criterion == "diffraction")
    return std::make_unique<Diffraction>(
      require_number("Diffraction exponent [1]", choice.diffraction_exponent, at_least_1));
  if (choice.criterion == "transparency")
    return std::make_unique<Transparency>(
      require_number("Transparency exponent [1]", choice.transparency_exponent, at_least_2));
  const MaskShape shape(choice.mask_resolution, choice.disk_radius);
  return std::make_unique<ExtendedVisibility>(shape, make_rasteriser(choice.masks_by), skin);
}

} // namespace kerf::visibility
