#include "server/robot/presence.h"

#include <string>

#include <gtest/gtest.h>

namespace uplink::robot {
namespace {

constexpr PresenceLimits kLimits{.timeout = milliseconds(10'000),
                                 .startup_grace = milliseconds(120'000)};
constexpr SteadyTime kStart{std::chrono::hours(1)};

constexpr SteadyTime At(std::int64_t ms) { return kStart + milliseconds(ms); }

struct Case {
  std::string name;
  /// Milliseconds after the server's start; nothing: never.
  std::int64_t now = 0;
  std::optional<std::int64_t> heard;
  bool held_back = false;
  std::optional<std::int64_t> held_back_until;
  Presence expected = Presence::kUnknown;
  /// What the robot's last holder wrote, taken over at 0; and until when it may be unheard.
  std::optional<Presence> claimed = {};
  std::optional<std::int64_t> unknown_until = {};
};

PresenceFacts FactsOf(const Case& fact) {
  PresenceFacts facts{.now = At(fact.now),
                      .server_started = kStart,
                      .known_since = kStart,
                      .held_back = fact.held_back};
  if (fact.heard) facts.last_sign_of_life = At(*fact.heard);
  if (fact.claimed) facts.claimed = {*fact.claimed, kStart};
  if (fact.unknown_until) facts.unknown_until = At(*fact.unknown_until);
  if (fact.held_back_until) facts.held_back_until = At(*fact.held_back_until);
  return facts;
}

class PresenceTable : public ::testing::TestWithParam<Case> {};

TEST_P(PresenceTable, Holds) {
  EXPECT_EQ(ToText(PresenceOf(FactsOf(GetParam()), kLimits)), ToText(GetParam().expected));
}

TEST_P(PresenceTable, IsOfflineFromWhereItMayBe) {
  PresenceFacts facts = FactsOf(GetParam());
  if (facts.held_back || GetParam().claimed == Presence::kOffline) return;
  facts.now = NotOfflineUntil(facts, kLimits);
  EXPECT_NE(ToText(PresenceOf(facts, kLimits)), ToText(Presence::kOffline));
  facts.now += milliseconds(1);
  EXPECT_EQ(ToText(PresenceOf(facts, kLimits)), ToText(Presence::kOffline));
}

constexpr auto kUnknown = Presence::kUnknown;
constexpr auto kOnline = Presence::kOnline;
constexpr auto kOffline = Presence::kOffline;

INSTANTIATE_TEST_SUITE_P(
    Presence, PresenceTable,
    ::testing::Values(
        Case{"NeverHeardAtTheStart", 0, {}, false, {}, kUnknown},
        Case{"NeverHeardAtTheEndOfTheGrace", 120'000, {}, false, {}, kUnknown},
        Case{"NeverHeardPastTheGrace", 120'001, {}, false, {}, kOffline},
        Case{"HeardNow", 0, 0, false, {}, kOnline},
        Case{"HeardATimeoutAgo", 50'000, 40'000, false, {}, kOnline},
        Case{"HeardOverATimeoutAgo", 50'001, 40'000, false, {}, kOffline},
        Case{"HeardOnceThenSilentWithinTheGrace", 20'000, 1'000, false, {}, kOffline},
        Case{"HeldBackAndHeardLately", 50'000, 40'000, true, {}, kOnline},
        Case{"HeldBackAndSilent", 900'000, 40'000, true, {}, kUnknown},
        Case{"HeldBackAndNeverHeard", 900'000, {}, true, {}, kUnknown},
        Case{"ATimeoutAfterHoldingBack", 900'000, 40'000, false, 890'000, kUnknown},
        Case{"OverATimeoutAfterHoldingBack", 900'001, 40'000, false, 890'000, kOffline},
        Case{"NeverHeardATimeoutAfterHoldingBack", 900'000, {}, false, 890'000, kUnknown},
        Case{"NeverHeardOverATimeoutAfterHoldingBack", 900'001, {}, false, 890'000, kOffline},
        Case{"HeldBackAgain", 900'001, 40'000, true, 890'000, kUnknown},
        Case{"HeardAfterHoldingBack", 900'000, 899'000, false, 890'000, kOnline},
        Case{"OfflineBeforeAtTheStart", 0, {}, false, {}, kOffline, kOffline},
        Case{"OfflineBeforeWithinTheGrace", 60'000, {}, false, {}, kOffline, kOffline},
        Case{"OfflineBeforePastTheGrace", 120'001, {}, false, {}, kOffline, kOffline},
        Case{"OfflineBeforeAndHeardNow", 60'000, 60'000, false, {}, kOnline, kOffline},
        Case{"OfflineBeforeAndHeldBack", 60'000, {}, true, {}, kUnknown, kOffline},
        Case{"OnlineBeforeATimeoutAgo", 10'000, {}, false, {}, kOnline, kOnline},
        Case{"OnlineBeforeOverATimeoutAgo", 10'001, {}, false, {}, kUnknown, kOnline},
        Case{"MayBeUnheardUntilNow", 900'000, {}, false, {}, kUnknown, {}, 900'000},
        Case{"MayBeUnheardNoLonger", 900'001, {}, false, {}, kOffline, {}, 900'000}),
    [](const auto& instance) { return instance.param.name; });

TEST(EndOfStall, IsWhereTheGraceOfAStartEndsATimeoutLater) {
  EXPECT_EQ(EndOfStallWithGrace(kStart, kLimits), At(110'000));
  const PresenceLimits equal{.timeout = milliseconds(5), .startup_grace = milliseconds(5)};
  EXPECT_EQ(EndOfStallWithGrace(kStart, equal), kStart);
  const PresenceLimits none{.timeout = milliseconds(5), .startup_grace = milliseconds(0)};
  EXPECT_EQ(EndOfStallWithGrace(kStart, none), kStart);
}

TEST(PresenceText, IsAsTheApiSpellsIt) {
  EXPECT_EQ(ToText(Presence::kUnknown), "unknown");
  EXPECT_EQ(ToText(Presence::kOnline), "online");
  EXPECT_EQ(ToText(Presence::kOffline), "offline");
}

}  // namespace
}  // namespace uplink::robot
