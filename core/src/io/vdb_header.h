// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace leaflight {

// Returns the text entries of a .vdb file's metadata, by name; none for files of an early OpenVDB.
// Reads only its first bytes, without OpenVDB, which would trust them. Throws Error.
std::map<std::string, std::string> read_vdb_texts(const std::filesystem::path& path);

}  // namespace leaflight
