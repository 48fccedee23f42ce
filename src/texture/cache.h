#pragma once

/// The maps of an interior in a file, so that they are found once. The file's name holds a hash of all that they depend
/// on, and the file ends with a hash of itself: what is damaged, cut short or of another input is not read.

#include "texture/interior.h"

#include <cstdint>
#include <filesystem>

namespace kerf::texture {

/// FNV-1a, 64 bits, over pictures, planes, body and options of matching.
std::uint64_t input_hash(const std::vector<Exemplar>& exemplars, const geometry::TriangleMesh& body,
                         const InteriorOptions& options);

/// folder/interior-HASH.maps
std::filesystem::path cache_file(const std::filesystem::path& folder, std::uint64_t hash);

/// Nothing when there is no such file, or it is not whole.
std::optional<Maps> load_maps(const std::filesystem::path& file, std::uint64_t hash);

/// Makes the folder where it lacks. False when that or the file cannot be written: then the next run finds the maps
/// again.
bool save_maps(const std::filesystem::path& file, std::uint64_t hash, const Maps& maps);

} // namespace kerf::texture
