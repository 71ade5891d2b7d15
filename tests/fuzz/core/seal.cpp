// SPDX-License-Identifier: GPL-3.0-or-later
// The seal of any file, and that it detects every change of a byte.
#include "io/seal.h"

#include "bytes.h"
#include "input_file.h"
#include "said.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace leaflight;
  static const fuzz::InputFile file;
  file.write(data, size);
  fuzz::accepted([&] {
    fuzz::require(has_seal(file.path()) == (check_seal(file.path()) != Seal::none),
                  "a seal and none");
  });
  seal(file.path());
  fuzz::require(check_seal(file.path()) == Seal::whole, "its own seal is broken");
  // The first bytes say which one is changed, and how.
  fuzz::Bytes bytes(data, size);
  const auto place = bytes.take<std::uint32_t>() % std::filesystem::file_size(file.path());
  const int change = 1 + bytes.choice(255);
  std::fstream stream(file.path(), std::ios::binary | std::ios::in | std::ios::out);
  stream.seekg(static_cast<std::streamoff>(place));
  const int byte = stream.get();
  stream.seekp(static_cast<std::streamoff>(place));
  stream.put(static_cast<char>(byte ^ change));
  stream.close();
  fuzz::require(check_seal(file.path()) != Seal::whole, "a change of a byte is not seen");
  return 0;
}
