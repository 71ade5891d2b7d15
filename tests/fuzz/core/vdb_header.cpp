// SPDX-License-Identifier: GPL-3.0-or-later
// The header of any .vdb, which is read without OpenVDB.
#include "io/vdb_header.h"

#include "input_file.h"
#include "io/bake_file.h"
#include "said.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace leaflight;
  static const fuzz::InputFile file;
  file.write(data, size);
  fuzz::accepted([&] {
    std::size_t length = 0;
    for (const auto& [name, text] : read_vdb_texts(file.path())) {
      length += name.size() + text.size();
    }
    fuzz::require(length <= size, "more text than the file has");
    read_bake_header(file.path());
  });
  return 0;
}
