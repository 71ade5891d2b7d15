// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <ostream>
#include <vector>

#include "math/progress.h"

namespace leaflight {

// Files that are written beside their targets and take their places all at once, when they are
// whole and on the disk: neither a full disk, nor a crash, nor a power cut leaves half a file under
// a final name, or loses the file that had it before.
//
// Each is written in a folder of its own beside its target, which its owner holds: what killed
// processes left differs so from what others are writing, and the next writer into the same folder
// removes it. Of two that write the same targets the last to finish wins, with all of them.
class ReplacedFiles {
 public:
  // Throws Error where a target's folder is missing or cannot be written to, or it is a folder.
  explicit ReplacedFiles(const std::vector<std::filesystem::path>& targets);
  // What was not committed is gone.
  ~ReplacedFiles();
  ReplacedFiles(const ReplacedFiles&) = delete;
  ReplacedFiles& operator=(const ReplacedFiles&) = delete;

  // Where to write the file of a target: of the same suffix.
  const std::filesystem::path& temporary(std::size_t target) const;
  // Throws Error, with every target as it was unless the system lets some be renamed only.
  void commit();
  void discard();

 private:
  struct Part;
  std::vector<std::unique_ptr<Part>> parts_;
};

// Replaces one file by what write(stream) writes into a binary stream that throws on failure. Where
// libraries keep such an exception to themselves, the state of the stream is looked at. Throws
// Error, and Cancelled with the target as it was, as long as it is not written. sealed: whether
// the file ends with a seal.
void replace_file(const std::filesystem::path& target,
                  const std::function<void(std::ostream&)>& write,
                  const Progress* progress = nullptr, bool sealed = false);

}  // namespace leaflight
