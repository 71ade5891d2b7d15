// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace leaflight {

// Linear float pixels, top row first, `channels` interleaved values each (3: RGB, 4: RGBA).
struct Image {
  int width = 0, height = 0, channels = 0;
  std::vector<float> pixels;
};

// Writes 32-bit float channels, ZIP compressed, and comments as EXR's attribute of that name.
// The
// file is replaced as a whole. Throws Error.
void write_exr(const std::filesystem::path& path, const float* pixels, int width, int height,
               int channels, const std::string& comments = "");

// Reads the channels R, G, B and, where present, A. Throws Error, also for images above 2^28
// pixels.
Image read_exr(const std::filesystem::path& path);

// The comments of an image, empty without; reads its header alone. Throws Error.
std::string read_exr_comments(const std::filesystem::path& path);

}  // namespace leaflight
