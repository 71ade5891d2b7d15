// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/replaced_files.h"

#include <cerrno>
#include <fstream>
#include <random>
#include <set>

#include "base/error.h"
#include "base/platform.h"
#include "io/files.h"
#include "io/seal.h"

namespace leaflight {
namespace fs = std::filesystem;
namespace {

constexpr char prefix[] = ".leaflight-part-";

Error unwritable(const fs::path& target, const std::string& why) {
  return Error("'" + text_of(target) + "' cannot be written (" + brief(why) +
               "); check the folder's permissions and the free space.");
}

fs::path folder_of(const fs::path& target) {
  return target.has_parent_path() ? target.parent_path() : fs::path(".");
}

void check(const fs::path& target) {
  std::error_code failure;
  const fs::path folder = folder_of(target);
  if (!fs::is_directory(folder, failure)) {
    throw Error("The folder '" + text_of(folder) + "' for '" + text_of(target.filename()) +
                "' does not exist; create it or choose another.");
  }
  if (fs::is_directory(target, failure)) {
    throw Error("'" + text_of(target) + "' is a folder; choose a file name.");
  }
}

// Removes the temporary files of processes that have ended.
void remove_leftovers(const fs::path& folder) {
  std::error_code failure;
  std::vector<fs::path> left;
  for (fs::directory_iterator entry(folder, failure), end; !failure && entry != end;
       entry.increment(failure)) {
    if (entry->path().filename().native().compare(0, sizeof prefix - 1,
                                                  fs::path(prefix).native()) == 0 &&
        fs::is_directory(entry->symlink_status(failure))) {
      left.push_back(entry->path());
    }
  }
  for (const fs::path& part : left) {
    {
      const FolderHold hold(part, false);
      if (!hold.held()) continue;
      fs::remove_all(part, failure);
    }
    // Windows cannot remove a folder that is held.
    fs::remove(part, failure);
  }
}

std::string random_digits() {
  std::random_device device;
  std::string digits;
  for (int i = 0; i < 16; ++i) digits += "0123456789abcdef"[device() & 15];
  return digits;
}

}  // namespace

struct ReplacedFiles::Part {
  fs::path target, folder, file;
  std::unique_ptr<FolderHold> hold;

  explicit Part(const fs::path& path) : target(path) {
    for (int attempt = 0; attempt < 100; ++attempt) {
      folder = folder_of(target) / (prefix + random_digits());
      std::error_code failure;
      if (!fs::create_directory(folder, failure)) {
        if (failure) throw unwritable(target, failure.message());
        continue;
      }
      hold = std::make_unique<FolderHold>(folder, false);
      // Another process's remove_leftovers() may have removed the folder in between.
      if (!hold->refused() && fs::exists(folder, failure)) {
        file = folder / ("output" + target.extension().string());
        return;
      }
    }
    throw unwritable(target, "no temporary folder stays");
  }
  ~Part() {
    std::error_code failure;
    hold.reset();
    // Remove the file first: Windows' C library cannot list folders with paths above 260
    // characters.
    fs::remove(file, failure);
    if (!fs::remove(folder, failure)) fs::remove_all(folder, failure);
  }
};

ReplacedFiles::ReplacedFiles(const std::vector<fs::path>& targets) {
  for (const fs::path& target : targets) {
    check(target);
    remove_leftovers(folder_of(target));
    parts_.push_back(std::make_unique<Part>(target));
  }
}

ReplacedFiles::~ReplacedFiles() = default;

const fs::path& ReplacedFiles::temporary(std::size_t target) const { return parts_[target]->file; }

void ReplacedFiles::discard() { parts_.clear(); }

void ReplacedFiles::commit() {
  std::set<fs::path> folders;
  for (const auto& part : parts_) {
    if (const std::error_code failure = write_through(part->file)) {
      throw unwritable(part->target, failure.message());
    }
    folders.insert(folder_of(part->target));
  }
  // Hold all folders, so that several targets change together. The fixed order prevents deadlocks.
  std::vector<std::unique_ptr<FolderHold>> holds;
  for (const fs::path& folder : folders) {
    // One target needs no hold, and its writer may already hold its folder.
    if (parts_.size() > 1) holds.push_back(std::make_unique<FolderHold>(folder, true));
  }
  for (const auto& part : parts_) {
    if (const std::error_code failure = move_over(part->file, part->target)) {
      throw unwritable(part->target, failure.message());
    }
  }
  for (const fs::path& folder : folders) write_through(folder);
  discard();
}

namespace {

// A buffer that stores the cause of the first failed write, and throws Cancelled after a cancel.
class CheckedBuffer : public std::filebuf {
 public:
  explicit CheckedBuffer(const Progress* progress) : progress_(progress) { errno = 0; }

  std::string cause() const {
    const int number = failure_ ? failure_ : errno;
    return number ? std::generic_category().message(number) : "the system does not say why";
  }

 protected:
  std::streamsize xsputn(const char* text, std::streamsize count) override {
    if (progress_) progress_->check();
    const std::streamsize written = std::filebuf::xsputn(text, count);
    if (written < count) note();
    return written;
  }
  int_type overflow(int_type c) override {
    const int_type result = std::filebuf::overflow(c);
    if (result == traits_type::eof()) note();
    return result;
  }

 private:
  void note() {
    if (failure_ == 0) failure_ = errno;
  }

  const Progress* progress_;
  int failure_ = 0;
};

}  // namespace

void replace_file(const fs::path& target, const std::function<void(std::ostream&)>& write,
                  const Progress* progress, bool sealed) {
  ReplacedFiles files({target});
  CheckedBuffer buffer(progress);
  std::ostream stream(&buffer);
  if (!buffer.open(files.temporary(0), std::ios::out | std::ios::binary)) {
    throw unwritable(target, buffer.cause());
  }
  try {
    stream.exceptions(std::ios::failbit | std::ios::badbit);
    write(stream);
    stream.flush();
  } catch (const Error&) {
    throw;
  } catch (const Cancelled&) {
    throw;
  } catch (const std::ios::failure&) {
    throw unwritable(target, buffer.cause());
  } catch (const std::exception& problem) {
    if (progress) progress->check();
    throw unwritable(target, stream ? problem.what() : buffer.cause());
  }
  if (!stream || !buffer.close()) throw unwritable(target, buffer.cause());
  if (sealed) {
    try {
      seal(files.temporary(0));
    } catch (const Error& problem) {
      throw unwritable(target, problem.what());
    }
  }
  if (progress) progress->check();
  files.commit();
}

}  // namespace leaflight
