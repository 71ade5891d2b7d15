// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

namespace leaflight {

// The end of a file of ours: its length and a checksum of all before, 24 bytes that readers of the
// format never come to. It detects damage before a library reads a file that it trusts. Against
// someone who changes a file with intent it is no help.
enum class Seal { none, whole, broken };

// Adds the seal. Throws Error, which says why alone.
void seal(const std::filesystem::path& path);

// Whether there is one, be it right or not. Throws Error.
bool has_seal(const std::filesystem::path& path);

// Reads the whole file. Throws Error.
Seal check_seal(const std::filesystem::path& path);

}  // namespace leaflight
