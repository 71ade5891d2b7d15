// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/io/files.h"

#include <filesystem>
#include <fstream>

#include "leaflight/math/error.h"
#include "leaflight/math/platform.h"

namespace leaflight {
namespace fs = std::filesystem;

void write_atomically(const std::string& path,
                      const std::function<void(const std::string&)>& write) {
  const fs::path target(path);
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  std::error_code failure;
  if (!fs::is_directory(folder, failure)) {
    throw Error("The folder '" + folder.string() + "' for '" + target.filename().string() +
                "' does not exist; create it or choose another.");
  }
  if (fs::is_directory(target, failure)) {
    throw Error("'" + path + "' is a folder; choose a file name.");
  }
  const fs::path temporary = folder / ("." + target.filename().string() + "." +
                                       std::to_string(process_number()) + ".part");
  const auto unwritable = [&](const std::string& why) {
    fs::remove(temporary, failure);
    return Error("'" + path + "' cannot be written (" + brief(why) +
                 "); check the folder's permissions and the free space.");
  };
  if (!std::ofstream(temporary)) throw unwritable("the folder is not writable");
  try {
    write(temporary.string());
  } catch (const Error&) {
    fs::remove(temporary, failure);
    throw;
  } catch (const std::exception& problem) {
    throw unwritable(problem.what());
  }
  fs::rename(temporary, target, failure);
  if (failure) throw unwritable(failure.message());
}

std::uintmax_t require_file(const std::string& path) {
  std::error_code failure;
  if (!fs::exists(path, failure)) {
    throw Error("There is no file '" + path + "'; check the path.");
  }
  if (!fs::is_regular_file(path, failure)) {
    throw Error("'" + path + "' is not a file; give the path of one.");
  }
  if (!std::ifstream(path)) {
    throw Error("The file '" + path + "' cannot be read; check its permissions.");
  }
  return fs::file_size(path);
}

std::string brief(const std::string& message) {
  std::string line = message.substr(0, std::min<std::size_t>(200, message.find('\n')));
  for (char& c : line) c = static_cast<unsigned char>(c) < 0x80 ? c : '?';
  return line;
}

}  // namespace leaflight
