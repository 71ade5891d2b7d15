// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "bake/texels/checkpoint.h"

namespace leaflight {

// A bake under way in a file: a text that says which, its state, and a seal. It is read by the
// build that wrote it: the state has the layout of its numbers in memory. All throw Error.
void write_checkpoint(const std::filesystem::path& path, const std::string& text,
                      const Checkpoints::Write& write);

// The text, of a file that is whole.
std::string read_checkpoint(const std::filesystem::path& path);

// Reads the state of a file that read_checkpoint() has found whole. The file is closed afterwards:
// Windows replaces none that is open.
void read_checkpoint_state(const std::filesystem::path& path, const Checkpoints::Read& read);

}  // namespace leaflight
