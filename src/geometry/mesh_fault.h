#pragma once

/// What is wrong with a mesh file, said before a reader trusts its header, and said with a line after one has failed.

#include <optional>
#include <string>

namespace kerf::geometry {

/// Throws DataError where the header is one that a reader does not survive, or promises more vertices and faces than
/// fit into the length of the file: whoever makes room for them would take any amount of memory.
void require_room_for_header(const std::string& path);

/// The first fault of a text file (OFF, OBJ, PLY, STL) that no reader takes: "line 12: 'nan' is no finite number", or
/// where it ends and how much is missing. None where there is none, or the file is binary.
std::optional<std::string> find_fault(const std::string& path);

} // namespace kerf::geometry
