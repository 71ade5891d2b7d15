// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <ostream>
#include <vector>

#include "base/progress.h"

namespace leaflight {

// Temporary files that replace their targets together when they are complete and on the disk. A
// full disk, a crash or a power cut never leaves half a file under a final name, or loses the old
// file. Each file is in its own folder next to its target, which its owner holds. So the next
// writer can recognize and remove leftovers of killed processes. If two writers have the same
// targets, the last to finish wins for all of them.
class ReplacedFiles {
 public:
  // Throws Error if a target's folder is missing or not writable, or if the target is a folder.
  explicit ReplacedFiles(const std::vector<std::filesystem::path>& targets);
  // Removes all files that were not committed.
  ~ReplacedFiles();
  ReplacedFiles(const ReplacedFiles&) = delete;
  ReplacedFiles& operator=(const ReplacedFiles&) = delete;

  // Returns the temporary path of a target, with the same suffix.
  const std::filesystem::path& temporary(std::size_t target) const;
  // Replaces all targets. Throws Error, with all targets unchanged unless the system renames only
  // some.
  void commit();
  void discard();

 private:
  struct Part;
  std::vector<std::unique_ptr<Part>> parts_;
};

// Replaces a file by the output of write(stream). The binary stream throws on failure; its state is
// also checked, in case a library hides the exception. Throws Error. Throws Cancelled, with the
// target unchanged, if cancelled during the write. sealed: appends a seal.
void replace_file(const std::filesystem::path& target,
                  const std::function<void(std::ostream&)>& write,
                  const Progress* progress = nullptr, bool sealed = false);

}  // namespace leaflight
