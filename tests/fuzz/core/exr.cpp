// SPDX-License-Identifier: GPL-3.0-or-later
// Images that others made: read, and their comments.
#include "io/exr.h"

#include "input_file.h"
#include "said.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace leaflight;
  static const fuzz::InputFile file;
  file.write(data, size);
  fuzz::accepted([&] { read_exr_comments(file.path()); });
  fuzz::accepted([&] {
    const Image image = read_exr(file.path());
    fuzz::require(
        image.width > 0 && image.height > 0 &&
            image.pixels.size() == std::size_t(image.width) * image.height * image.channels,
        "pixels missing");
  });
  return 0;
}
