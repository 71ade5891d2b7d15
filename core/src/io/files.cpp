// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files.h"

#include <filesystem>
#include <fstream>
#include <type_traits>

#include "base/error.h"

namespace leaflight {
namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
  try {
    return path.u8string();
  } catch (const fs::filesystem_error&) {
    // Windows allows names with half of a UTF-16 pair, which is no valid text.
    std::string text;
    for (const auto letter : path.native()) {
      const auto code = static_cast<std::make_unsigned_t<fs::path::value_type>>(letter);
      text += code < 0x80 ? static_cast<char>(code) : '?';
    }
    return text;
  }
}

std::uintmax_t require_file(const fs::path& path) {
  std::error_code failure;
  if (!fs::exists(path, failure)) {
    throw Error("There is no file '" + text_of(path) + "'; check the path.");
  }
  if (!fs::is_regular_file(path, failure)) {
    throw Error("'" + text_of(path) + "' is not a file; give the path of one.");
  }
  if (!std::ifstream(path)) {
    throw Error("The file '" + text_of(path) + "' cannot be read; check its permissions.");
  }
  return fs::file_size(path);
}

std::string brief(const std::string& message) {
  std::string line = message.substr(0, std::min<std::size_t>(200, message.find('\n')));
  for (char& c : line) c = static_cast<unsigned char>(c) < 0x80 ? c : '?';
  return line;
}

}  // namespace leaflight
