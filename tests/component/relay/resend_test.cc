// What a robot is asked for, over the wire.
#include <optional>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/encode.h"
#include "tests/support/relay_world.h"
#include "tests/unit/schema/samples.h"

namespace uplink::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::Optional;

/// The kinds that the next ResendRequest names; nothing if the call ends before it.
std::optional<std::vector<int>> NextRequest(TestAgent& agent) {
  while (const auto frame = agent.Read()) {
    if (!frame->has_resend_request()) continue;
    const auto& kinds = frame->resend_request().kinds();
    return std::vector<int>(kinds.begin(), kinds.end());
  }
  return std::nullopt;
}

TEST(ResendRequests, NameWhatTheStoreLacksAndNothingElse) {
  RelayWorld world;
  TestAgent first(world.Channel(RuriOf(1)));
  ASSERT_TRUE(first.Connect(SessionOf(1)));
  EXPECT_THAT(NextRequest(first),
              Optional(ElementsAre(v1::RESEND_KIND_AGENT_INFO, v1::RESEND_KIND_CURRENT_SETTINGS,
                                   v1::RESEND_KIND_UI_CAPABILITIES)));
  first.Send(BatchFrame({{1, schema::Encode(test::SampleAgentInfo())},
                         {2, schema::Encode(test::SampleSettings())},
                         {3, schema::Encode(test::SampleCapabilities())}}));
  ASSERT_TRUE(first.ReadThrough(3));
  for (const metrics::Cell& unanswered : world.session_probe.resend_unanswered) {
    EXPECT_EQ(unanswered.value(), 0);
  }
  first.HalfClose();
  EXPECT_TRUE(first.End().ok());

  TestAgent again(world.Channel(RuriOf(1)));
  ASSERT_TRUE(again.Connect(SessionOf(2)));
  TestAgent later(world.Channel(RuriOf(2)));
  ASSERT_TRUE(later.Connect(SessionOf(1)));
  later.Send(BatchFrame({{1, schema::Encode(test::SampleSettings())}}));
  EXPECT_THAT(NextRequest(later),
              Optional(ElementsAre(v1::RESEND_KIND_AGENT_INFO, v1::RESEND_KIND_UI_CAPABILITIES)));
  // It came first, and would have been asked by now.
  again.HalfClose();
  EXPECT_TRUE(again.End().ok());
  for (const v1::RelayResponse& frame : again.frames()) EXPECT_FALSE(frame.has_resend_request());
}

}  // namespace
}  // namespace uplink::testing
