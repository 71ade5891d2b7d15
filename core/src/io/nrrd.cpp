// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/io/nrrd.h"

#include <teem/nrrd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>

#include "leaflight/io/files.h"
#include "leaflight/math/error.h"

namespace leaflight {
namespace {

namespace fs = std::filesystem;

struct NrrdDeleter {
  void operator()(Nrrd* nrrd) const { nrrdNuke(nrrd); }
};
using NrrdPointer = std::unique_ptr<Nrrd, NrrdDeleter>;

struct IoStateDeleter {
  void operator()(NrrdIoState* io) const { nrrdIoStateNix(io); }
};

std::string teem_error() {
  const std::unique_ptr<char, decltype(&std::free)> message(biffGetDone(NRRD), &std::free);
  const std::string text(message ? message.get() : "");
  // Teem prints a trace, the cause last.
  const std::size_t end = text.find_last_not_of('\n');
  if (end == std::string::npos) return "unknown cause";
  const std::size_t begin = text.rfind('\n', end);
  return brief(text.substr(begin == std::string::npos ? 0 : begin + 1, end + 1));
}

// The value of a header field, or empty.
std::string header_field(const std::string& path, const std::string& name) {
  std::ifstream file(path, std::ios::binary);
  std::string line;
  for (int i = 0; i < 1000 && std::getline(file, line); ++i) {
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    if (line.empty()) break;
    std::string key = line.substr(0, line.find(':'));
    for (char& c : key) c = static_cast<char>(std::tolower(c));
    if (key != name || line.find(':') == std::string::npos) continue;
    const std::size_t value = line.find_first_not_of(" =", line.find(':') + 1);
    return value == std::string::npos ? "" : line.substr(value);
  }
  return "";
}

// The size of the file that holds the data. A header from elsewhere must not make us open files
// outside its own folder.
std::uintmax_t data_size(const std::string& path) {
  std::string data = header_field(path, "data file");
  if (data.empty()) data = header_field(path, "datafile");
  if (data.empty()) return require_file(path);
  if (data.rfind("LIST", 0) == 0 || data.find('%') != std::string::npos) {
    throw Error("'" + path +
                "' spreads its data over several files, which is not supported; join " +
                "them into one.");
  }
  const fs::path relative(data);
  bool leaves_folder = relative.is_absolute();
  for (const auto& part : relative) leaves_folder |= part == "..";
  if (leaves_folder) {
    throw Error("'" + path + "' refers to the data file '" + data +
                "' outside its own folder; move the data file beside the header.");
  }
  return require_file((fs::path(path).parent_path() / relative).string());
}

std::string shape(const Nrrd& nrrd) {
  std::string text;
  for (unsigned a = 0; a < nrrd.dim; ++a) {
    text += (a ? " x " : "") + std::to_string(nrrd.axis[a].size);
  }
  return text;
}

void check_header(const Nrrd& nrrd, const std::string& path) {
  if (nrrd.dim != 3) {
    throw Error("'" + path + "' has the shape " + shape(nrrd) +
                ", but a scalar volume with three axes is needed; extract one component or frame.");
  }
  if (nrrd.type == nrrdTypeBlock) {
    throw Error("'" + path + "' holds blocks of bytes, not numbers; convert it to a scalar type.");
  }
  unsigned long long bytes = nrrdElementSize(&nrrd);
  for (unsigned a = 0; a < 3; ++a) {
    const unsigned long long size = nrrd.axis[a].size;
    if (size > 1u << 16 ||
        (size && bytes > std::numeric_limits<unsigned long long>::max() / size)) {
      throw Error("'" + path + "' claims the impossible size " + shape(nrrd) +
                  "; check that the file is complete.");
    }
    bytes *= size;
  }
  const std::string encoding = header_field(path, "encoding");
  // Deflate and bzip2 of runs reach these ratios at most; text needs two characters a number.
  const double most_ratio = encoding.rfind("gz", 0) == 0  ? 1032
                            : encoding.rfind("b", 0) == 0 ? 1e5
                                                          : 8;
  const std::uintmax_t have = data_size(path);
  if (static_cast<double>(bytes) > most_ratio * static_cast<double>(have) ||
      (encoding == "raw" && bytes > have)) {
    throw Error("'" + path + "' claims " + shape(nrrd) + " voxels (" + std::to_string(bytes) +
                " bytes), but its data are only " + std::to_string(have) +
                " bytes; the file is truncated or damaged.");
  }
}

Affine<3> index_to_world(const Nrrd& nrrd) {
  Affine<3> m;
  const bool oriented = nrrd.spaceDim == 3 && std::isfinite(nrrd.axis[0].spaceDirection[0]);
  for (int a = 0; a < 3; ++a) {
    m.column[a] = Vec3(0.0);
    if (oriented) {
      for (int i = 0; i < 3; ++i) m.column[a][i] = nrrd.axis[a].spaceDirection[i];
    } else {
      const double spacing = std::abs(nrrd.axis[a].spacing);
      m.column[a][a] = std::isfinite(spacing) && spacing > 0 ? spacing : 1;
    }
    if (oriented && std::isfinite(nrrd.spaceOrigin[a])) m.origin[a] = nrrd.spaceOrigin[a];
  }
  const auto flip = [&](int axis) {
    for (int a = 0; a < 3; ++a) m.column[a][axis] = -m.column[a][axis];
    m.origin[axis] = -m.origin[axis];
  };
  if (nrrd.space == nrrdSpaceLeftPosteriorSuperior) flip(0), flip(1);
  if (nrrd.space == nrrdSpaceLeftAnteriorSuperior) flip(0);
  return m;
}

NrrdPointer load(const std::string& path, bool header_only) {
  NrrdPointer nrrd(nrrdNew());
  const std::unique_ptr<NrrdIoState, IoStateDeleter> io(nrrdIoStateNew());
  nrrdIoStateSet(io.get(), nrrdIoStateSkipData, header_only);
  if (nrrdLoad(nrrd.get(), path.c_str(), io.get())) {
    throw Error("'" + path + "' is not a readable NRRD file (" + teem_error() +
                "); check that it is complete.");
  }
  return nrrd;
}

}  // namespace

DenseVolume read_nrrd(const std::string& path) {
  require_file(path);
  data_size(path);
  check_header(*load(path, true), path);
  const NrrdPointer raw = load(path, false);
  DenseVolume volume;
  std::size_t voxels = 1;
  for (int a = 0; a < 3; ++a) {
    volume.dims[a] = static_cast<int>(raw->axis[a].size);
    voxels *= raw->axis[a].size;
  }
  volume.index_to_world = index_to_world(*raw);
  volume.name = fs::path(path).stem().string();
  const NrrdPointer converted(nrrdNew());
  if (nrrdConvert(converted.get(), raw.get(), nrrdTypeFloat)) {
    throw Error("The values of '" + path + "' cannot be converted (" + teem_error() +
                "); store them as a scalar type.");
  }
  const auto* values = static_cast<const float*>(converted->data);
  volume.values.assign(values, values + voxels);
  return volume;
}

}  // namespace leaflight
