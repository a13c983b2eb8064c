// Whatever comes in whatever order, no bound is passed and nothing aborts.
#include <array>
#include <cstdint>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "schema/limits.h"
#include "tests/unit/server/cyberwave/applying.h"

namespace uplink::cyberwave {
namespace {

/// Draws messages of a twin; most are good, and their names and sizes reach the bounds.
class Messages {
 public:
  explicit Messages(std::uint32_t seed) : random_(seed) {}

  struct Message {
    std::string tail;
    std::string payload;
  };

  Message Next() {
    switch (Below(17)) {
      case 0:
        return {"position", Body(R"("position":{"x":1,"y":2,"z":)" + Number() + "}")};
      case 1:
        return {"rotation", Body(R"("rotation":{"w":)" + Number() + "}")};
      case 2:
        return {"scale", Body(R"("scale":{"x":1,"y":2,"z":)" + Number() + "}")};
      case 3:
        return {"joint/update", Body(R"("positions":{)" + Members(Below(300)) + "}")};
      case 4:
        return {"joint/update", Body(R"("joint_name":)" + Name() +
                                     R"(,"joint_state":{"position":)" + Number() + "}")};
      case 5:
        return {"metrics", Body(R"("metrics":{)" + Name() + ":{" + Members(Below(200)) +
                                R"(},"errors":[)" + Texts(Below(70)) + "]}")};
      case 6:
        return {"edge_health", Body(R"("edge_id":)" + Name() +
                                    R"(,"uptime_seconds":1,"streams":{)" + Streams() + "}")};
      case 7:
        return {"gps",
                Body(R"("latitude":1,"longitude":)" + Number() + R"(,"fix_type":)" + Name())};
      case 8:
        return {"battery/status", Body(R"("percentage":)" + Number())};
      case 9:
        return {"telemetry",
                Body(R"("telemetry_type":)" + Name() + R"(,"data":{)" + Members(Below(800)) + "}")};
      case 10:
        return {"telemetry", Body(R"("sensor":)" + Name() + R"(,"type":")" + Mark() + "\"")};
      case 11:
        return {"telemetry", Body(Below(2) == 0 ? R"("type":"motor_status",)" + Members(100)
                                                : R"("type":"driver_info",)" + Members(100))};
      case 12:
        return {"command", Body(R"("command":)" + Name() + R"(,"status":)" + Name())};
      case 13:
        return {"webrtc-offer", Name()};
      case 14:
        return {"depth", Name()};
      case 15:
        return {"ping", R"({"type":"ping"})"};
      default:
        return {"event", Name().substr(Below(4))};
    }
  }

  std::size_t Below(std::size_t end) {
    return std::uniform_int_distribution<std::size_t>(0, end - 1)(random_);
  }

