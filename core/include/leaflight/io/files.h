// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace leaflight {

// Calls write(temporary path) and renames the result to `path`, so that a crash or an exception
// never leaves half a file under the final name. Throws Error when the folder cannot be written.
void write_atomically(const std::string& path,
                      const std::function<void(const std::string&)>& write);

// Throws Error when there is no readable file at `path`; returns its size in bytes.
std::uintmax_t require_file(const std::string& path);

// The first line of a text from a library or a file, at most 200 characters of ASCII: a damaged
// file can put anything there.
std::string brief(const std::string& message);

}  // namespace leaflight
