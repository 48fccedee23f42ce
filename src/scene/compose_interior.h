#pragma once

/// The inside of a body from its section `Interior`.

#include "scene/composing.h"
#include "scene/grammar.h"
#include "scene/interior.h"

#include <filesystem>

namespace kerf::scene {

/// What an interior is made of, as the scene writes it.
struct InteriorInput {
  std::vector<texture::Exemplar> exemplars;
  texture::InteriorOptions options;
};

/// Reads the section with its exemplars and pins. Throws ParameterError or DataError at the key that is to blame.
InteriorInput read_interior(const Section& section);

/// The interior of a body. Warps are read from the folder `cache` beside the scene where they are known, and left
/// there. Adds lines to `composition`.
std::unique_ptr<BodyInterior> compose_interior(const Section& section, const std::string& body_name,
                                               const geometry::TriangleMesh& mesh,
                                               std::vector<std::string>& composition);

/// Throws ParameterError at the key "Resolution [m]" if colours would lie closer than triangles can carry them whose
/// longest side is about `cube_edge` [m], or the skin (where a picture colours it) and one cut straight across the body
/// would take more than a gibibyte of them.
void require_affordable_colours(const Section& section, const geometry::TriangleMesh& mesh, double cube_edge);

/// A body that is only looked into.
struct LookedInto {
  geometry::TriangleMesh mesh;
  std::unique_ptr<BodyInterior> interior;
  std::vector<std::string> composition;
};

/// The body of that name, or without a name the first one that has an interior, without grid and physics. Throws
/// ParameterError if there is none.
LookedInto compose_inside(const SceneText& text, const std::string& name = "");

} // namespace kerf::scene
