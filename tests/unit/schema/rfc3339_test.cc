#include "schema/base/rfc3339.h"

#include <cstdint>
#include <limits>
#include <string>

#include <gtest/gtest.h>

namespace uplink {
namespace {

TEST(Rfc3339, WritesAFractionWhereThereIsOne) {
  EXPECT_EQ(Rfc3339(FromUnixMs(1'777'636'800'000)), "2026-05-01T12:00:00Z");
  EXPECT_EQ(Rfc3339(FromUnixMs(1'777'636'800'050)), "2026-05-01T12:00:00.050Z");
  EXPECT_EQ(Rfc3339(FromUnixMs(-1)), "1969-12-31T23:59:59.999Z");
  EXPECT_EQ(Rfc3339(FromUnixMs(951'782'400'000)), "2000-02-29T00:00:00Z");
  EXPECT_EQ(Rfc3339OfUs(1'777'636'800'050'000), "2026-05-01T12:00:00.050Z");
  EXPECT_EQ(Rfc3339OfUs(1'777'636'800'050'001), "2026-05-01T12:00:00.050001Z");
  EXPECT_EQ(Rfc3339OfUs(3), "1970-01-01T00:00:00.000003Z");
}

TEST(Rfc3339, ShowsTheNearestTimeThatItCanWrite) {
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  constexpr std::int64_t kLeast = std::numeric_limits<std::int64_t>::min();
  EXPECT_EQ(Rfc3339(kRfc3339First), "0001-01-01T00:00:00Z");
  EXPECT_EQ(Rfc3339(kRfc3339Last), "9999-12-31T23:59:59.999Z");
  EXPECT_EQ(Rfc3339(FromUnixMs(kMost)), "9999-12-31T23:59:59.999Z");
  EXPECT_EQ(Rfc3339(FromUnixMs(kLeast)), "0001-01-01T00:00:00Z");
  EXPECT_EQ(Rfc3339OfUs(kMost), "9999-12-31T23:59:59.999Z");
  EXPECT_EQ(Rfc3339OfUs(kLeast), "0001-01-01T00:00:00Z");
}

TEST(Rfc3339, ReadsWhatItWrites) {
  for (const std::int64_t ms : {std::int64_t{0}, std::int64_t{-1}, std::int64_t{951'782'400'001},
                                UnixMs(kRfc3339First), UnixMs(kRfc3339Last)}) {
    EXPECT_EQ(FromRfc3339(Rfc3339(FromUnixMs(ms))), FromUnixMs(ms)) << ms;
  }
}

TEST(Rfc3339, ReadsOffsetsAndCutsTheFraction) {
  const SystemTime noon = FromUnixMs(1'777'636'800'000);
  EXPECT_EQ(FromRfc3339("2026-05-01T14:30:00+02:30"), noon);
  EXPECT_EQ(FromRfc3339("2026-05-01T11:00:00-01:00"), noon);
  EXPECT_EQ(FromRfc3339("2026-05-01T12:00:00.0Z"), noon);
  EXPECT_EQ(FromRfc3339("2026-05-01T12:00:00.25Z"), noon + milliseconds(250));
  EXPECT_EQ(FromRfc3339("2026-05-01T12:00:00.1239999Z"), noon + milliseconds(123));
}

TEST(Rfc3339, RefusesEverythingElse) {
  for (const char* text : {"",
                           "1777636800000",
                           "2026-05-01",
                           "2026-05-01T12:00Z",
                           "2026-05-01T12:00:00",
                           "2026-05-01 12:00:00Z",
                           "2026-05-01t12:00:00z",
                           "2026-05-01T12:00:00.Z",
                           "2026-05-01T12:00:00Zx",
                           "2026-02-29T12:00:00Z",
                           "2026-13-01T12:00:00Z",
                           "2026-05-00T12:00:00Z",
                           "0000-05-01T12:00:00Z",
                           "2026-05-01T24:00:00Z",
                           "2026-05-01T12:60:00Z",
                           "2026-05-01T12:00:60Z",
                           "2026-05-01T12:00:00+0200",
                           "2026-05-01T12:00:00+24:00",
                           "2026-05-01T12:00:00+02:60",
                           "26-05-01T12:00:00Z",
                           "-026-05-01T12:00:00Z",
                           "2026-05-01T12:00:00\u201302:00"}) {
    EXPECT_EQ(FromRfc3339(text), std::nullopt) << text;
  }
}

}  // namespace
}  // namespace uplink
