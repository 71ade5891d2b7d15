// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/seal.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <vector>

#include "base/error.h"
#include "io/files.h"

namespace leaflight {
namespace {

// The seal has this mark, then 8 bytes for the length before it and 4 for the CRC-32, low bytes
// first.
constexpr std::array<char, 12> mark{'L', 'e', 'a', 'f', 'l', 'i', 'g', 'h', 't', '\x1a', 'e', '1'};
constexpr std::size_t size = mark.size() + 12;
using Bytes = std::array<char, size>;

Bytes seal_of(std::uint64_t length, std::uint32_t checksum) {
  Bytes bytes{};
  std::copy(mark.begin(), mark.end(), bytes.begin());
  for (int i = 0; i < 8; ++i) bytes[12 + i] = static_cast<char>(length >> (8 * i));
  for (int i = 0; i < 4; ++i) bytes[20 + i] = static_cast<char>(checksum >> (8 * i));
  return bytes;
}

std::uint32_t checksum(std::istream& stream, std::uint64_t length) {
  std::vector<char> block(std::min<std::uint64_t>(length, 1 << 20));
  uLong sum = crc32(0, nullptr, 0);
  while (length > 0) {
    const std::uint64_t part = std::min<std::uint64_t>(length, block.size());
    stream.read(block.data(), static_cast<std::streamsize>(part));
    sum = crc32(sum, reinterpret_cast<const Bytef*>(block.data()), static_cast<uInt>(part));
    length -= part;
  }
  return static_cast<std::uint32_t>(sum);
}

}  // namespace

void seal(const std::filesystem::path& path) {
  try {
    std::fstream stream;
    stream.exceptions(std::ios::failbit | std::ios::badbit);
    stream.open(path, std::ios::binary | std::ios::in | std::ios::out);
    const std::uint64_t length = std::filesystem::file_size(path);
    const Bytes bytes = seal_of(length, checksum(stream, length));
    stream.seekp(0, std::ios::end);
    stream.write(bytes.data(), bytes.size());
    stream.close();
  } catch (const std::ios::failure&) {
    throw Error(std::generic_category().message(errno));
  }
}

bool has_seal(const std::filesystem::path& path) {
  const std::uintmax_t length = require_file(path);
  std::ifstream stream(path, std::ios::binary);
  Bytes found{};
  if (length < size) return false;
  stream.seekg(static_cast<std::streamoff>(length - size));
  stream.read(found.data(), size);
  return std::equal(mark.begin(), mark.end(), found.begin());
}

Seal check_seal(const std::filesystem::path& path) {
  if (!has_seal(path)) return Seal::none;
  const std::uintmax_t length = std::filesystem::file_size(path) - size;
  try {
    std::ifstream stream;
    stream.exceptions(std::ios::failbit | std::ios::badbit);
    stream.open(path, std::ios::binary);
    const Bytes right = seal_of(length, checksum(stream, length));
    Bytes found;
    stream.read(found.data(), size);
    return found == right ? Seal::whole : Seal::broken;
  } catch (const std::ios::failure&) {
    throw Error("The file '" + text_of(path) + "' cannot be read to its end; check its disk.");
  }
}

}  // namespace leaflight
