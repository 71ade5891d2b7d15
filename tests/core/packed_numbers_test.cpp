// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/packed_numbers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/random.h"

namespace leaflight {
namespace {

TEST(ShortFloat, RoundsToTheNearestNumberWithTheseBits) {
  for (const int dropped : {0, 2, 4, 5}) {
    const ShortFloat precision{dropped};
    const double step = std::ldexp(1.0, dropped - 10);
    for (double x = 1e-30; x < 1e30; x *= 1.037) {
      const auto number = static_cast<float>(x);
      const float found = precision.rounded(number);
      ASSERT_NEAR(found / number, 1, step / 2) << x;
      ASSERT_EQ(precision.rounded(found), found);
      ASSERT_EQ(precision.rounded(-number), -found);
      ASSERT_LE(precision.code(number), precision.code(number * 1.01f));
    }
  }
}

TEST(ShortFloat, KeepsSmallGreatAndUnknownNumbers) {
  for (const int dropped : {0, 2, 4, 5}) {
    const ShortFloat precision{dropped};
    EXPECT_EQ(precision.rounded(0.0f), 0);
    EXPECT_TRUE(std::isnan(precision.rounded(std::numeric_limits<float>::quiet_NaN())));
    const float most = precision.rounded(std::numeric_limits<float>::infinity());
    EXPECT_TRUE(most > 3.3e38f && std::isfinite(most)) << most;
    EXPECT_EQ(precision.rounded(std::numeric_limits<float>::max()), most);
    EXPECT_EQ(precision.rounded(-std::numeric_limits<float>::max()), -most);
    // The least normal float.
    EXPECT_EQ(precision.rounded(0x1p-126f), 0x1p-126f);
  }
}

std::vector<float> numbers(std::size_t count) {
  std::vector<float> numbers(count);
  Random random = random_for(7, Purpose::photon, count);
  for (std::size_t i = 0; i < count; ++i) {
    numbers[i] = static_cast<float>(std::pow(10, 8 * random.uniform() - 6) *
                                    (random.uniform() < 0.2 ? -1 : 1));
    if (i % 101 == 0) numbers[i] = std::numeric_limits<float>::quiet_NaN();
  }
  return numbers;
}

TEST(PackedNumbers, ComeBackRounded) {
  for (const int channels : {1, 3}) {
    for (const std::size_t count :
         {std::size_t{1}, PackedNumbers::block, PackedNumbers::block + 1}) {
      const std::vector<float> before = numbers(count * channels);
      const ShortFloat precision{2};
      const PackedNumbers packed(before.data(), count, channels, precision);
      std::vector<float> after(before.size(), 42);
      packed.unpack(after.data());
      for (std::size_t i = 0; i < before.size(); ++i) {
        if (std::isnan(before[i])) {
          ASSERT_TRUE(std::isnan(after[i]));
        } else {
          ASSERT_EQ(after[i], precision.rounded(before[i])) << i;
        }
      }
    }
  }
}

TEST(PackedNumbers, DamagedBlocksAreRefused) {
  const std::vector<float> before = numbers(1000);
  const PackedNumbers whole(before.data(), before.size(), 1, {});
  std::vector<std::string> cut = whole.blocks();
  cut[0].resize(cut[0].size() / 2);
  std::vector<float> after(2000);
  EXPECT_THROW(PackedNumbers(cut, 1000, 1, {}).unpack(after.data()), std::runtime_error);
  EXPECT_THROW(PackedNumbers(whole.blocks(), 2000, 1, {}).unpack(after.data()), std::runtime_error);
}

}  // namespace
}  // namespace leaflight
