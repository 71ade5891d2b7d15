// SPDX-License-Identifier: GPL-3.0-or-later
// Reads checkpoint files; if the seal is right, also the text and the numbers of the state. No bake
// uses the numbers here: they come from the program that wrote the seal.
#include "bake/texels/checkpoint.h"

#include "base/sample_average.h"
#include "input_file.h"
#include "io/checkpoint_file.h"
#include "io/seal.h"
#include "said.h"

namespace {

// Largest number of items of the state, as in a small bake.
constexpr std::size_t most = 1000;

void read(const std::filesystem::path& path) {
  using namespace leaflight;
  const std::string text = read_checkpoint(path);
  fuzz::require(text.size() < std::filesystem::file_size(path), "more text than the file has");
  read_checkpoint_state(path, [](std::istream& stream) {
    Archive archive(stream);
    int number = 0;
    archive(number);
    for (int i = 0; i < 3; ++i) {
      std::vector<Average> items;
      archive(items, most);
      fuzz::require(items.size() <= most, "more items than there can be");
    }
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace leaflight;
  static const fuzz::InputFile file;
  file.write(data, size);
  const bool was_whole = check_seal(file.path()) == Seal::whole;
  const bool found = fuzz::accepted([&] { read(file.path()); });
  fuzz::require(was_whole || !found, "a checkpoint without its seal is accepted");
  seal(file.path());
  fuzz::accepted([&] { read(file.path()); });
  return 0;
}
