// No message that is live takes memory on its way through the session.
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "schema/encode.h"
#include "tests/unit/server/session/allocation_counter.h"
#include "tests/unit/server/session/session_bench.h"

namespace uplink::session {
namespace {

std::string Status(const std::string& text) {
  model::StatusTelemetry status;
  status.unix_time_ms = 1'763'683'200'000;
  status.battery = model::BatteryStatus();
  status.battery->soc_pct = 50.0F;
  status.mode = model::RobotMode::kAuto;
  status.status = text;
  return schema::Encode(status);
}

class AllocationTest : public ::testing::Test {
 protected:
  /// Frames of these payloads alternately, numbered on, serialized beforehand.
  std::vector<std::string> Frames(const std::vector<std::string>& payloads, std::size_t frames,
                                  std::size_t frame_messages) {
    std::vector<std::string> made;
    for (std::size_t i = 0; i < frames; ++i) {
      std::vector<Message> messages;
      for (std::size_t m = 0; m < frame_messages; ++m) {
        ++seq_;
        messages.push_back({seq_, payloads[seq_ % payloads.size()]});
      }
      made.push_back(BatchFrame(messages).SerializeAsString());
    }
    return made;
  }

  /// Allocations within the session while it takes these frames.
  std::size_t AllocationsFor(BenchStream& stream, const std::vector<std::string>& frames) {
    const std::size_t before = AllocationsSoFar();
    for (const std::string& frame : frames) stream.session().OnFrame(frame);
    return AllocationsSoFar() - before;
  }

  /// Acks are protobuf's messages and wait for their write: none comes within so many messages.
  static constexpr std::size_t kBetweenAcks = 60;

  /// After a warm-up and an Ack.
  std::size_t Measure(const std::vector<std::string>& payloads, std::size_t frame_messages) {
    BenchServer server(clock_, database_, 1, {});
    BenchStream& stream = server.Connect(SessionOf(1));
    for (int i = 0; i < 10; ++i) {
      for (const std::string& frame : Frames(payloads, 64 / frame_messages, frame_messages)) {
        stream.SendBytes(frame);
      }
      server.Pass(std::chrono::seconds(2));
    }
    return AllocationsFor(stream, Frames(payloads, kBetweenAcks / frame_messages, frame_messages));
  }

  testing::ManualClock clock_;
  testing::FakeDatabase database_;
  model::Seq seq_ = 0;
};

TEST_F(AllocationTest, TheCounterCounts) {
  const std::size_t before = AllocationsSoFar();
  const auto memory = std::make_unique<std::string>(100, 'x');
  EXPECT_EQ(AllocationsSoFar(), before + 2);
}

TEST_F(AllocationTest, MotionAndStatusTakeNone) {
  EXPECT_EQ(Measure({Motion(47), Status("charging"), Motion(48)}, 1), 0U);
}

TEST_F(AllocationTest, NorDoTheyInFramesOfMany) {
  EXPECT_EQ(Measure({Motion(47), Status("charging")}, 30), 0U);
}

TEST_F(AllocationTest, NorDoesALongText) {
  EXPECT_EQ(Measure({Status(std::string(100, 't')), Motion(47)}, 1), 0U);
  EXPECT_EQ(Measure({Status(std::string(100, 't')), Motion(47)}, 20), 0U);
}

TEST_F(AllocationTest, ADurableMessageDoes) { EXPECT_GT(Measure({Fault()}, 1), 0U); }

}  // namespace
}  // namespace uplink::session
