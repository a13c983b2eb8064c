#include "tools/uplink-fleet/report/run_figures.h"

#include <map>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "uplink/v1/relay.pb.h"

namespace uplink::synthetic {
namespace {

using ::testing::ElementsAre;
using ::testing::Pair;

TEST(SumUp, AddsTheRobotsToWhatTheyCountedTogether) {
  std::vector<RobotOutcome> robots(2);
  robots[0].sent = 3;
  robots[0].judged = 2;
  robots[1].sent = 4;
  robots[1].resent = 1;
  robots[1].notices = 5;
  Shared shared;
  shared.acked_durable.store(6);
  shared.welcomes.store(2);
  shared.first_error.Keep("the first\x1b[2J");
  const RunFigures figures = SumUp(robots, shared);
  EXPECT_EQ(figures.robots, 2U);
  EXPECT_EQ(figures.sent, 7U);
  EXPECT_EQ(figures.resent, 1U);
  EXPECT_EQ(figures.judged, 2U);
  EXPECT_EQ(figures.notices, 5U);
  EXPECT_EQ(figures.acked_durable, 6U);
  EXPECT_EQ(figures.welcomes, 2U);
  EXPECT_EQ(figures.first_error, "the first\\x1b[2J");
}

TEST(SumUp, NamesTheEndsOfStreams) {
  Shared shared;
  shared.CountEnd(0);
  shared.CountEnd(14);
  shared.CountEnd(14);
  const RunFigures figures = SumUp({}, shared);
  EXPECT_THAT(figures.ends, ElementsAre(Pair("OK", 1), Pair("UNAVAILABLE", 2)));
}

TEST(SumUp, RejectsAreNamedByTheirReason) {
  Shared shared;
  shared.CountReject(v1::REJECT_REASON_RATE_LIMITED);
  shared.CountReject(v1::REJECT_REASON_MALFORMED);
  shared.CountReject(v1::REJECT_REASON_MALFORMED);
  shared.CountReject(-1);
  shared.CountReject(99);
  EXPECT_EQ(SumUp({}, shared).rejects_by_reason,
            (std::map<std::string, std::uint64_t>{
                {"malformed", 2}, {"rate_limited", 1}, {"unknown", 2}}));
}

TEST(WasDisturbed, NeedsABreakATakeoverADrainOrAnEndThatIsNotOk) {
  RunFigures calm;
  calm.ends["OK"] = 3;
  EXPECT_FALSE(WasDisturbed(calm));
  RunFigures broken = calm;
  broken.breaks = 1;
  EXPECT_TRUE(WasDisturbed(broken));
  RunFigures taken_over = calm;
  taken_over.takeovers = 1;
  EXPECT_TRUE(WasDisturbed(taken_over));
  RunFigures drained = calm;
  drained.drains = 1;
  EXPECT_TRUE(WasDisturbed(drained));
  RunFigures ended = calm;
  ended.ends["UNAVAILABLE"] = 1;
  EXPECT_TRUE(WasDisturbed(ended));
}

}  // namespace
}  // namespace uplink::synthetic
