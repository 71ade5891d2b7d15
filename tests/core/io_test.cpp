// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "bake/driver/bake.h"
#include "base/platform.h"
#include "errors.h"
#include "io/bake_file.h"
#include "io/exr.h"
#include "io/files.h"
#include "io/replaced_files.h"
#include "io/seal.h"
#include "io/vdb_volume.h"
#include "scenes.h"

namespace leaflight {
namespace {

namespace fs = std::filesystem;

using test::expect_refused;

class Files : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::path(testing::TempDir()) /
        ("leaflight_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) +
         "_" + std::to_string(std::random_device()()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void write(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
  }
  std::string content(const std::string& name) const {
    std::ifstream stream(folder_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  std::size_t count() const {
    return std::distance(fs::directory_iterator(folder_), fs::directory_iterator());
  }

  fs::path folder_;
};

Baked<3> small_bake(const Scene<3>& scene) {
  BakeSettings<3> settings;
  settings.error = 20;
  settings.resolution = {15, 20, 17};
  return test::baked(scene, settings);
}

TEST_F(Files, BakeComesBack) {
  Field<3> whole = test::ball<3>(17);
  std::vector<float> values = test::values_of(whole);
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
  const Voxels voxels = voxels_of(stored.fields[0].values);
  for (std::size_t v = 0; v < values.size(); ++v) {
    if (std::isnan(values[v])) {
      EXPECT_TRUE(std::isnan(value_at(voxels, v)));
    } else {
      ASSERT_EQ(value_at(voxels, v), values[v]);
    }
  }
  EXPECT_LT((stored.fields[0].index_to_world.point({3, 4, 5}) - skewed.point({3, 4, 5})).length(),
            1e-9);
  EXPECT_EQ(again.lattice.active, grid.lattice.active);
  EXPECT_EQ(again.lattice.resolution, grid.lattice.resolution);
  // A bake has the precision of its file, so the light is equal, not only close.
  EXPECT_EQ(again.radiance_indirect, grid.radiance_indirect);
  EXPECT_EQ(again.radiance_error, grid.radiance_error);
  EXPECT_EQ(again.unfiltered.lattice.active, grid.unfiltered.lattice.active);
  EXPECT_EQ(again.unfiltered.lattice.resolution, grid.unfiltered.lattice.resolution);
  EXPECT_EQ(again.unfiltered.sides[0].blocks(), grid.unfiltered.sides[0].blocks());
  // All light is derived from the direct light.
  EXPECT_TRUE(again.radiance.empty());
  EXPECT_FALSE(again.has_light(false));
  RadianceGrid<3> lit = again;
  lit.direct = grid.direct;
  EXPECT_EQ(all_light(lit, test::field_of(scene), false),
            all_light(grid, test::field_of(scene), false));
}

TEST_F(Files, LightWithoutMapsComesBack) {
  const Scene<3> scene = test::cornell(test::ball<3>(17), {0.6, 0.9});
  Baked<3> baked = small_bake(scene);
  baked.grids[0].radiance = all_light(baked.grids[0], test::field_of(scene), false);
  baked.grids[0].direct = nullptr;
  for (Vec<3, float>& light : baked.grids[0].radiance) light = light_precision.rounded(light);
  write_bake(path("a.vdb"), {&test::field_of(scene)}, baked, {});
  EXPECT_EQ(read_bake(path("a.vdb")).baked.grids[0].radiance, baked.grids[0].radiance);
}

TEST_F(Files, AnotherVersionIsRefused) {
  const Scene<3> scene = test::cornell(test::ball<3>(17), {0.6, 0.9});
  write_bake(path("a.vdb"), {&test::field_of(scene)}, small_bake(scene), {});
  std::string text = content("a.vdb");
  const std::string key =
      std::string("leaflight_version") + std::string("\6\0\0\0string\1\0\0\0", 14);
  const std::size_t place = text.find(key);
  ASSERT_NE(place, std::string::npos);
  text[place + key.size()] = '1';
  text.resize(length_without_seal(path("a.vdb"), true));
  write("b.vdb", text);
  expect_refused("another version", [&] { read_bake(path("b.vdb")); });
}

TEST_F(Files, VdbVolumeComesBack) {
  const Scene<3> scene = test::cornell(test::ball<3>(17), {0.6, 0.9});
  write_bake(path("a.vdb"), {&test::field_of(scene)}, small_bake(scene), {});
  const DenseVolume volume = read_vdb_volume(path("a.vdb"), "field");
  EXPECT_EQ(volume.dims, test::field_of(scene).dims);
  const std::size_t middle = cell_count<3>(volume.dims) / 2;
  EXPECT_EQ(value_at(voxels_of(volume.values), middle),
            value_at(test::field_of(scene).values, middle));
  expect_refused("no grid 'smoke'", [&] { read_vdb_volume(path("a.vdb"), "smoke"); });
  expect_refused("scalars", [&] { read_vdb_volume(path("a.vdb"), "radiance"); });
}

TEST_F(Files, DamagedVdbIsRefused) {
  const Scene<3> scene = test::cornell(test::ball<3>(17), {0.6, 0.9});
  write_bake(path("a.vdb"), {&test::field_of(scene)}, small_bake(scene), {});
  const std::uintmax_t size = fs::file_size(path("a.vdb"));
  for (const double previous : {0.999, 0.9, 0.5, 0.1, 0.01}) {
    fs::resize_file(path("a.vdb"),
                    static_cast<std::uintmax_t>(previous * static_cast<double>(size)));
    expect_refused("a.vdb", [&] { read_bake(path("a.vdb")); });
  }
  write("b.vdb", "this is no VDB file at all");
  expect_refused("OpenVDB", [&] { read_bake(path("b.vdb")); });
  expect_refused("no file", [&] { read_bake(path("none.vdb")); });
}

TEST_F(Files, FailedWriteLeavesTheFileBefore) {
  write("x.bin", "before");
  const auto fail = [](std::ostream& stream) {
    stream << "half";
    throw std::runtime_error("disk on fire\nsecond line");
  };
  expect_refused("disk on fire)", [&] { replace_file(path("x.bin"), fail); });
  Progress cancelled;
  cancelled.cancel();
  EXPECT_THROW(replace_file(
                   path("x.bin"), [](std::ostream& s) { s << "half"; }, &cancelled),
               Cancelled);
  EXPECT_EQ(count(), 1u);
  EXPECT_EQ(content("x.bin"), "before");
  expect_refused("does not exist", [&] { replace_file(path("no/x"), [](std::ostream&) {}); });
}

TEST_F(Files, SeveralAreReplacedTogether) {
  write("a", "old");
  {
    ReplacedFiles files({path("a"), path("b.txt")});
    EXPECT_EQ(files.temporary(1).extension(), ".txt");
    std::ofstream(files.temporary(0)) << "new";
    // The second file was not written.
    expect_refused("b.txt", [&] { files.commit(); });
  }
  EXPECT_EQ(content("a"), "old");
  EXPECT_EQ(count(), 1u);
  ReplacedFiles files({path("a"), path("b.txt")});
  std::ofstream(files.temporary(0)) << "new";
  std::ofstream(files.temporary(1)) << "new too";
  files.commit();
  EXPECT_EQ(content("a") + content("b.txt"), "newnew too");
  EXPECT_EQ(count(), 2u);
}

TEST_F(Files, WhatKilledProcessesLeftIsRemovedAndNothingElse) {
  fs::create_directory(folder_ / ".leaflight-part-0123456789abcdef");
  write(".leaflight-part-0123456789abcdef/output.vdb", "of one who was killed");
  write(".leaflight-part-notes", "a file");
  const ReplacedFiles alive({path("x")});
  const ReplacedFiles second({path("y")});
  EXPECT_TRUE(fs::exists(alive.temporary(0).parent_path()));
  EXPECT_EQ(count(), 3u);
}

TEST_F(Files, ManyWritersOfOneTargetLeaveOneWhole) {
  tbb::parallel_for(0, 16, [&](int i) {
    replace_file(path("x"), [&](std::ostream& stream) {
      for (int k = 0; k < 1000; ++k) stream << static_cast<char>('a' + i);
    });
  });
  EXPECT_EQ(count(), 1u);
  EXPECT_EQ(content("x"), std::string(1000, content("x")[0]));
}

TEST_F(Files, SealTellsEveryChange) {
  write("x", "some content");
  EXPECT_EQ(check_seal(path("x")), Seal::none);
  seal(path("x"));
  EXPECT_EQ(check_seal(path("x")), Seal::whole);
  const std::string whole = content("x");
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string damaged = whole;
    damaged[i] ^= 1;
    write("y", damaged);
    EXPECT_NE(check_seal(path("y")), Seal::whole) << i;
    write("y", whole.substr(0, i));
    EXPECT_NE(check_seal(path("y")), Seal::whole) << i;
  }
}

TEST_F(Files, SmallVoxelsAreSaved) {
  // Voxels of 10 micrometers in a file in meters, sheared. OpenVDB accepts no cell below 3e-15.
  const Scene<3> scene = test::cornell(test::ball<3>(17), {0.6, 0.9});
  const Baked<3> baked = small_bake(scene);
  const Affine<3> placed{{Vec3(1e-5, 0, 0), Vec3(1e-6, 2e-5, 0), Vec3(0, 0, 3e-5)},
                         Vec3(1, 2e-3, -3e-5)};
  const Field<3> field = test::field_from<3>(test::values_of(test::field_of(scene)),
                                             test::field_of(scene).dims, placed);
  write_bake(path("a.vdb"), {&field}, baked, {});
  const Affine<3> again = read_bake(path("a.vdb")).fields[0].index_to_world;
  for (int a = 0; a < 3; ++a) EXPECT_EQ(again.column[a], placed.column[a]);
  EXPECT_EQ(again.origin, placed.origin);
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
  expect_refused("EXR", [&] { read_exr(path("j.exr")); });
}

TEST_F(Files, ExrNeedsColorsOrGray) {
  const std::vector<float> pixels{1, 2, 3, 4, 5, 6};
  write_exr(path("i.exr"), pixels.data(), 2, 1, 3);
  std::string content = this->content("i.exr");
  // The list of channels has a size and then, 18 bytes each, B, G and R.
  const std::size_t names = content.find("chlist") + std::string("chlist").size() + 1 + 4;
  for (const std::size_t channel : {0, 1, 2}) {
    const std::size_t at = names + 18 * channel;
    ASSERT_EQ(content[at], "BGR"[channel]);
    content[at] = "BGY"[channel];
  }
  write("j.exr", content);
  expect_refused("has the channels B, G, Y;", [&] { read_exr(path("j.exr")); });
  content[names] = 'V', content[names + 18] = 'W';
  write("k.exr", content);
  EXPECT_EQ(read_exr(path("k.exr")).pixels, (std::vector<float>{1, 1, 1, 4, 4, 4}));
}

TEST_F(Files, ExrOfManyRowsComesBack) {
  std::vector<float> pixels;
  for (int i = 0; i < 2 * 700 * 3; ++i) pixels.push_back(static_cast<float>(i % 1013));
  write_exr(path("i.exr"), pixels.data(), 2, 700, 3);
  EXPECT_EQ(read_exr(path("i.exr")).pixels, pixels);
}

TEST_F(Files, ExrTakesNoMemoryForRowsThatItDoesNotHave) {
  const std::vector<float> pixels(12 * 9 * 3, 1.0f);
  write_exr(path("i.exr"), pixels.data(), 12, 9, 3);
  std::string bytes = content("i.exr");
  const auto isovalue_range = [](std::array<std::int32_t, 4> box) {
    return std::string(reinterpret_cast<const char*>(box.data()), sizeof box);
  };
  const std::string small = isovalue_range({0, 0, 11, 8}),
                    large = isovalue_range({0, 0, 11'999, 15'999});
  for (std::size_t at; (at = bytes.find(small)) != bytes.npos;) bytes.replace(at, 16, large);
  // Leave space for the offsets of as many rows as the header claims.
  write("j.exr", bytes + std::string(9000, '\0'));
  const std::uint64_t before = peak_memory();
  expect_refused("EXR", [&] { read_exr(path("j.exr")); });
  EXPECT_LT(peak_memory() - before, 1'000'000'000u);
}

}  // namespace
}  // namespace leaflight
