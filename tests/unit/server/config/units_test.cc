#include "server/config/units.h"

#include <gtest/gtest.h>

namespace uplink::config {
namespace {

using std::chrono::milliseconds;

TEST(ParseDurationTest, ReadsEveryUnit) {
  EXPECT_EQ(ParseDuration("500ms"), milliseconds(500));
  EXPECT_EQ(ParseDuration("10s"), milliseconds(10'000));
  EXPECT_EQ(ParseDuration("2m"), milliseconds(120'000));
  EXPECT_EQ(ParseDuration("1h"), milliseconds(3'600'000));
  EXPECT_EQ(ParseDuration("1d"), milliseconds(86'400'000));
}

TEST(ParseDurationTest, ReadsABareZeroAlone) {
  EXPECT_EQ(ParseDuration("0"), milliseconds(0));
  EXPECT_EQ(ParseDuration("0s"), milliseconds(0));
  EXPECT_EQ(ParseDuration("10"), std::nullopt);
}

TEST(ParseDurationTest, RefusesWhatIsNoDuration) {
  for (const char* const text :
       {"", "s", "-1s", "+1s", " 1s", "1s ", "1 s", "1.5s", "1S", "1sec", "1h30m", "0x1s"}) {
    EXPECT_EQ(ParseDuration(text), std::nullopt) << text;
  }
}

TEST(ParseDurationTest, ReadsUpToItsBoundAndNotPastIt) {
  EXPECT_EQ(ParseDuration("10000d"), milliseconds(864'000'000'000));
  EXPECT_EQ(ParseDuration("10001d"), std::nullopt);
  EXPECT_EQ(ParseDuration("99999999999999999999s"), std::nullopt);
}

TEST(ParseBytesTest, ReadsEveryUnit) {
  EXPECT_EQ(ParseBytes("0"), 0U);
  EXPECT_EQ(ParseBytes("512B"), 512U);
  EXPECT_EQ(ParseBytes("64KiB"), 65'536U);
  EXPECT_EQ(ParseBytes("1MiB"), 1'048'576U);
  EXPECT_EQ(ParseBytes("2GiB"), 2'147'483'648U);
}

TEST(ParseBytesTest, RefusesWhatIsNoSize) {
  for (const char* const text : {"", "64", "KiB", "64KB", "64kib", "1.5MiB", "-1B", "1 MiB"}) {
    EXPECT_EQ(ParseBytes(text), std::nullopt) << text;
  }
}

TEST(ParseBytesTest, ReadsUpToSixtyThreeBitsAndNotPastThem) {
  EXPECT_EQ(ParseBytes("9223372036854775807B"), 9'223'372'036'854'775'807U);
  EXPECT_EQ(ParseBytes("9223372036854775808B"), std::nullopt);
  EXPECT_EQ(ParseBytes("8589934592GiB"), std::nullopt);
}

TEST(DurationTextTest, UsesTheLargestUnitThatIsExact) {
  EXPECT_EQ(DurationText(milliseconds(0)), "0");
  EXPECT_EQ(DurationText(milliseconds(1)), "1ms");
  EXPECT_EQ(DurationText(milliseconds(90'000)), "90s");
  EXPECT_EQ(DurationText(milliseconds(120'000)), "2m");
  EXPECT_EQ(DurationText(milliseconds(86'400'000)), "1d");
}

TEST(BytesTextTest, ReadsBackToTheSameValue) {
  for (const std::uint64_t bytes : {0ULL, 1ULL, 1023ULL, 1024ULL, 1536ULL, 1ULL << 30U}) {
    EXPECT_EQ(ParseBytes(BytesText(bytes)), bytes) << BytesText(bytes);
  }
}

}  // namespace
}  // namespace uplink::config
