// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/exr.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfThreading.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <mutex>
#include <thread>

#include "base/error.h"
#include "io/files.h"
#include "io/replaced_files.h"

namespace leaflight {
namespace {

constexpr std::array<const char*, 4> channel_names{"R", "G", "B", "A"};

// Level of ZIP. Noise hardly compresses, so files are 3 % larger than at the default level of 4,
// and written 1.5 times as fast.
constexpr int zip_level = 1;

// OpenEXR's threads while a file is written, unless the program has its own. They end with it: a
// process that is forked later would wait for them forever.
class Threads {
 public:
  Threads() : lock_(mutex_), ours_(Imf::globalThreadCount() == 0) {
    if (ours_) Imf::setGlobalThreadCount(static_cast<int>(std::thread::hardware_concurrency()));
  }
  ~Threads() {
    if (ours_) Imf::setGlobalThreadCount(0);
  }
  Threads(const Threads&) = delete;
  Threads& operator=(const Threads&) = delete;

 private:
  static inline std::mutex mutex_;
  std::lock_guard<std::mutex> lock_;
  bool ours_;
};

// Upper bounds on a read. The rows suffice for the blocks of any compression. The values limit
// memory for long rows, which a damaged file may claim.
constexpr std::int64_t most_rows_at_once = 256, most_values_at_once = 1 << 25;

// `is_gray`: the first channel is Y.
Imf::FrameBuffer frame_buffer(float* pixels, const Imath::Box2i& window, int channels,
                              bool is_gray = false) {
  const std::size_t width = window.max.x - window.min.x + 1;
  const std::size_t x_stride = channels * sizeof(float), y_stride = width * x_stride;
  Imf::FrameBuffer buffer;
  for (int c = 0; c < channels; ++c) {
    buffer.insert(is_gray && c == 0 ? "Y" : channel_names[c],
                  Imf::Slice::Make(Imf::FLOAT, pixels + c, window, x_stride, y_stride, 1, 1,
                                   c == 3 ? 1.0 : 0.0));
  }
  return buffer;
}

// A stream that reports failures at the end of the file, which OpenEXR's own stream ignores.
class Stream : public Imf::OStream {
 public:
  explicit Stream(std::ostream& stream) : OStream("output"), stream_(stream) {}
  void write(const char text[], int count) override { stream_.write(text, count); }
  std::uint64_t tellp() override { return static_cast<std::uint64_t>(stream_.tellp()); }
  void seekp(std::uint64_t place) override {
    stream_.seekp(static_cast<std::ostream::pos_type>(place));
  }

