#pragma once
/// SHA-256 after FIPS 180-4: checksums of input files, and of a page's script.
///
/// Real time: no. Errors: sha256_of_file() those of reading the file.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace stribeck::io {

using Digest = std::array<std::uint8_t, 32>;

Digest sha256(std::string_view bytes);
std::string hexadecimal(const Digest& digest);
std::string base64(const Digest& digest);
/// Hexadecimal, as sha256sum prints it.
std::string sha256_of_file(const std::string& path);

}  // namespace stribeck::io
