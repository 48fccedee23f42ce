#pragma once

/// The SHA-256 of bytes and files, as `sha256sum` prints it. Source: FIPS 180-4, Secure Hash Standard, 2015.

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

namespace kerf {

/// 64 hexadecimal digits.
std::string sha256(std::span<const std::byte> bytes);
/// Of a file's bytes. Throws DataError when it cannot be read.
std::string sha256_of_file(const std::filesystem::path& path);

} // namespace kerf
