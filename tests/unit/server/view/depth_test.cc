// How deep what robots said may be: clients read a page with it by protobuf's own parsers, which
// end at messages 100 deep, and of JSON sooner.
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include "schema/cyberwave/limits.h"
#include "server/view/json.h"
#include "server/view/rows_json.h"
#include "tests/unit/server/cyberwave/applying.h"

namespace uplink::view {
namespace {

using ::testing::HasSubstr;

/// A value of so many levels, each an object, or objects and lists alternately.
enum class Levels { kObjects, kBoth };
std::string Nested(std::size_t depth, Levels levels) {
  std::string value = "1";
  for (std::size_t i = 0; i < depth; ++i) {
    const bool list = levels == Levels::kBoth && i % 2 == 1;
    value.insert(0, list ? "[" : R"({"a":)").append(list ? "]" : "}");
  }
  return value;
}

/// Whether a client can read an answer, as JSON and on the wire, and what it then has.
template <typename Response>
Response ExpectReadable(const absl::StatusOr<std::string>& json, std::size_t depth) {
  Response read;
  EXPECT_TRUE(json.ok()) << json.status();
  if (!json.ok()) return read;
  EXPECT_TRUE(google::protobuf::util::JsonStringToMessage(*json, &read).ok()) << depth << *json;
  Response again;
  EXPECT_TRUE(again.ParseFromString(read.SerializeAsString())) << depth;
  return read;
}

/// A page with the twin.
absl::StatusOr<std::string> PageOf(const test::AppliedTwin& twin) {
  RobotsPage page;
  RobotView& robot = page.robots.emplace_back();
  robot.twin = std::make_shared<const cyberwave::TwinParts>(twin.real());
  PartSet parts;
  parts.Add(Part::kCyberwave);
  return ToJson(page, parts);
}

struct Live {
  std::string tail;
  /// What stands before and behind the deep value.
  std::string before;
  std::string behind;
};
const std::vector<Live> kLive = {
    {"telemetry", R"({"type":"motor_status","v":)", "}"},
    {"telemetry", R"({"type":"driver_info","v":)", "}"},
    {"telemetry", R"({"telemetry_type":"x","data":{"v":)", "}}"},
    {"event", R"({"event_type":"robot_state","data":{"v":)", "}}"},
    {"metrics", R"({"metrics":{"v":)", "}}"},
};

TEST(DepthTest, EveryPageWithALiveTwinCanBeRead) {
  for (const Live& live : kLive) {
    for (const Levels levels : {Levels::kObjects, Levels::kBoth}) {
      for (std::size_t depth = 1; depth <= cyberwave::kDepthMax - 2; ++depth) {
        test::AppliedTwin twin;
        const std::string payload = live.before + Nested(depth, levels) + live.behind;
        EXPECT_EQ(twin.Say(live.tail, payload), cyberwave::Outcome::kApplied) << payload;
        const auto page = ExpectReadable<v1::ListRobotsResponse>(PageOf(twin), depth);
        EXPECT_TRUE(page.robots(0).has_cyberwave());
      }
    }
  }
}

TEST(DepthTest, WhatIsDeeperIsDroppedAloneAndTold) {
  const auto dropped = [](std::size_t depth) {
    return test::JudgeOn("telemetry", R"({"type":"motor_status","ok":1,"v":)" +
                                          Nested(depth - 1, Levels::kObjects) + "}");
  };
  EXPECT_THAT(dropped(cyberwave::kShownDepthMax).dropped, ::testing::IsEmpty());
  const cyberwave::Judgement deep = dropped(cyberwave::kShownDepthMax + 1);
  ASSERT_EQ(deep.dropped.size(), 1U);
  EXPECT_EQ(deep.dropped[0].reason, model::RejectReason::kMalformed);
  EXPECT_THAT(deep.dropped[0].field, HasSubstr("v.a.a"));
  EXPECT_THAT(deep.dropped[0].detail, HasSubstr("24"));
  const auto report = test::BodyOf<model::cyberwave::Report>(deep);
  EXPECT_THAT(report.detail, HasSubstr(R"("ok":1)"));
  EXPECT_THAT(report.detail, HasSubstr(R"({"a":null})"));
}

TEST(DepthTest, ADurableMessageKeepsItAsText) {
  for (const Levels levels : {Levels::kObjects, Levels::kBoth}) {
    for (std::size_t depth = 1; depth < cyberwave::kDepthMax; ++depth) {
      const std::string deep = R"({"event_type":"e","v":)" + Nested(depth, levels) + "}";
      const auto event = test::BodyOf<model::cyberwave::Event>(test::JudgeOn("event", deep));
      storage::Page<storage::EventRow> events;
      events.rows.emplace_back().detail_json = event.detail;
      const auto page = ExpectReadable<v1::ListEventsResponse>(ToJson(events), depth);
      EXPECT_EQ(page.events(0).detail().fields_size(), 2) << depth;

      storage::Page<storage::MessageRow> messages;
      messages.rows.emplace_back().message.detail_json = event.detail;
      ExpectReadable<v1::ListMessagesResponse>(ToJson(messages), depth);
      storage::Page<storage::ScopeUpdateRow> updates;
      updates.rows.emplace_back().update.detail_json = event.detail;
      ExpectReadable<v1::ListScopeUpdatesResponse>(ToJson(updates), depth);
    }
  }
}

}  // namespace
}  // namespace uplink::view
