// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "bake/texels/checkpoint.h"

namespace leaflight {

// Writes the checkpoint of a bake: a text that identifies it, its state, and a seal. Only the same
// build can read it, because the state has the layout of numbers in memory. All functions throw
// Error.
void write_checkpoint(const std::filesystem::path& path, const std::string& text,
                      const Checkpoints::Write& write);

// Returns the text, after a check that the file is complete.
std::string read_checkpoint(const std::filesystem::path& path);

// Reads the state of a file that read_checkpoint() has checked. Closes the file, because Windows
// cannot replace open files.
void read_checkpoint_state(const std::filesystem::path& path, const Checkpoints::Read& read);

}  // namespace leaflight
