// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace leaflight {

// Returns a path for error messages, in UTF-8; invalid characters become question marks.
std::string text_of(const std::filesystem::path& path);

// Returns the size in bytes of a file. Throws Error if there is no readable file at `path`.
std::uintmax_t require_file(const std::filesystem::path& path);

// Returns the first line of a text from a library or a file, at most 200 ASCII characters, because
// a damaged file can contain anything.
std::string brief(const std::string& message);

}  // namespace leaflight
