#include "tools/uplink-fleet/robot/histogram.h"

#include <gtest/gtest.h>

namespace uplink::synthetic {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

TEST(HistogramTest, NothingRecordedIsZero) {
  const Histogram none;
  EXPECT_EQ(none.count(), 0U);
  EXPECT_EQ(none.Quantile(0.99), microseconds(0));
  EXPECT_EQ(none.max(), microseconds(0));
}

TEST(HistogramTest, QuantilesAreWithinAHundredAndTwentyEighth) {
  Histogram histogram;
  constexpr int kValues = 100'000;
  for (int i = 1; i <= kValues; ++i) histogram.Record(microseconds(i * 7));
  for (const double share : {0.001, 0.1, 0.5, 0.9, 0.99, 0.999}) {
    const double exact = share * kValues * 7;
    EXPECT_NEAR(static_cast<double>(histogram.Quantile(share).count()), exact, exact / 128 + 7)
        << share;
  }
  EXPECT_EQ(histogram.Quantile(1), microseconds(kValues * 7));
  EXPECT_EQ(histogram.count(), static_cast<std::uint64_t>(kValues));
}

TEST(HistogramTest, SmallValuesAreExact) {
  for (int value = 0; value < 256; ++value) {
    Histogram histogram;
    histogram.Record(microseconds(value));
    histogram.Record(std::chrono::seconds(1));
    EXPECT_EQ(histogram.Quantile(0.5), microseconds(value));
  }
}

TEST(HistogramTest, AtEveryDoublingAValueIsNoMoreThanAHundredAndTwentyEighthOff) {
  for (std::int64_t value = 1; value <= Histogram::kMax.count(); value *= 2) {
    for (const std::int64_t near : {value - 1, value, value + 1}) {
      Histogram histogram;
      histogram.Record(microseconds(near));
      histogram.Record(Histogram::kMax);
      const std::int64_t found = histogram.Quantile(0.5).count();
      EXPECT_GE(found, near);
      EXPECT_LE(found, near + near / 128);
    }
  }
}

TEST(HistogramTest, BeyondItsEndsNothingIsLost) {
  Histogram histogram;
  histogram.Record(microseconds(-5));
  histogram.Record(std::chrono::hours(30));
  EXPECT_EQ(histogram.count(), 2U);
  EXPECT_EQ(histogram.Quantile(0.5), microseconds(0));
  EXPECT_EQ(histogram.max(), microseconds(Histogram::kMax));
}

TEST(HistogramTest, MergedIsAsIfRecordedInOne) {
  Histogram one;
  Histogram two;
  Histogram both;
  for (int i = 0; i < 1000; ++i) {
    (i % 3 == 0 ? one : two).Record(milliseconds(i));
    both.Record(milliseconds(i));
  }
  one.Merge(two);
  EXPECT_EQ(one.count(), both.count());
  EXPECT_EQ(one.max(), both.max());
  EXPECT_EQ(one.Quantile(0.9), both.Quantile(0.9));
}

}  // namespace
}  // namespace uplink::synthetic
