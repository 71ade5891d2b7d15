// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace leaflight {

// A path as errors call it: UTF-8, but for names that are not.
std::string text_of(const std::filesystem::path& path);

// Throws Error when there is no readable file at `path`; returns its size in bytes.
std::uintmax_t require_file(const std::filesystem::path& path);

// The first line of a text from a library or a file, at most 200 characters of ASCII: a damaged
// file can put anything there.
std::string brief(const std::string& message);

}  // namespace leaflight