 private:
  std::string Body(const std::string& members) {
    constexpr std::array kSources = {"edge", "edge_leader", "edge_follower", "sim",
                                     "tele", "sim_tele",    "edit",          "other"};
    std::string body = "{" + members;
    if (Below(3) > 0) body.append(R"(,"source_type":")").append(kSources.at(Below(8))).append("\"");
    if (Below(2) > 0) body.append(R"(,"session_id":)").append(Name());
    if (Below(2) > 0) body.append(R"(,"timestamp":)").append(std::to_string(Below(1000)));
    return body + "}";
  }
  /// Of few names, now and then of many; short or as long as a name may be, with characters that
  /// grow when they are replaced.
  std::string Name() {
    std::string name = std::to_string(Below(Below(3) == 0 ? 5'000 : 40));
    const std::size_t bytes = Below(4) == 0 ? Below(schema::kNameBytesMax) : 0;
    while (name.size() < bytes) name += '\x7f';
    return "\"" + name + "\"";
  }
  std::string Number() { return std::to_string(static_cast<int>(Below(400)) - 100); }
  std::string Mark() {
    constexpr std::array kMarks = {"connected", "telemetry_start", "telemetry_end", "disconnected",
                                   "initial_observation"};
    return kMarks.at(Below(kMarks.size()));
  }
  std::string Members(std::size_t count) {
    std::string members = R"("m":1)";
    for (std::size_t i = 0; i < count; ++i)
      members.append(",").append(Name()).append(":").append(Number());
    return members;
  }
  std::string Texts(std::size_t count) {
    std::string texts = Name();
    for (std::size_t i = 1; i < count; ++i) texts.append(",").append(Name());
    return texts;
  }
  std::string Streams() {
    std::string streams = R"("s":{})";
    for (std::size_t i = Below(70); i > 0; --i) {
      streams.append(",")
          .append(Name())
          .append(R"(:{"connection_state":)")
          .append(Name())
          .append("}");
    }
    return streams;
  }

  std::mt19937 random_;
};

void ExpectWithinBounds(const TwinState& state) {
  const TwinParts& parts = state.parts();
  for (std::size_t group = 0; group < kJointGroups; ++group) {
    ASSERT_LE(parts.joints.Of(static_cast<JointGroup>(group)).size(), kJointNamesMax);
  }
  ASSERT_LE(parts.metrics.size(), kMetricCategoriesMax);
  ASSERT_LE(parts.edges.size(), kEdgesMax);
  ASSERT_LE(parts.reports.size(), kReportsMax);
  ASSERT_LE(parts.metrics.bytes(), kTableBytesMax);
  ASSERT_LE(parts.edges.bytes(), kTableBytesMax);
  ASSERT_LE(parts.reports.bytes(), kTableBytesMax);
  ASSERT_LE(parts.sessions.sessions().size(), kMarkedSessionsMax);
  for (const auto& [id, session] : parts.sessions.sessions()) {
    ASSERT_LE(session.ended_streams.size(), kEndedStreamsMax);
  }
  ASSERT_LE(state.faults().active().size(), kMetricFaultsMax);
  ASSERT_LE(state.held_bytes(), kTwinBytesMax);
  ASSERT_GT(state.held_bytes(), HeldBytes(parts));
}

class TwinRandomTest : public ::testing::TestWithParam<std::uint32_t> {};

TEST_P(TwinRandomTest, NoBoundIsPassed) {
  Messages messages(GetParam());
  test::AppliedTwin twin;
  std::array<std::size_t, 6> outcomes{};
  for (int i = 0; i < 1'500; ++i) {
    const auto [tail, payload] = messages.Next();
    const Applied applied = twin.Publish(tail, payload);
    ++outcomes.at(static_cast<std::size_t>(applied.outcome));
    ASSERT_LE(applied.records.size(), kRecordsOfMessageMax);
    ASSERT_LE(applied.dropped.size(), schema::kDroppedFieldsListedMax);
    ASSERT_EQ(applied.records.empty(), applied.outcome != Outcome::kStored);
    if (i % 50 == 0) {
      ExpectWithinBounds(twin.Of(RobotKind::kReal));
      ExpectWithinBounds(twin.Of(RobotKind::kSimulated));
    }
    twin.clock.Advance(milliseconds(messages.Below(20)));
  }
  for (const std::size_t count : outcomes) EXPECT_GT(count, 0U) << "every outcome is reached";
  EXPECT_EQ(twin.real().joints.Of(JointGroup::kEdge).size(), kJointNamesMax)
      << "bounds are reached";
  EXPECT_EQ(twin.real().edges.size(), kEdgesMax);
}

INSTANTIATE_TEST_SUITE_P(Seeds, TwinRandomTest, ::testing::Values(1U, 2U, 3U, 4U));

TEST(TwinBytesTest, AFullTwinIsWithinItsBoundAndIsCounted) {
  test::AppliedTwin twin;
  const auto name = [](std::size_t i) {
    std::string text = std::to_string(i);
    text.resize(schema::kNameBytesMax, '\x7f');
    return "\"" + text + "\"";
  };
  const std::size_t empty = HeldBytes(twin.real());
  for (const std::string source : {"edge_leader", "edge_follower"}) {
    for (std::size_t i = 0; i < kJointNamesMax; ++i) {
      std::string payload = R"({"joint_state":{"position":1},"source_type":")";
      payload.append(source).append(R"(","joint_name":)").append(name(i)).append("}");
      ASSERT_EQ(twin.Say("joint/update", payload), Outcome::kApplied);
    }
  }
  const std::size_t joints = HeldBytes(twin.real()) - empty;
  EXPECT_GT(joints, 2 * kJointNamesMax * 3 * schema::kNameBytesMax);
  for (std::size_t i = 0; i < 64; ++i) {
    const std::string large = R"("data":{"text":")" + std::string(60'000, '\x7f') + R"("}})";
    ASSERT_EQ(twin.Say("telemetry", R"({"telemetry_type":")" + std::to_string(i) + "\"," + large),
              Outcome::kApplied);
  }
  EXPECT_LE(twin.real().reports.bytes(), kTableBytesMax);
  EXPECT_GE(twin.real().reports.size(), 2U) << "the largest reports have room";
  EXPECT_LE(HeldBytes(twin.real()), kTwinBytesMax);
}

}  // namespace
}  // namespace uplink::cyberwave
