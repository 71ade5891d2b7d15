// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace leaflight {

// The texts among the metadata of any .vdb file itself, by name; none where an early OpenVDB wrote
// it. Reads its first bytes alone, without OpenVDB, which trusts them. Throws Error.
std::map<std::string, std::string> read_vdb_texts(const std::filesystem::path& path);

}  // namespace leaflight
