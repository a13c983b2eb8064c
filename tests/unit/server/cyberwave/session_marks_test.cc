// What marks say of sessions, in whatever order they come.
#include "server/cyberwave/session_marks.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::cyberwave {
namespace {

using model::cyberwave::Mark;
using model::cyberwave::MarkKind;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using enum model::cyberwave::MarkKind;

Mark Boundary(MarkKind kind) { return {.kind = kind, .recording_boundary = true}; }

class SessionMarksTest : public ::testing::Test {
 protected:
  const MarkedSession& Take(const Mark& mark, std::int64_t timestamp_us = 0) {
    marks_.Take(mark, "s", {.timestamp_us = timestamp_us});
    return marks_.sessions().back().second;
  }

  SessionMarks marks_;
};

TEST_F(SessionMarksTest, BothEndsComeInEitherOrderAndAgain) {
  Take({.kind = kConnected});
  EXPECT_EQ(Take({.kind = kTelemetryStart}).telemetry, true);
  EXPECT_EQ(Take({.kind = kTelemetryStart}).connected, true);
  EXPECT_EQ(Take({.kind = kTelemetryEnd}).telemetry, false);
  EXPECT_EQ(Take({.kind = kTelemetryEnd}).connected, true) << "telemetry alone ended";
  EXPECT_EQ(Take({.kind = kDisconnected}).connected, false);
  Take({.kind = kConnected});
  Take({.kind = kTelemetryStart});
  EXPECT_EQ(Take({.kind = kDisconnected}).telemetry, false) << "who is gone sends nothing";
  EXPECT_EQ(Take({.kind = kTelemetryEnd}).connected, false);
  EXPECT_EQ(Take({.kind = kTelemetryStart}).connected, true) << "no mark says connected anew";
}

TEST_F(SessionMarksTest, AnEndThatNamesAStreamEndsThatOne) {
  Take({.kind = kTelemetryStart});
  EXPECT_EQ(Take({.kind = kTelemetryEnd, .sensor = "front"}).telemetry, true);
  EXPECT_THAT(Take({.kind = kTelemetryEnd, .sensor = "back"}).ended_streams,
              ElementsAre("front", "back"));
  EXPECT_THAT(Take({.kind = kTelemetryEnd, .sensor = "back"}).ended_streams,
              ElementsAre("front", "back"));
  EXPECT_THAT(Take({.kind = kTelemetryStart, .sensor = "front"}).ended_streams,
              ElementsAre("back"));
  EXPECT_THAT(Take({.kind = kTelemetryStart}).ended_streams, IsEmpty());
  for (std::size_t i = 0; i <= kEndedStreamsMax; ++i) {
    Take({.kind = kTelemetryEnd, .sensor = std::to_string(i)});
  }
  EXPECT_EQ(marks_.sessions().back().second.ended_streams.size(), kEndedStreamsMax);
  EXPECT_EQ(marks_.sessions().back().second.ended_streams.front(), "1");
}

TEST_F(SessionMarksTest, ACutOfARecordingStartsAndEndsNothing) {
  EXPECT_EQ(Take(Boundary(kTelemetryStart)).telemetry, std::nullopt);
  EXPECT_EQ(Take(Boundary(kTelemetryStart)).connected, std::nullopt);
  Take({.kind = kTelemetryStart});
  EXPECT_EQ(Take(Boundary(kTelemetryEnd)).telemetry, true);
  EXPECT_EQ(Take(Boundary(kConnected)).connected, true) << "of starts and ends alone";
}

TEST_F(SessionMarksTest, AnInitialObservationChangesNeither) {
  const MarkedSession& session = Take({.kind = kInitialObservation});
  EXPECT_EQ(session.connected, std::nullopt);
  EXPECT_EQ(session.telemetry, std::nullopt);
  EXPECT_EQ(session.last, kInitialObservation);
}

TEST_F(SessionMarksTest, ALateMarkChangesNothing) {
  Take({.kind = kDisconnected}, 100);
  EXPECT_EQ(Take({.kind = kConnected}, 99).connected, false);
  EXPECT_EQ(Take({.kind = kConnected}).connected, true) << "without a time it is the latest";
  EXPECT_EQ(Take({.kind = kDisconnected}, 99).connected, true) << "and no time goes back";
}

TEST_F(SessionMarksTest, TheSessionHeardLeastRecentlyGoes) {
  for (std::size_t i = 0; i < kMarkedSessionsMax; ++i) {
    marks_.Take({.kind = kConnected}, std::to_string(i), {});
  }
  marks_.Touch("0");
  marks_.Touch("unknown");
  marks_.Take({.kind = kConnected}, "new", {});
  EXPECT_EQ(marks_.sessions().size(), kMarkedSessionsMax);
  EXPECT_EQ(marks_.sessions().front().first, "2");
}

}  // namespace
}  // namespace uplink::cyberwave
