#include "server/front/lifetime.h"

#include <gtest/gtest.h>

#include "server/front/http2/limits.h"
#include "server/front/tls/tls_peer.h"

namespace uplink::front {
namespace {

using Due = Lifetime::Due;

constexpr SteadyTime kStart{std::chrono::hours(1)};
constexpr milliseconds kYear = std::chrono::hours(24 * 365);
constexpr milliseconds kHour = std::chrono::hours(1);

class LifetimeTest : public ::testing::Test {
 protected:
  void Open(milliseconds age, milliseconds until_expiry, std::uint16_t jitter = 0) {
    lifetime_.Open(kStart, age, until_expiry, jitter);
    lifetime_.SetCalls(1, kStart);
    lifetime_.NoteServed();
  }
  /// The peer was heard just before.
  Due HeardAndDueAt(milliseconds at) {
    lifetime_.NoteHeard(kStart + at);
    return DueAt(at);
  }
  /// Besides looks at the expiry, which find what they found before.
  Due DueAt(milliseconds at) {
    const Due due = lifetime_.Take(kStart + at, false);
    return due == Due::kLookAtExpiry ? lifetime_.Take(kStart + at, false) : due;
  }

  Lifetime lifetime_;
};

TEST_F(LifetimeTest, SilenceIsAskedAboutAndThenTheEnd) {
  Open(milliseconds(0), kYear);
  EXPECT_EQ(DueAt(kKeepaliveAfter - milliseconds(1)), Due::kNothing);
  EXPECT_EQ(DueAt(kKeepaliveAfter), Due::kPing);
  EXPECT_EQ(DueAt(kKeepaliveAfter + milliseconds(1)), Due::kNothing) << "asked once";
  EXPECT_EQ(DueAt(kKeepaliveAfter + kKeepaliveWait), Due::kSilent);
}

TEST_F(LifetimeTest, WhoTakesWhatWaitsForItHasLongerToAnswer) {
  Open(milliseconds(0), kYear);
  EXPECT_EQ(DueAt(kKeepaliveAfter), Due::kPing);
  lifetime_.StillTakes(kStart + kKeepaliveAfter + kKeepaliveWait);
  EXPECT_EQ(DueAt(kKeepaliveAfter + 2 * kKeepaliveWait - milliseconds(1)), Due::kNothing);
  EXPECT_EQ(DueAt(kKeepaliveAfter + 2 * kKeepaliveWait), Due::kSilent);
}

TEST_F(LifetimeTest, AnyByteIsAnAnswer) {
  Open(milliseconds(0), kYear);
  EXPECT_EQ(DueAt(kKeepaliveAfter), Due::kPing);
  lifetime_.NoteHeard(kStart + kKeepaliveAfter + milliseconds(1));
  EXPECT_EQ(DueAt(kKeepaliveAfter + kKeepaliveWait), Due::kNothing);
}

TEST_F(LifetimeTest, AgeEndsItOnce) {
  Open(kHour, kYear);
  EXPECT_EQ(HeardAndDueAt(kHour - milliseconds(1)), Due::kNothing);
  EXPECT_EQ(HeardAndDueAt(kHour), Due::kAge);
  EXPECT_EQ(HeardAndDueAt(kHour), Due::kNothing);
}

TEST_F(LifetimeTest, JitterTakesATenthAtMost) {
  Open(kHour, kYear, 65'535);
  EXPECT_EQ(HeardAndDueAt(kHour * 9 / 10 - milliseconds(1)), Due::kNothing);
  EXPECT_EQ(HeardAndDueAt(kHour * 9 / 10 + milliseconds(200)), Due::kAge);
}

TEST_F(LifetimeTest, ItEndsTenMinutesBeforeItsCertificate) {
  Open(kHour * 24, kHour);
  EXPECT_EQ(HeardAndDueAt(kHour - kBeforeExpiry - milliseconds(1)), Due::kNothing);
  EXPECT_EQ(HeardAndDueAt(kHour - kBeforeExpiry), Due::kAge);
}

/// Looks at the expiry each minute, as a connection does, on a civil clock that gains `slew` each
/// time; says when the age is told.
milliseconds ToldAt(Lifetime& lifetime, milliseconds until_expiry, milliseconds slew) {
  milliseconds left = until_expiry;
  for (milliseconds at{0}; at <= until_expiry; at += kExpiryLook) {
    lifetime.NoteHeard(kStart + at);
    Due due = lifetime.Take(kStart + at, false);
    if (due == Due::kLookAtExpiry) {
      lifetime.SetExpiry(kStart + at, left);
      due = lifetime.Take(kStart + at, false);
    }
    if (due == Due::kAge) return at;
    left -= kExpiryLook + slew;
  }
  return milliseconds::max();
}

TEST_F(LifetimeTest, JitterBeforeTheExpiryIsTakenOnceHoweverOftenThatIsLookedAt) {
  const milliseconds until_expiry = kHour * 100 + kBeforeExpiry;
  for (const milliseconds slew : {milliseconds(0), milliseconds(30), milliseconds(-30)}) {
    Open(milliseconds(0), until_expiry, 65'535);
    const milliseconds told = ToldAt(lifetime_, until_expiry, slew);
    EXPECT_GT(told, kHour * 89) << slew.count();
    EXPECT_LT(told, kHour * 91) << slew.count();
  }
}

TEST_F(LifetimeTest, JitterBeforeTheExpiryIsTakenAnewOnceTheClockWasSet) {
  Open(milliseconds(0), kFarAway, 65'535);
  lifetime_.SetExpiry(kStart, kHour * 10 + kBeforeExpiry);
  EXPECT_EQ(HeardAndDueAt(kHour * 9 - milliseconds(1)), Due::kNothing);
  EXPECT_EQ(HeardAndDueAt(kHour * 9 + milliseconds(1000)), Due::kAge);
}

TEST_F(LifetimeTest, WithLittleLeftItStaysUntilTheExpiry) {
  for (const milliseconds left : {milliseconds(kBeforeExpiry), milliseconds(kNearlyOver)}) {
    Open(milliseconds(0), left, 65'535);
    EXPECT_EQ(HeardAndDueAt(left - milliseconds(1)), Due::kNothing);
    EXPECT_EQ(HeardAndDueAt(left), Due::kExpired);
  }
  Open(milliseconds(0), kNearlyOver + milliseconds(1000));
  EXPECT_EQ(HeardAndDueAt(kBeforeExpiry), Due::kNothing);
  EXPECT_EQ(HeardAndDueAt(kBeforeExpiry + milliseconds(1000)), Due::kAge);
}

TEST_F(LifetimeTest, TheExpiryIsLookedAtEveryMinute) {
  Open(milliseconds(0), kYear);
  lifetime_.NoteHeard(kStart + kExpiryLook);
  EXPECT_EQ(lifetime_.Take(kStart + kExpiryLook - milliseconds(1), false), Due::kNothing);
  EXPECT_LE(lifetime_.next(kStart), kStart + kExpiryLook);
  EXPECT_EQ(lifetime_.Take(kStart + kExpiryLook, false), Due::kLookAtExpiry);
  EXPECT_EQ(lifetime_.Take(kStart + kExpiryLook, false), Due::kNothing) << "once";
}

TEST_F(LifetimeTest, AClockThatIsSetAheadEndsItSooner) {
  Open(kHour * 24, kYear);
  lifetime_.SetExpiry(kStart + kHour, kHour);
  EXPECT_EQ(HeardAndDueAt(kHour * 2 - kBeforeExpiry - milliseconds(1)), Due::kNothing);
  EXPECT_EQ(HeardAndDueAt(kHour * 2 - kBeforeExpiry), Due::kAge);
}

TEST_F(LifetimeTest, AClockThatIsSetBackLeavesTheAge) {
  Open(kHour * 24, kHour);
  lifetime_.SetExpiry(kStart + kHour / 2, kYear);
  EXPECT_EQ(HeardAndDueAt(kHour), Due::kNothing);
  EXPECT_EQ(HeardAndDueAt(kHour * 24), Due::kAge);
}

TEST_F(LifetimeTest, AnExpiryThatHasPassedEndsItNow) {
  Open(milliseconds(0), kFarAway);
  lifetime_.SetExpiry(kStart + kHour, -kHour);
  EXPECT_EQ(HeardAndDueAt(kHour), Due::kExpired);
}

TEST_F(LifetimeTest, OnceItsAgeWasToldTheExpirySaysNothing) {
  Open(kHour, kYear);
  EXPECT_EQ(HeardAndDueAt(kHour), Due::kAge);
  lifetime_.SetExpiry(kStart + kHour, milliseconds(0));
  lifetime_.NoteHeard(kStart + kHour * 2);
  EXPECT_EQ(lifetime_.Take(kStart + kHour * 2, false), Due::kNothing);
}

TEST_F(LifetimeTest, AnAgeOfZeroIsNone) {
  Open(milliseconds(0), kYear);
  EXPECT_EQ(HeardAndDueAt(kHour * 24 * 30), Due::kNothing);
}

TEST_F(LifetimeTest, TheTimeToSettleEnds) {
  Open(milliseconds(0), kYear);
  lifetime_.EndBy(kStart + milliseconds(500));
  EXPECT_EQ(DueAt(milliseconds(499)), Due::kNothing);
  EXPECT_EQ(DueAt(milliseconds(500)), Due::kOver);
}

TEST_F(LifetimeTest, WithoutACallItIsIdle) {
  Open(milliseconds(0), kYear);
  lifetime_.SetCalls(0, kStart + milliseconds(10));
  EXPECT_EQ(HeardAndDueAt(milliseconds(9) + kIdleWait), Due::kNothing);
  EXPECT_EQ(HeardAndDueAt(milliseconds(10) + kIdleWait), Due::kIdle);
  lifetime_.SetCalls(1, kStart + milliseconds(11) + kIdleWait);
  EXPECT_EQ(HeardAndDueAt(milliseconds(12) + kIdleWait), Due::kNothing);
}

TEST_F(LifetimeTest, WhoNeverOpensAStreamGoesSoonerWhileOthersWait) {
  lifetime_.Open(kStart, milliseconds(0), kYear, 0);
  EXPECT_EQ(lifetime_.Take(kStart + kFirstStreamWaitPressed - milliseconds(1), true),
            Due::kNothing);
  EXPECT_EQ(lifetime_.Take(kStart + kFirstStreamWaitPressed, false), Due::kNothing);
  EXPECT_EQ(lifetime_.Take(kStart + kFirstStreamWaitPressed, true), Due::kNoCall);
  lifetime_.Open(kStart, milliseconds(0), kYear, 0);
  EXPECT_EQ(lifetime_.Take(kStart + kFirstStreamWait - milliseconds(1), false), Due::kNothing);
  EXPECT_EQ(lifetime_.Take(kStart + kFirstStreamWait, false), Due::kNoCall);
}

TEST_F(LifetimeTest, CallsThatNobodyServedBuyNoTime) {
  lifetime_.Open(kStart, milliseconds(0), kYear, 0);
  lifetime_.SetCalls(1, kStart + milliseconds(1));
  lifetime_.SetCalls(0, kStart + kFirstStreamWait - milliseconds(1));
  EXPECT_EQ(lifetime_.Take(kStart + kFirstStreamWait, false), Due::kNoCall);
}

TEST_F(LifetimeTest, ATimeFarAwayIsNever) {
  Open(milliseconds(0), kFarAway);
  EXPECT_EQ(HeardAndDueAt(kYear), Due::kNothing);
}

TEST_F(LifetimeTest, WhoDoesNotReadIsCutHoweverMuchItSays) {
  Open(milliseconds(0), kYear);
  lifetime_.SetBlocked(true, kBlockedWait, kStart);
  EXPECT_EQ(HeardAndDueAt(kBlockedWait - milliseconds(1)), Due::kNothing);
  EXPECT_EQ(HeardAndDueAt(kBlockedWait), Due::kNotRead);
}

TEST_F(LifetimeTest, WhoReadsAllBeginsAnewAndWhoGoesHasLess) {
  Open(milliseconds(0), kYear);
  lifetime_.SetBlocked(true, kBlockedWait, kStart);
  lifetime_.SetBlocked(false, kBlockedWait, kStart + milliseconds(1));
  EXPECT_EQ(HeardAndDueAt(kBlockedWait), Due::kNothing);
  lifetime_.SetBlocked(true, kBlockedWait, kStart + kBlockedWait);
  lifetime_.SetBlocked(true, kAgeGrace, kStart + kBlockedWait);
  EXPECT_EQ(HeardAndDueAt(kBlockedWait + kAgeGrace), Due::kNotRead);
}

TEST_F(LifetimeTest, NextIsNeverBehindWhatIsDue) {
  lifetime_.Open(kStart, kHour, kYear, 0);
  EXPECT_EQ(lifetime_.next(kStart), kStart + kFirstStreamWaitPressed);
  EXPECT_EQ(lifetime_.next(kStart + kFirstStreamWaitPressed),
            kStart + kFirstStreamWaitPressed + kLookAgain);
  lifetime_.SetCalls(1, kStart);
  EXPECT_EQ(lifetime_.next(kStart), kStart + kKeepaliveAfter);
  lifetime_.EndBy(kStart + milliseconds(7));
  EXPECT_EQ(lifetime_.next(kStart), kStart + milliseconds(7));
}

}  // namespace
}  // namespace uplink::front
