// How large a message is for the flow of its robot.
#include <string>

#include "schema/encode.h"
#include "schema/model/held_bytes.h"
#include "tests/unit/server/session/session_test.h"

namespace uplink::session {
namespace {

class FlowBytesTest : public SessionTest {
 protected:
  BenchStream& Welcomed() {
    BenchStream& stream = server().Connect(SessionOf(1));
    static_cast<void>(stream.TakeLines());
    return stream;
  }
};

TEST_F(FlowBytesTest, TheFlowCountsWhatIsKeptWhereThatIsMore) {
  model::UiCapabilities capabilities;
  for (int i = 0; i < 100; ++i) capabilities.sensors.push_back({.key = std::to_string(i)});
  const std::string payload = schema::Encode(capabilities);
  ASSERT_GT(2 * model::HeldBytes(model::Body(capabilities)), 3 * payload.size());
  limits_.allowance.flow.bytes = {.rate = 1, .burst = 2 * payload.size()};
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, payload}, {2, payload}, {3, Motion()}}));
  EXPECT_EQ(server().counts().received, 1U) << "two payloads would pass";
  EXPECT_EQ(server().robot().sessions.View().held_back, robot::HeldBack::kFlow);
  EXPECT_GT(2 * server().robot().flow.bytes_total(), 3 * payload.size());
}

TEST_F(FlowBytesTest, TheFlowCountsThePayloadWhereThatIsMore) {
  const std::string payload = Fault();
  limits_.allowance.flow.bytes = {.rate = 1, .burst = 2 * payload.size()};
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame(Messages(1, 3, payload)));
  EXPECT_EQ(server().counts().received, 2U);
  EXPECT_EQ(server().robot().flow.bytes_total(), 2 * payload.size());
}

}  // namespace
}  // namespace uplink::session
