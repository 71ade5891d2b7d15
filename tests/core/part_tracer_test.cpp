// SPDX-License-Identifier: GPL-3.0-or-later
// Tests bakes in passes whose parts are computed by PartTracer.
#include "bake/driver/part_tracer.h"

#include <gtest/gtest.h>

#include <array>
#include <map>
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

// Two workers that sometimes lose a result.
class TwoTracers {
 public:
  TwoTracers(const Scene<3>& scene, BakeSettings<3> settings) {
    for (const int threads : {1, 3}) {
      settings.threads = threads;
      tracers_.push_back(std::make_unique<PartTracer>(scene, settings, progress_));
    }
    calls_.send = [this](PartData kind, const Workers::Write& write) {
      std::ostringstream data;
      write(data);
      sent_[kind] = data.str();
    };
    calls_.announce = [this](const std::vector<BakePart>& parts) {
      const auto first = static_cast<int>(parts_.size());
      for (const BakePart& part : parts) parts_.push_back({part, sent_});
      return first;
    };
    calls_.take = [this](int number) {
      const Announced& announced = parts_.at(number);
      // The first part of each kind is lost, and then one of four.
      if (kinds_[announced.part.kind]++ % 4 == 0) return std::string();
      // Workers may compute a part twice, in any order.
      computed(0, announced);
      return computed(1, announced);
    };
  }
  const Workers& calls() const { return calls_; }
  int asked(PartKind kind) const { return kinds_.count(kind) ? kinds_.at(kind) : 0; }

 private:
  using Data = std::map<PartData, std::string>;
  struct Announced {
    BakePart part;
    Data data;
  };

  std::string computed(int tracer, const Announced& announced) {
    for (const auto& [kind, data] : announced.data) {
      if (known_[tracer][kind] == data) continue;
      std::istringstream stream(data);
      tracers_[tracer]->read(kind, stream);
      known_[tracer][kind] = data;
    }
    return tracers_[tracer]->traced(announced.part);
  }

  Progress progress_;
  std::vector<std::unique_ptr<PartTracer>> tracers_;
  Workers calls_;
  Data sent_;
  std::array<Data, 2> known_;
  std::vector<Announced> parts_;
  std::map<PartKind, int> kinds_;
};

TEST(PartTracer, BakesAreTheSameWhoeverComputesTheirParts) {
  const Scene<3> scene = test::cornell(test::torus(17), {0.6, 0.95});
  BakeSettings<3> settings = all_light(17);
  settings.error /= 4;
  settings.walls = true;
  TwoTracers others(scene, settings);
  std::vector<Baked<3>> bakes{test::baked(scene, settings)};
  bakes.push_back(test::baked<3>(scene, settings, {{}, nullptr, nullptr, &others.calls()}));
  expect_same_light(bakes);
  EXPECT_EQ(bakes[0].statistics.rays, bakes[1].statistics.rays);
  EXPECT_EQ(bakes[0].statistics.error_percent, bakes[1].statistics.error_percent);
  for (const PartKind kind : {PartKind::maps, PartKind::paths, PartKind::shadows, PartKind::photons,
                              PartKind::bounces, PartKind::block, PartKind::walls}) {
    EXPECT_GT(others.asked(kind), 0) << static_cast<int>(kind);
  }
}

TEST(PartTracer, ContinuedBakesAreTheSame) {
  const Scene<3> scene = test::cornell(test::torus(17), {0.6, 0.95});
  BakeSettings<3> settings = all_light(17);
  settings.error /= 4;
  // The blocks of a continued bake have higher numbers.
  const std::vector<PreviousLight<3>> previous = previous_light(stopped_after(1, scene, settings));
  TwoTracers others(scene, settings);
  std::vector<Baked<3>> bakes{test::baked<3>(scene, settings, {{}, &previous})};
  bakes.push_back(test::baked<3>(scene, settings, {{}, &previous, nullptr, &others.calls()}));
  expect_same_light(bakes);
  EXPECT_GT(others.asked(PartKind::block), 0);
  EXPECT_EQ(others.asked(PartKind::bounces), 0);
}

TEST(PartTracer, RefusePartsOfAnotherBake) {
  const Scene<3> scene = small_scene();
  Workers strange;
  strange.send = [](PartData, const Workers::Write&) {};
  strange.announce = [](const std::vector<BakePart>&) { return 0; };
  strange.take = [](int) { return std::string("a strange part"); };
  Progress progress;
  EXPECT_THROW(test::baked<3>(scene, in_passes(), {{}, nullptr, nullptr, &strange}), Error);
  Scene<3> mirror = scene;
  mirror.volumes[0].scattering = Scattering::mirror;
  EXPECT_THROW(PartTracer(mirror, in_passes(), progress), Error);
}

}  // namespace
}  // namespace leaflight
