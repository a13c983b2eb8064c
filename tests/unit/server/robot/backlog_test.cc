#include "server/robot/backlog.h"

#include <limits>

#include <gtest/gtest.h>

namespace uplink::robot {
namespace {

constexpr std::int64_t kSent = 1'763'683'200'000;
constexpr SystemTime kNow = FromUnixMs(kSent + 40);
constexpr auto kLowest = std::numeric_limits<std::int64_t>::min();
constexpr auto kHighest = std::numeric_limits<std::int64_t>::max();

TEST(BacklogTest, AnAgentThatSaysNothingHasNone) {
  EXPECT_EQ(BacklogOf({}, kNow), std::nullopt);
  EXPECT_EQ(BacklogOf({.sent_unix_ms = kSent}, kNow), std::nullopt);
  EXPECT_EQ(BacklogOf({.sent_unix_ms = kSent, .oldest_unsent_unix_ms = kSent - 5}, kNow),
            std::nullopt)
      << "a time alone counts nothing";
}

TEST(BacklogTest, TheOldestIsToldByOurClock) {
  const BatchHead head{
      .sent_unix_ms = kSent, .backlog_uplinks = 7, .oldest_unsent_unix_ms = kSent - 2000};
  EXPECT_EQ(BacklogOf(head, kNow),
            (Backlog{.uplinks = 7, .oldest_unsent = kNow - milliseconds(2000), .said_at = kNow}));
  // The same agent with a clock of 1970.
  const BatchHead old{.sent_unix_ms = 5000, .backlog_uplinks = 7, .oldest_unsent_unix_ms = 3000};
  EXPECT_EQ(BacklogOf(old, kNow), BacklogOf(head, kNow));
}

TEST(BacklogTest, NothingWaitsIsSomethingSaid) {
  EXPECT_EQ(BacklogOf({.backlog_uplinks = 0}, kNow), (Backlog{.uplinks = 0, .said_at = kNow}));
  EXPECT_EQ(
      BacklogOf({.sent_unix_ms = kSent, .backlog_uplinks = 0, .oldest_unsent_unix_ms = 9}, kNow),
      (Backlog{.uplinks = 0, .said_at = kNow}));
}

TEST(BacklogTest, ACountPastTheBoundIsUnsaid) {
  EXPECT_EQ(BacklogOf({.backlog_uplinks = kBacklogUplinksMax}, kNow)->uplinks, kBacklogUplinksMax);
  EXPECT_EQ(BacklogOf({.backlog_uplinks = kBacklogUplinksMax + 1}, kNow), std::nullopt);
  EXPECT_EQ(BacklogOf({.backlog_uplinks = std::numeric_limits<std::uint64_t>::max()}, kNow),
            std::nullopt)
      << "a -1 of the agent";
}

TEST(BacklogTest, AnOldestThatCannotBeIsUnknown) {
  const auto since = [](std::int64_t sent, std::int64_t oldest) {
    const auto backlog = BacklogOf(
        {.sent_unix_ms = sent, .backlog_uplinks = 3, .oldest_unsent_unix_ms = oldest}, kNow);
    EXPECT_EQ(backlog->uplinks, 3U);
    return backlog->oldest_unsent;
  };
  EXPECT_EQ(since(kSent, kSent), kNow);
  EXPECT_EQ(since(kSent, kSent + 1), std::nullopt) << "later than the batch";
  EXPECT_EQ(since(0, kSent), std::nullopt) << "the batch has no time";
  for (const std::int64_t odd : {kLowest, std::int64_t{-1}, std::int64_t{0}, kHighest}) {
    EXPECT_EQ(since(kSent, odd), std::nullopt) << odd;
    EXPECT_EQ(since(odd, kSent), std::nullopt) << odd;
  }
  const std::int64_t oldest = kSent - kBacklogAgeMax.count();
  EXPECT_EQ(since(kSent, oldest), kNow - kBacklogAgeMax);
  EXPECT_EQ(since(kSent, oldest - 1), std::nullopt);
}

}  // namespace
}  // namespace uplink::robot
