// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "leaflight/bake/bake.h"
#include "leaflight/io/exr.h"
#include "leaflight/io/files.h"
#include "leaflight/io/nrrd.h"
#include "leaflight/io/vdb.h"
#include "leaflight/math/error.h"
#include "scenes.h"

namespace leaflight {
namespace {

namespace fs = std::filesystem;

class Files : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::path(testing::TempDir()) /
        ("leaflight_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void write(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
  }
  std::size_t count() const {
    return std::distance(fs::directory_iterator(folder_), fs::directory_iterator());
  }

  fs::path folder_;
};

template <class Call>
std::string message_of(Call call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

Baked<3> small_bake(const Scene<3>& scene) {
  BakeSettings<3> settings;
  settings.samples = 4;
  settings.photons = 10'000;
  settings.resolution = {15, 20, 17};
  Progress progress;
  return bake(scene, settings, progress);
}

TEST_F(Files, BakeComesBack) {
  Field<3> whole = test::ball<3>(17);
  std::vector<float> values(whole.values, whole.values + whole.voxels());
  values[whole.offset({1, 2, 3})] = std::nanf("");
  Affine<3> skewed = whole.index_to_world;
  skewed.column[1] += Vec3(0.01, 0, 0.02);
  skewed.origin = Vec3(-5, 2, 300);
  Scene<3> scene =
      test::cornell(test::field_from<3>(values, whole.dims, whole.index_to_world), {0.6, 0.9});
  const Baked<3> baked = small_bake(scene);
  const RadianceGrid<3>& grid = baked.grids[0];
  const Field<3> field = test::field_from<3>(values, whole.dims, skewed);
  write_bake(path("a.vdb"), {&field}, baked,
             {{"name", "ball"}, {"settings", "{}"}, {"statistics", "42 s"}});
  EXPECT_EQ(count(), 1u) << "no temporary file is left";

  const StoredBake stored = read_bake(path("a.vdb"));
  const RadianceGrid<3>& again = stored.baked.grids[0];
  EXPECT_EQ(stored.metadata.at("name"), "ball");
  EXPECT_EQ(stored.metadata.at("statistics"), "42 s");
  EXPECT_EQ(stored.fields[0].dims, field.dims);
  for (std::size_t v = 0; v < values.size(); ++v) {
    if (std::isnan(values[v])) {
      EXPECT_TRUE(std::isnan(stored.fields[0].values[v]));
    } else {
      ASSERT_EQ(stored.fields[0].values[v], values[v]);
    }
  }
  EXPECT_LT((stored.fields[0].index_to_world.point({3, 4, 5}) - skewed.point({3, 4, 5})).length(),
            1e-9);
  EXPECT_EQ(again.lattice.active, grid.lattice.active);
  EXPECT_EQ(again.lattice.resolution, grid.lattice.resolution);
  for (std::size_t s = 0; s < grid.radiance.size(); ++s) {
    for (int k = 0; k < 3; ++k) {
      // Half precision on disk.
      ASSERT_NEAR(again.radiance[s][k], grid.radiance[s][k], grid.radiance[s][k] / 2000 + 1e-7);
    }
  }
  EXPECT_NEAR(lookup(again.lattice, again.radiance, {8, 8, 12.5}).y,
              lookup(grid.lattice, grid.radiance, {8, 8, 12.5}).y, 2e-3);
}

TEST_F(Files, VdbVolumeComesBack) {
  const Scene<3> scene = test::cornell(test::ball<3>(17), {0.6, 0.9});
  write_bake(path("a.vdb"), {&test::field_of(scene)}, small_bake(scene), {});
  const DenseVolume volume = read_vdb_volume(path("a.vdb"), "field");
  EXPECT_EQ(volume.dims, test::field_of(scene).dims);
  EXPECT_EQ(volume.values[volume.values.size() / 2],
            test::field_of(scene).values[volume.values.size() / 2]);
  EXPECT_NE(message_of([&] { read_vdb_volume(path("a.vdb"), "smoke"); }).find("no grid 'smoke'"),
            std::string::npos);
  EXPECT_NE(message_of([&] { read_vdb_volume(path("a.vdb"), "radiance"); }).find("scalars"),
            std::string::npos);
}

TEST_F(Files, DamagedVdbIsRefused) {
  const Scene<3> scene = test::cornell(test::ball<3>(17), {0.6, 0.9});
  write_bake(path("a.vdb"), {&test::field_of(scene)}, small_bake(scene), {});
  const std::uintmax_t size = fs::file_size(path("a.vdb"));
  for (const double kept : {0.999, 0.9, 0.5, 0.1, 0.01}) {
    fs::resize_file(path("a.vdb"), static_cast<std::uintmax_t>(kept * static_cast<double>(size)));
    EXPECT_NE(message_of([&] { read_bake(path("a.vdb")); }).find("a.vdb"), std::string::npos)
        << kept;
  }
  write("b.vdb", "this is no VDB file at all");
  EXPECT_NE(message_of([&] { read_bake(path("b.vdb")); }).find("OpenVDB"), std::string::npos);
  EXPECT_NE(message_of([&] { read_bake(path("none.vdb")); }).find("no file"), std::string::npos);
}

TEST_F(Files, FailedWriteLeavesNothing) {
  EXPECT_NE(message_of([&] {
              write_atomically(path("x.bin"), [](const std::string& temporary) {
                std::ofstream(temporary) << "half";
                throw std::runtime_error("disk on fire\nsecond line");
              });
            }).find("disk on fire)"),
            std::string::npos);
  EXPECT_EQ(count(), 0u);
  EXPECT_NE(message_of([&] {
              write_atomically(path("no/x"), [](const std::string&) {});
            }).find("does not exist"),
            std::string::npos);
}

TEST_F(Files, ExrComesBack) {
  std::vector<float> pixels;
  for (int i = 0; i < 5 * 3 * 4; ++i) pixels.push_back(1e-3f + 100.0f * i);
  write_exr(path("i.exr"), pixels.data(), 5, 3, 4);
  const Image image = read_exr(path("i.exr"));
  EXPECT_EQ(image.width, 5);
  EXPECT_EQ(image.height, 3);
  EXPECT_EQ(image.channels, 4);
  EXPECT_EQ(image.pixels, pixels);
  write("j.exr", "nothing");
  EXPECT_NE(message_of([&] { read_exr(path("j.exr")); }).find("EXR"), std::string::npos);
}

std::string nrrd_header(const std::string& sizes, const std::string& more) {
  return "NRRD0004\ntype: short\ndimension: 3\nsizes: " + sizes +
         "\nendian: little\nencoding: raw\n" + more;
}

TEST_F(Files, NrrdIsRead) {
  std::string data;
  for (int i = 0; i < 24; ++i) data += {static_cast<char>(i), static_cast<char>(i == 5 ? -1 : 0)};
  write("a.nrrd", nrrd_header("4 3 2",
                              "space: left-posterior-superior\nspace directions: (2,0,0) (0,3,0) "
                              "(0,0,4)\nspace origin: (10,20,30)\n\n") +
                      data);
  const DenseVolume volume = read_nrrd(path("a.nrrd"));
  EXPECT_EQ(volume.dims, (Index<3>{4, 3, 2}));
  EXPECT_EQ(volume.values[7], 7);
  EXPECT_EQ(volume.values[5], 5 - 256);
  // Left-posterior-superior becomes right-anterior-superior.
  EXPECT_LT((volume.index_to_world.point({1, 1, 1}) - Vec3(-12, -23, 34)).length(), 1e-12);

  write("d.raw", data);
  write("b.nhdr", nrrd_header("4 3 2", "data file: d.raw\n"));
  EXPECT_EQ(read_nrrd(path("b.nhdr")).values[7], 7);
}

TEST_F(Files, BadNrrdIsRefused) {
  const auto refused = [&](const std::string& name) {
    return message_of([&] { read_nrrd(path(name)); });
  };
  write("short.nrrd", nrrd_header("400 300 200", "\n") + std::string(10, 'x'));
  EXPECT_NE(refused("short.nrrd").find("truncated"), std::string::npos);
  write("huge.nrrd", nrrd_header("40000 60000 60000", "\n") + std::string(10, 'x'));
  EXPECT_NE(refused("huge.nrrd").find("claims"), std::string::npos);
  write("away.nhdr", nrrd_header("4 3 2", "data file: ../d.raw\n"));
  EXPECT_NE(refused("away.nhdr").find("outside its own folder"), std::string::npos);
  write("gone.nhdr", nrrd_header("4 3 2", "data file: d.raw\n"));
  EXPECT_NE(refused("gone.nhdr").find("no file"), std::string::npos);
  write("text.nrrd", "hello");
  EXPECT_NE(refused("text.nrrd").find("NRRD"), std::string::npos);
  write("four.nrrd", "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 2 2 2 2\nencoding: raw\n\n" +
                         std::string(16, 'x'));
  EXPECT_NE(refused("four.nrrd").find("three axes"), std::string::npos);
}

}  // namespace
}  // namespace leaflight
