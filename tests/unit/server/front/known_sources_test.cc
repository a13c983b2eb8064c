#include "server/front/known_sources.h"

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

TEST(KnownSources, KnowsNobodyAtFirst) {
  const KnownSources sources;
  EXPECT_FALSE(sources.IsKnown(From(1), kNow));
  EXPECT_EQ(sources.size(), 0U);
}

TEST(KnownSources, KnowsASourceForAnHour) {
  KnownSources sources;
  sources.Note(From(1), kNow);
  EXPECT_TRUE(sources.IsKnown(From(1), kNow));
  EXPECT_TRUE(sources.IsKnown(From(1), kNow + kKnownFor - kMs));
  EXPECT_FALSE(sources.IsKnown(From(1), kNow + kKnownFor));
  EXPECT_FALSE(sources.IsKnown(From(2), kNow));
}

TEST(KnownSources, TheHourBeginsAnewWithEachNote) {
  KnownSources sources;
  sources.Note(From(1), kNow);
  sources.Note(From(1), kNow + 30 * 60 * 1000 * kMs);
  EXPECT_TRUE(sources.IsKnown(From(1), kNow + kKnownFor));
  EXPECT_EQ(sources.size(), 1U);
}

TEST(KnownSources, AnEarlierTimeOfAnotherThreadTakesNothingBack) {
  KnownSources sources;
  sources.Note(From(1), kNow + kMs);
  sources.Note(From(1), kNow);
  EXPECT_TRUE(sources.IsKnown(From(1), kNow + kKnownFor));
}

TEST(KnownSources, KeepsAsManyAsItsBound) {
  KnownSources sources;
  for (std::size_t i = 0; i < kKnownSourcesMax; ++i) sources.Note(From(i), kNow);
  EXPECT_EQ(sources.size(), kKnownSourcesMax);
  EXPECT_TRUE(sources.IsKnown(From(0), kNow));
}

TEST(KnownSources, PastItForgetsTheOneNotedLeastRecently) {
  KnownSources sources;
  for (std::size_t i = 0; i < kKnownSourcesMax; ++i) sources.Note(From(i), kNow);
  sources.Note(From(0), kNow + kMs);
  sources.Note(From(kKnownSourcesMax), kNow + kMs);
  EXPECT_EQ(sources.size(), kKnownSourcesMax);
  EXPECT_TRUE(sources.IsKnown(From(0), kNow + kMs));
  EXPECT_FALSE(sources.IsKnown(From(1), kNow + kMs));
  EXPECT_TRUE(sources.IsKnown(From(2), kNow + kMs));
  EXPECT_TRUE(sources.IsKnown(From(kKnownSourcesMax), kNow + kMs));
}

TEST(KnownSources, DropsThoseThatAreKnownNoMore) {
  KnownSources sources;
  sources.Note(From(1), kNow);
  sources.Note(From(2), kNow + kMs);
  sources.Note(From(3), kNow + kKnownFor);
  EXPECT_EQ(sources.size(), 2U);
  EXPECT_TRUE(sources.IsKnown(From(2), kNow + kKnownFor));
}

}  // namespace
}  // namespace uplink::front
