// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/checkpoint_file.h"

#include <fstream>

#include "io/files.h"
#include "io/replaced_files.h"
#include "io/seal.h"

namespace leaflight {
namespace {

const std::string first_line = "Leaflight checkpoint 1\n";

Error damaged(const std::filesystem::path& path) {
  return Error("'" + text_of(path) + "' is not a checkpoint, or is damaged; bake again.");
}

// Returns the text; the stream is then at the start of the state.
std::string read_text(std::istream& stream, const std::filesystem::path& path) {
  std::string found(first_line.size(), '\0');
  std::uint64_t length = 0;
  stream.read(found.data(), static_cast<std::streamsize>(found.size()));
  stream.read(reinterpret_cast<char*>(&length), sizeof length);
  if (found != first_line || length > std::filesystem::file_size(path)) throw damaged(path);
  std::string text(length, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(length));
  return text;
}

template <class Read>
auto read_checkpoint_file(const std::filesystem::path& path, const Read& read) {
  try {
    std::ifstream stream;
    stream.exceptions(std::ios::failbit | std::ios::badbit);
    stream.open(path, std::ios::binary);
    return read(stream);
  } catch (const std::ios::failure&) {
    throw damaged(path);
  }
}

}  // namespace

void write_checkpoint(const std::filesystem::path& path, const std::string& text,
                      const Checkpoints::Write& write) {
  const auto all = [&](std::ostream& stream) {
    const std::uint64_t length = text.size();
    stream << first_line;
    stream.write(reinterpret_cast<const char*>(&length), sizeof length);
    stream << text;
    write(stream);
  };
  replace_file(path, all, nullptr, true);
}

std::string read_checkpoint(const std::filesystem::path& path) {
  if (check_seal(path) != Seal::whole) throw damaged(path);
  return read_checkpoint_file(path, [&](std::istream& stream) { return read_text(stream, path); });
}

void read_checkpoint_state(const std::filesystem::path& path, const Checkpoints::Read& read) {
  read_checkpoint_file(path, [&](std::istream& stream) {
    read_text(stream, path);
    read(stream);
    return 0;
  });
}

}  // namespace leaflight
