// How deep what robots said may be: a page with it is read by protobuf's own parser, which ends at
// messages 100 deep, and is shown as JSON, which ends sooner.
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/cyberwave/limits.h"
#include "server/view/json.h"
#include "server/view/messages.h"
#include "server/view/twin_json.h"
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

/// Whether a client can read the page, on the wire and as JSON.
template <typename Page>
void ExpectReadable(const Page& page, std::size_t depth) {
  Page read;
  EXPECT_TRUE(read.ParseFromString(page.SerializeAsString())) << depth;
  EXPECT_TRUE(PrintJson(page).ok()) << depth << ": " << PrintJson(page).status();
}

/// A page with the twin: its part stands in a robot where all parts stand.
v1::ListRobotsResponse PageOf(const test::AppliedTwin& twin) {
  v1::ListRobotsResponse page;
  *page.add_robots()->mutable_rcan_state() = TwinStruct(twin.real());
  return page;
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
        ExpectReadable(PageOf(twin), depth);
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
      const v1::ListEventsResponse page = ToMessage(events);
      EXPECT_EQ(page.events(0).detail().fields_size(), 2) << depth;
      ExpectReadable(page, depth);

      storage::Page<storage::MessageRow> messages;
      messages.rows.emplace_back().message.detail_json = event.detail;
      ExpectReadable(ToMessage(messages), depth);
      storage::Page<storage::ScopeUpdateRow> updates;
      updates.rows.emplace_back().update.detail_json = event.detail;
      ExpectReadable(ToMessage(updates), depth);
    }
  }
}

}  // namespace
}  // namespace uplink::view
