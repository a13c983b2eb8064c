#include "server/view/message_wire.h"

#include <string>
#include <utility>

#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include "server/view/json.h"
#include "server/view/rows_json.h"
#include "uplink/v1/fleet.pb.h"

namespace uplink::view {
namespace {

constexpr const char* kDetail =
    R"({"text":"ä \"q\"","number":-1.5,"whole":9007199254740991,"big":18446744073709551615,)"
    R"("yes":true,"no":false,"nothing":null,"list":[1,"a",[],{}],"object":{"a":{"b":[{"c":0}]}}})";

storage::EventRow EventWith(std::string detail) {
  storage::EventRow row;
  row.robot.ruri = "rcan://a";
  row.kind = "modeChanged";
  row.detail_json = std::move(detail);
  return row;
}

/// What a reader of the JSON has.
template <typename Message>
Message FromJson(const std::string& json) {
  Message message;
  EXPECT_TRUE(google::protobuf::util::JsonStringToMessage(json, &message).ok()) << json;
  return message;
}

template <typename Message>
Message FromWire(const std::string& wire) {
  Message message;
  EXPECT_TRUE(message.ParseFromString(wire));
  return message;
}

TEST(MessageWire, SaysWhatTheJsonSays) {
  storage::Page<storage::EventRow> page;
  page.next_token = "t";
  for (const char* detail : {kDetail, "{}", R"({"a":"b"})"}) page.rows.push_back(EventWith(detail));
  const auto json = FromJson<v1::ListEventsResponse>(*Encode(Form::kJson, page));
  const auto wire = FromWire<v1::ListEventsResponse>(*Encode(Form::kWire, page));
  EXPECT_EQ(wire.SerializeAsString().size(), json.SerializeAsString().size());
  EXPECT_EQ(wire.DebugString(), json.DebugString());
  EXPECT_EQ(wire.events(0).detail().fields().at("text").string_value(), "ä \"q\"");
}

TEST(MessageWire, AnEmptyListIsItsResponse) {
  storage::Page<storage::GapRow> page;
  EXPECT_EQ(*Encode(Form::kWire, page), "");
  page.next_token = "next";
  EXPECT_EQ(FromWire<v1::ListGapsResponse>(*Encode(Form::kWire, page)).next_page_token(), "next");
}

TEST(MessageWire, ATextThatIsNoObjectIsAnEmptyOne) {
  storage::Page<storage::EventRow> page;
  page.rows.push_back(EventWith("no json"));
  const auto wire = FromWire<v1::ListEventsResponse>(*Encode(Form::kWire, page));
  ASSERT_EQ(wire.events_size(), 1);
  EXPECT_TRUE(wire.events(0).has_detail());
  EXPECT_EQ(wire.events(0).detail().fields_size(), 0);
}

TEST(MessageWire, BytesAreBytes) {
  storage::Page<storage::QuarantineRow> page;
  page.rows.emplace_back().payload = std::string("\0\xFF", 2);
  const auto wire =
      FromWire<v1::ListQuarantineResponse>(*Encode(Form::kWire, QuarantineView{page, {}}));
  ASSERT_EQ(wire.quarantined_size(), 1);
  EXPECT_EQ(wire.quarantined(0).payload(), std::string("\0\xFF", 2));
}

}  // namespace
}  // namespace uplink::view
