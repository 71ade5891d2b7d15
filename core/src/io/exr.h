// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace leaflight {

// Linear float pixels, top row first, with interleaved channels (3: RGB, 4: RGBA).
struct Image {
  int width = 0, height = 0, channels = 0;
  std::vector<float> pixels;
};

// Writes 32-bit float channels with ZIP compression. `comments`: EXR's attribute of that name.
// Replaces the file atomically. Throws Error.
void write_exr(const std::filesystem::path& path, const float* pixels, int width, int height,
               int channels, const std::string& comments = "");

// Reads the channels R, G, B and A, if present. Throws Error, also for images above 2^28 pixels.
Image read_exr(const std::filesystem::path& path);

// Returns an image's comments, or an empty text. Reads only its header. Throws Error.
std::string read_exr_comments(const std::filesystem::path& path);

}  // namespace leaflight
