// SPDX-License-Identifier: GPL-3.0-or-later
// Tests bakes in passes whose blocks are traced by BlockTracer.
#include "bake/driver/block_tracer.h"

#include <gtest/gtest.h>

#include <sstream>

#include "base/error.h"
#include "whole_passes.h"

namespace leaflight {
namespace {

using test::all_light;
using test::expect_same_light;
using test::in_passes;
using test::previous_light;
using test::small_scene;
using test::stopped_after;

// Two workers, one of which sometimes loses its result.
class TwoTracers {
 public:
  TwoTracers(const Scene<3>& scene, BakeSettings<3> settings) {
    for (const int threads : {1, 3}) {
      settings.threads = threads;
      tracers_.push_back(std::make_unique<BlockTracer>(scene, settings, progress_));
    }
    calls_.begin = [this](int first, int count,
                          const std::function<void(std::ostream&)>& looked_up) {
      EXPECT_GT(count, 0);
      first_ = first;
      end_ = first + count;
      std::ostringstream state;
      looked_up(state);
      for (auto& tracer : tracers_) {
        std::istringstream stream(state.str());
        tracer->look_up(stream);
      }
    };
    calls_.take = [this](int number) {
      EXPECT_TRUE(first_ <= number && number < end_);
      const bool loses = ++asked_ % 4 == 0;
      lost_ += loses;
      return loses ? std::string() : tracers_[number % 2]->trace(number);
    };
  }
  const BlockWorkers& calls() const { return calls_; }
  int asked() const { return asked_; }
  int lost() const { return lost_; }

 private:
  Progress progress_;
  std::vector<std::unique_ptr<BlockTracer>> tracers_;
  BlockWorkers calls_;
  int first_ = 0, end_ = 0, asked_ = 0, lost_ = 0;
};

TEST(BlockTracer, AreTheSameWhoeverTracesTheirBlocks) {
  const Scene<3> scene = test::cornell(test::torus(17), {0.6, 0.95});
  BakeSettings<3> settings = all_light(17);
  settings.error /= 4;
  TwoTracers others(scene, settings);
  std::vector<Baked<3>> bakes{test::baked(scene, settings)};
  bakes.push_back(test::baked<3>(scene, settings, {{}, nullptr, nullptr, &others.calls()}));
  expect_same_light(bakes);
  EXPECT_EQ(bakes[0].statistics.rays, bakes[1].statistics.rays);
  EXPECT_GT(others.lost(), 0);
  // The blocks of a continued bake have higher numbers.
  const std::vector<PreviousLight<3>> previous = previous_light(stopped_after(1, scene, settings));
  TwoTracers again(scene, settings);
  bakes = {test::baked<3>(scene, settings, {{}, &previous})};
  bakes.push_back(test::baked<3>(scene, settings, {{}, &previous, nullptr, &again.calls()}));
  expect_same_light(bakes);
  EXPECT_GT(again.asked(), 0);
}

TEST(BlockTracer, RefuseABlockOfAnotherBake) {
  const Scene<3> scene = small_scene();
  BlockWorkers strange;
  strange.begin = [](int, int, const std::function<void(std::ostream&)>&) {};
  strange.take = [](int) { return std::string("a block"); };
  Progress progress;
  EXPECT_THROW(test::baked<3>(scene, in_passes(), {{}, nullptr, nullptr, &strange}), Error);
  Scene<3> mirror = scene;
  mirror.volumes[0].scattering = Scattering::mirror;
  EXPECT_THROW(BlockTracer(mirror, in_passes(), progress), Error);
}

}  // namespace
}  // namespace leaflight