 private:
  std::ostream& stream_;
};

}  // namespace

void write_exr(const std::filesystem::path& path, const float* pixels, int width, int height,
               int channels, const std::string& comments) {
  if (width < 1 || height < 1 || channels < 3 || channels > 4) {
    throw Error("An image of " + std::to_string(width) + " x " + std::to_string(height) + " with " +
                std::to_string(channels) + " channels cannot be written as EXR; give RGB or RGBA.");
  }
  replace_file(path, [&](std::ostream& stream) {
    // OpenEXR's destructors also write and must not throw, so the stream's state reports failures.
    stream.exceptions(std::ios::goodbit);
    Imf::Header header(width, height);
    header.compression() = Imf::ZIP_COMPRESSION;
    header.zipCompressionLevel() = zip_level;
    if (!comments.empty()) Imf::addComments(header, comments);
    for (int c = 0; c < channels; ++c) {
      header.channels().insert(channel_names[c], Imf::Channel(Imf::FLOAT));
    }
    const Threads threads;
    Stream out(stream);
    Imf::OutputFile file(out, header);
    file.setFrameBuffer(frame_buffer(const_cast<float*>(pixels), header.dataWindow(), channels));
    file.writePixels(height);
  });
}

namespace {

// Checks the sizes in the header, because OpenEXR allocates them before it checks the file's
// length.
void check_header(const std::filesystem::path& path) {
  constexpr std::uint32_t several_parts = 0x1000;
  const auto end = static_cast<std::int64_t>(std::filesystem::file_size(path));
  std::ifstream file(path, std::ios::binary);
  std::uint32_t magic = 0, version = 0;
  const auto read = [&](auto& number) {
    file.read(reinterpret_cast<char*>(&number), sizeof number);
  };
  read(magic), read(version);
  for (bool more = true; more && file;) {
    more = false;
    std::string name, type;
    while (std::getline(file, name, '\0') && !name.empty()) {
      std::getline(file, type, '\0');
      std::int32_t size = 0;
      read(size);
      if (!file || size < 0 || size > end - file.tellg()) {
        throw Error("'" + text_of(path) +
                    "' is not a readable EXR image (its header ends early); " +
                    "check that it is complete.");
      }
      file.seekg(size, std::ios::cur);
      more = (version & several_parts) != 0;
    }
  }
}

// Calls read(file) and converts OpenEXR's exceptions to one sentence.
template <class Read>
auto read_image_file(const std::filesystem::path& path, const Read& read) {
  require_file(path);
  check_header(path);
  try {
    Imf::InputFile file(path.string().c_str());
    return read(file);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& problem) {
    throw Error("'" + text_of(path) + "' is not a readable EXR image (" + brief(problem.what()) +
                "); check that it is complete.");
  }
}

}  // namespace

Image read_exr(const std::filesystem::path& path) {
  return read_image_file(path, [&](Imf::InputFile& file) {
    const Imath::Box2i window = file.header().dataWindow();
    const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
    const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
    if (width < 1 || height < 1 || width * height > (std::int64_t{1} << 28)) {
      throw Error("The image '" + text_of(path) + "' claims " + std::to_string(width) + " x " +
                  std::to_string(height) + " pixels; give one of at most 2^28 pixels.");
    }
    Image image;
    image.width = static_cast<int>(width);
    image.height = static_cast<int>(height);
    const Imf::ChannelList& channels = file.header().channels();
    const auto has = [&](const char* name) { return channels.findChannel(name) != nullptr; };
    const bool is_gray = !has("R") && !has("G") && !has("B") && has("Y");
    if (!is_gray && !(has("R") && has("G") && has("B"))) {
      std::string names;
      for (auto each = channels.begin(); each != channels.end(); ++each) {
        names += (names.empty() ? "" : ", ") + std::string(each.name());
      }
      throw Error("The image '" + text_of(path) + "' has the channels " + names +
                  "; save it with R, G and B, or with Y.");
    }
    image.channels = has("A") ? 4 : 3;
    // Grow the pixels as rows arrive, because a damaged file can claim more rows than it has.
    const std::size_t row = static_cast<std::size_t>(width) * image.channels;
    image.pixels.reserve(row * static_cast<std::size_t>(height));
    const std::int64_t rows_at_once = std::clamp(
        most_values_at_once / static_cast<std::int64_t>(row), std::int64_t{1}, most_rows_at_once);
    for (std::int64_t begin = 0; begin < height; begin += rows_at_once) {
      const std::int64_t end = std::min(begin + rows_at_once, height);
      image.pixels.resize(row * static_cast<std::size_t>(end));
      file.setFrameBuffer(frame_buffer(image.pixels.data(), window, image.channels, is_gray));
      file.readPixels(static_cast<int>(window.min.y + begin),
                      static_cast<int>(window.min.y + end - 1));
    }
    if (is_gray) {
      for (std::size_t i = 0; i < image.pixels.size(); i += image.channels) {
        image.pixels[i + 1] = image.pixels[i + 2] = image.pixels[i];
      }
    }
    return image;
  });
}

std::string read_exr_comments(const std::filesystem::path& path) {
  return read_image_file(path, [](Imf::InputFile& file) {
    return Imf::hasComments(file.header()) ? Imf::comments(file.header()) : std::string();
  });
}

}  // namespace leaflight
