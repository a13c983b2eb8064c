#include "server/front/door/known_sources.h"

#include <cstdint>

#include <arpa/inet.h>
#include <gtest/gtest.h>

namespace uplink::front {
namespace {

constexpr SteadyTime kNow{std::chrono::hours(5)};
constexpr milliseconds kMs{1};

SourceAddress From(std::size_t number) {
  return SourceAddress::Of(in_addr{.s_addr = htonl(static_cast<std::uint32_t>(number))});
}

/// A robot's stream from there ended.
void Stream(KnownSources& sources, const SourceAddress& source, SteadyTime end) {
  sources.Enter(source);
  sources.Leave(source, end);
}

TEST(KnownSources, KnowsASourceForAnHour) {
  KnownSources sources;
  Stream(sources, From(1), kNow);
  EXPECT_TRUE(sources.IsKnown(From(1), kNow));
  EXPECT_TRUE(sources.IsKnown(From(1), kNow + kKnownFor - kMs));
  EXPECT_FALSE(sources.IsKnown(From(1), kNow + kKnownFor));
  EXPECT_FALSE(sources.IsKnown(From(2), kNow));
}

TEST(KnownSources, KnowsASourceAsLongAsAStreamFromItLives) {
  KnownSources sources;
  sources.Enter(From(1));
  sources.Enter(From(1));
  EXPECT_TRUE(sources.IsKnown(From(1), kNow + 100 * kKnownFor));
  sources.Leave(From(1), kNow);
  EXPECT_TRUE(sources.IsKnown(From(1), kNow + 100 * kKnownFor)) << "the other one lives";
  sources.Leave(From(1), kNow + 100 * kKnownFor);
  EXPECT_TRUE(sources.IsKnown(From(1), kNow + 101 * kKnownFor - kMs));
  EXPECT_FALSE(sources.IsKnown(From(1), kNow + 101 * kKnownFor));
}

TEST(KnownSources, NoNumberOfOthersMakesItForgetOneThatStreams) {
  KnownSources sources;
  sources.Enter(From(0));
  for (std::size_t i = 1; i <= kKnownSourcesMax + 1; ++i) Stream(sources, From(i), kNow);
  EXPECT_EQ(sources.size(), kKnownSourcesMax);
  EXPECT_FALSE(sources.IsKnown(From(1), kNow));
  EXPECT_TRUE(sources.IsKnown(From(0), kNow));
  sources.Leave(From(0), kNow);
  EXPECT_EQ(sources.size(), kKnownSourcesMax);
  EXPECT_TRUE(sources.IsKnown(From(0), kNow));
  EXPECT_FALSE(sources.IsKnown(From(2), kNow));
}

TEST(KnownSources, TheHourBeginsAnewWithEachStream) {
  KnownSources sources;
  Stream(sources, From(1), kNow);
  Stream(sources, From(1), kNow + 30 * 60 * 1000 * kMs);
  EXPECT_TRUE(sources.IsKnown(From(1), kNow + kKnownFor));
  EXPECT_EQ(sources.size(), 1U);
}

TEST(KnownSources, AnEarlierTimeOfAnotherThreadTakesNothingBack) {
  KnownSources sources;
  Stream(sources, From(1), kNow + kMs);
  Stream(sources, From(1), kNow);
  EXPECT_TRUE(sources.IsKnown(From(1), kNow + kKnownFor));
}

TEST(KnownSources, DropsThoseThatAreKnownNoMore) {
  KnownSources sources;
  Stream(sources, From(1), kNow);
  Stream(sources, From(2), kNow + kMs);
  Stream(sources, From(3), kNow + kKnownFor);
  EXPECT_EQ(sources.size(), 2U);
  EXPECT_TRUE(sources.IsKnown(From(2), kNow + kKnownFor));
}

}  // namespace
}  // namespace uplink::front
