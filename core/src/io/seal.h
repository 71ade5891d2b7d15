// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>

namespace leaflight {

// The state of a file's seal. A seal is the last 24 bytes of our files: the length and a checksum
// of the content before it. Readers of the format ignore it. It detects damage before a library
// reads a file and trusts it. It does not detect deliberate changes.
enum class Seal { none, whole, broken };

// Appends a seal. Throws Error with the cause only.
void seal(const std::filesystem::path& path);

// True if there is a seal, valid or not. Throws Error.
bool has_seal(const std::filesystem::path& path);

// Returns the length of a file without its seal.
std::uint64_t length_without_seal(const std::filesystem::path& path, bool sealed);

// Reads the whole file and checks its seal. Throws Error.
Seal check_seal(const std::filesystem::path& path);

}  // namespace leaflight
