#include "tools/uplinkctl/verbs/records.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/base/rfc3339.h"
#include "tests/unit/tools/uplinkctl/fake_api.h"
#include "tools/uplinkctl/verbs/payload_text.h"

namespace uplink::ctl {
namespace {

using ::testing::HasSubstr;

const SystemTime kNow = *FromRfc3339("2026-05-01T12:30:00Z");

TEST(Status, IsAPageForPeople) {
  const auto status = boost::json::parse(R"({"version":"0.1.0","startedAt":"2026-05-01T10:30:00Z",
    "now":"2026-05-01T12:30:00Z","robots":{"online":"198","offline":"2","unknown":"0"},
    "streams":"1200","journalRecords":"3","journalBytes":"2048","journalOldestMs":"1500",
    "degraded":["store"],"messages":{"counts":{"received":"12345","stored":"45"},
    "rejectsByReason":{}}})");
  EXPECT_EQ(StatusText(status.get_object(), {kNow, {}}),
            "version        0.1.0\n"
            "up for         2 h\n"
            "does not work  store\n"
            "robots         198 online, 2 offline\n"
            "streams        1,200\n"
            "messages       12,345 received, 45 stored\n"
            "rejected       none\n"
            "journal        3 records, 2.0 KiB, the oldest waits for 1 s\n");
}

TEST(Payload, IsShownInHexWithItsAscii) {
  EXPECT_EQ(HexText("uplinkd\n"),
            "00000000  75 70 6c 69 6e 6b 64 0a                           uplinkd.\n");
  EXPECT_EQ(HexText("0123456789abcdefX"),
            "00000000  30 31 32 33 34 35 36 37  38 39 61 62 63 64 65 66  0123456789abcdef\n"
            "00000010  58                                                X\n");
}

TEST(Payload, IsDecodedByItsSource) {
  EXPECT_EQ(DecodedText("cyberwave", R"({"a":1})"), "{\n  \"a\": 1\n}\n");
  EXPECT_EQ(DecodedText("cyberwave", "\x1b{"), "no JSON: \\x1b{\n");
  EXPECT_EQ(DecodedText("uncrew", std::string("\x08\x07", 2)), "1: 7\n");
  EXPECT_THAT(DecodedText("uncrew", std::string("\x08\x07\xff", 3)), HasSubstr("until there"));
  EXPECT_THAT(DecodedText("uplink", "12345678"), HasSubstr("it cannot be read"));
  EXPECT_EQ(DecodedText("uplink", ""), "the payload was not kept\n");
  EXPECT_THAT(DecodedText("other", "x"), HasSubstr("does not know"));
}

class MissionsShow : public ::testing::Test {
 protected:
  MissionsShow() { screen_.clock.SetSystem(kNow); }

  absl::StatusOr<std::string> Text(const std::string& robot = "") {
    Api api = server_.MakeApi();
    return MissionText("run-1", robot, Format::kTable, api, screen_.Make());
  }

  FakeServer server_;
  FakeScreen screen_;
};

TEST_F(MissionsShow, HasTheRunAndItsReports) {
  server_.Answer(200, R"({"missions":[{"ruri":"rcan://a","runId":"run-1","status":"error",
                          "latest":{"x":1}}],"nextPageToken":""})");
  server_.Answer(200, R"({"missionReports":[{"status":"error","receivedAt":"2026-05-01T12:29:00Z",
                          "report":{"statusMessage":"stuck"}}],"nextPageToken":""})");
  const auto text = Text();
  ASSERT_TRUE(text.ok()) << text.status();
  EXPECT_THAT(*text, HasSubstr("status  error\n"));
  EXPECT_THAT(*text, HasSubstr("2026-05-01 12:29:00Z  1 min  error   stuck"));
  EXPECT_EQ(server_.asked.at(1),
            "/api/v1/mission-reports?runId=run-1&orderBy=oldest&pageSize=1000");
}

TEST_F(MissionsShow, ARunOfSeveralRobotsAsksForOne) {
  server_.Answer(200,
                 R"({"missions":[{"ruri":"rcan://a"},{"ruri":"rcan://b"}],"nextPageToken":""})");
  const absl::Status status = Text().status();
  EXPECT_TRUE(absl::IsInvalidArgument(status));
  EXPECT_THAT(std::string(status.message()), HasSubstr("--robot: rcan://a, rcan://b"));
}

TEST_F(MissionsShow, ARunThatIsNotThereSaysWhereToLook) {
  server_.Answer(200, R"({"missions":[],"nextPageToken":""})");
  EXPECT_TRUE(absl::IsNotFound(Text().status()));
}

}  // namespace
}  // namespace uplink::ctl
