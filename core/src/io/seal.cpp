// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/seal.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
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

// Returns the checksum of the first bytes of a file. Parts are read in parallel.
std::uint32_t checksum(const std::filesystem::path& path, std::uint64_t length) {
  constexpr std::uint64_t part = 4 << 20;
  std::vector<std::uint32_t> sums((length + part - 1) / part);
  const auto size_of = [&](std::size_t p) { return std::min(part, length - p * part); };
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, sums.size(), 8),
      [&](const auto& range) {
        std::ifstream stream;
        stream.exceptions(std::ios::failbit | std::ios::badbit);
        stream.open(path, std::ios::binary);
        stream.seekg(static_cast<std::streamoff>(range.begin() * part));
        std::vector<char> bytes(size_of(range.begin()));
        for (std::size_t p = range.begin(); p < range.end(); ++p) {
          stream.read(bytes.data(), static_cast<std::streamsize>(size_of(p)));
          sums[p] = static_cast<std::uint32_t>(crc32(
              0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(size_of(p))));
        }
      },
      tbb::simple_partitioner{});
  uLong sum = crc32(0, nullptr, 0);
  for (std::size_t p = 0; p < sums.size(); ++p) {
    sum = crc32_combine(sum, sums[p], static_cast<z_off_t>(size_of(p)));
  }
  return static_cast<std::uint32_t>(sum);
}

}  // namespace

void seal(const std::filesystem::path& path) {
  try {
    const std::uint64_t length = std::filesystem::file_size(path);
    const Bytes bytes = seal_of(length, checksum(path, length));
    std::fstream stream;
    stream.exceptions(std::ios::failbit | std::ios::badbit);
    stream.open(path, std::ios::binary | std::ios::in | std::ios::out);
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

std::uint64_t length_without_seal(const std::filesystem::path& path, bool sealed) {
  return std::filesystem::file_size(path) - (sealed ? size : 0);
}

Seal check_seal(const std::filesystem::path& path) {
  if (!has_seal(path)) return Seal::none;
  const std::uint64_t length = length_without_seal(path, true);
  try {
    const Bytes right = seal_of(length, checksum(path, length));
    std::ifstream stream;
    stream.exceptions(std::ios::failbit | std::ios::badbit);
    stream.open(path, std::ios::binary);
    stream.seekg(static_cast<std::streamoff>(length));
    Bytes found;
    stream.read(found.data(), size);
    return found == right ? Seal::whole : Seal::broken;
  } catch (const std::ios::failure&) {
    throw Error("The file '" + text_of(path) + "' cannot be read to its end; check its disk.");
  }
}

}  // namespace leaflight
