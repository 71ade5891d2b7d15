// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vdb_header.h"

#include <fstream>

#include "base/error.h"
#include "io/files.h"

namespace leaflight {
namespace {

// The magic number of a file, and the first version with today's headers (openvdb/io/Archive.cc).
constexpr std::uint64_t magic = 0x56444220;
constexpr std::uint32_t oldest = 222;
constexpr std::size_t uuid_size = 36;

// Reads the claimed content of a file, up to its actual length.
class Reader {
 public:
  Reader(const std::filesystem::path& path, std::uintmax_t length)
      : stream_(path, std::ios::binary), left_(length) {
    stream_.exceptions(std::ios::failbit | std::ios::badbit);
  }
  std::string bytes(std::uint64_t count) {
    if (count > left_) throw std::ios::failure("too short");
    left_ -= count;
    std::string text(count, '\0');
    stream_.read(text.data(), static_cast<std::streamsize>(count));
    return text;
  }
  // Reads a number of `size` bytes, low bytes first.
  std::uint64_t number(int size) {
    const std::string text = bytes(size);
    std::uint64_t value = 0;
    for (int i = size; i-- > 0;) value = value << 8 | static_cast<unsigned char>(text[i]);
    return value;
  }
  std::string text() { return bytes(number(4)); }

 private:
  std::ifstream stream_;
  std::uintmax_t left_;
};

}  // namespace

std::map<std::string, std::string> read_vdb_texts(const std::filesystem::path& path) {
  const std::uintmax_t length = require_file(path);
  try {
    Reader reader(path, length);
    std::map<std::string, std::string> texts;
    if (reader.number(8) != magic) {
      throw Error("'" + text_of(path) + "' is not an OpenVDB file; give one that is.");
    }
    if (reader.number(4) < oldest) return texts;
    // Skip the library's version, the flag for seekable grids, and the UUID.
    reader.bytes(4 + 4 + 1 + uuid_size);
    for (std::uint64_t count = reader.number(4); count > 0; --count) {
      const std::string name = reader.text(), type = reader.text(), value = reader.text();
      if (type == "string") texts[name] = value;
    }
    return texts;
  } catch (const std::ios::failure&) {
    throw Error("'" + text_of(path) +
                "' is not a readable OpenVDB file (it ends early); check that it is complete.");
  }
}

}  // namespace leaflight
