#include "tools/uplinkctl/ask/api.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/tools/uplinkctl/fake_api.h"
#include "tools/uplinkctl/ask/robot_names.h"

namespace uplink::ctl {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kStoreAway =
    R"({"error":{"code":"UNAVAILABLE","message":"the store is away"}})";

std::string Words(const absl::Status& status) { return std::string(status.message()); }

TEST(Api, AListIsAskedPageByPageUpToTheLimit) {
  FakeServer server;
  server.Answer(200, R"({"gaps":[{"a":1},{"a":2}],"nextPageToken":"t/1"})");
  server.Answer(200, R"({"gaps":[{"a":3}],"nextPageToken":"t2","total":"9"})");
  Api api = server.MakeApi("/fleet");
  const auto rows = api.List("/api/v1/gaps", "gaps", {{"fleet", "a b"}}, 3);
  ASSERT_TRUE(rows.ok()) << rows.status();
  EXPECT_EQ(rows->rows.size(), 3U);
  EXPECT_TRUE(rows->more);
  EXPECT_EQ(rows->beside, boost::json::object({{"total", "9"}}));
  EXPECT_THAT(server.asked,
              ElementsAre("/fleet/api/v1/gaps?fleet=a%20b&pageSize=3",
                          "/fleet/api/v1/gaps?fleet=a%20b&pageSize=1&pageToken=t%2F1"));
}

TEST(Api, APageMayBeEmptyBeforeTheLastOne) {
  FakeServer server;
  server.Answer(200, R"({"gaps":[],"nextPageToken":"t"})");
  server.Answer(200, R"({"gaps":[{"a":1}],"nextPageToken":""})");
  Api api = server.MakeApi();
  const auto rows = api.List("/g", "gaps", {}, 10);
  ASSERT_TRUE(rows.ok()) << rows.status();
  EXPECT_EQ(rows->rows.size(), 1U);
  EXPECT_FALSE(rows->more);
}

TEST(Api, ErrorsSayWhatToTry) {
  FakeServer server;
  server.Fail(absl::UnavailableError("http://127.0.0.1:1/x: connect: Connection refused"));
  server.Answer(503, kStoreAway, "2");
  server.Answer(503, kStoreAway);
  server.Answer(504, R"({"error":{"code":"DEADLINE_EXCEEDED","message":"too long"}})");
  server.Answer(400, R"({"error":{"code":"INVALID_ARGUMENT","message":"no q","field":"q"}})");
  server.Answer(404, R"({"error":{"code":"NOT_FOUND","message":"no such robot"}})");
  Api api = server.MakeApi();
  const absl::Status down = api.Get("/x").status();
  EXPECT_TRUE(absl::IsUnavailable(down));
  EXPECT_THAT(Words(down), HasSubstr("Connection refused; the address is that of the test"));
  EXPECT_THAT(Words(down), HasSubstr("--server"));
  EXPECT_THAT(Words(api.Get("/x").status()), HasSubstr("the store is away; try again in 2 s,"));
  EXPECT_THAT(Words(api.Get("/x").status()), HasSubstr("the store is away; try again, and see"));
  EXPECT_THAT(Words(api.Get("/x").status()), HasSubstr("--limit"));
  const absl::Status wrong = api.Get("/x").status();
  EXPECT_TRUE(absl::IsInvalidArgument(wrong));
  EXPECT_EQ(Words(wrong), "no q");
  EXPECT_TRUE(absl::IsNotFound(api.Get("/x").status()));
  server.Answer(404, R"({"error":{"code":"NOT_FOUND","message":"there is nothing at /x"}})");
  EXPECT_THAT(Words(api.Get("/x").status()), HasSubstr("older than this uplinkctl"));
}

TEST(Api, ARefusedCallerIsToldWhatToShow) {
  FakeServer server;
  server.Answer(401, R"({"error":{"code":"UNAUTHENTICATED","message":"show a token"}})");
  server.Answer(403, R"({"error":{"code":"PERMISSION_DENIED","message":"admin is needed"}})");
  server.Answer(429, R"({"error":{"code":"RESOURCE_EXHAUSTED","message":"too many"}})", "42");
  server.Fail(absl::UnauthenticatedError("https://a:1/x: TLS handshake: it is not believed"));
  Api api = server.MakeApi();
  const absl::Status nobody = api.Get("/x").status();
  EXPECT_TRUE(absl::IsUnauthenticated(nobody));
  EXPECT_THAT(Words(nobody),
              HasSubstr("show a token; show a token by --token-file FILE, UPLINKCTL"));
  const absl::Status denied = api.Get("/x").status();
  EXPECT_TRUE(absl::IsPermissionDenied(denied));
  EXPECT_THAT(Words(denied), HasSubstr("admin is needed; on the server uplinkctl tokens list"));
  const absl::Status many = api.Get("/x").status();
  EXPECT_TRUE(absl::IsResourceExhausted(many));
  EXPECT_THAT(Words(many), HasSubstr("too many; try again in 42 s, and check"));
  const absl::Status stranger = api.Get("/x").status();
  EXPECT_TRUE(absl::IsUnauthenticated(stranger));
  EXPECT_THAT(Words(stranger), HasSubstr("of the test. --ca-file FILE names"));
}

constexpr const char* kTooFast =
    R"({"error":{"code":"RESOURCE_EXHAUSTED","message":"a caller may give 5 at once"}})";

TEST(Api, ACommandThatComesTooFastIsSentAgain) {
  FakeServer server;
  server.Answer(429, kTooFast, "1");
  server.Answer(429, kTooFast, "3");
  server.Answer(200, R"({"ruri":"rcan://a"})");
  Api api = server.MakeApi();
  const auto answer = api.Post("/x", {{"ruri", "rcan://a"}});
  ASSERT_TRUE(answer.ok()) << answer.status();
  EXPECT_EQ(server.waited, std::chrono::seconds(4));
  EXPECT_EQ(server.sent, std::vector<std::string>(3, R"({"ruri":"rcan://a"})"));
}

TEST(Api, ACommandIsSentAgainSoOftenAndNotAfterALongTime) {
  FakeServer server;
  for (int i = 0; i < kCommandTriesMax; ++i) server.Answer(429, kTooFast, "1");
  Api api = server.MakeApi();
  const absl::Status over = api.Post("/x", {}).status();
  EXPECT_TRUE(absl::IsResourceExhausted(over));
  EXPECT_EQ(Words(over), "a caller may give 5 at once; try again in 1 s");
  EXPECT_EQ(server.sent.size(), static_cast<std::size_t>(kCommandTriesMax));
  for (const char* const later : {"60", "", "soon", "-1"}) {
    FakeServer other;
    other.Answer(429, kTooFast, later);
    EXPECT_TRUE(absl::IsResourceExhausted(other.MakeApi().Post("/x", {}).status())) << later;
    EXPECT_EQ(other.sent.size(), 1U) << later;
  }
}

TEST(Api, AnAnswerThatIsNotOursIsNamedSo) {
  FakeServer server;
  server.Answer(200, "<html>\x1b[2J</html>");
  server.Answer(502, "Bad gateway");
  server.Answer(200, R"({"other":[]})");
  Api api = server.MakeApi();
  EXPECT_THAT(Words(api.Get("/x").status()), HasSubstr("answers 200, and not as uplinkd does"));
  EXPECT_THAT(Words(api.Get("/x").status()), HasSubstr("answers 502"));
  EXPECT_EQ(Words(api.List("/g", "gaps", {}, 1).status()), "/g: the answer has no gaps");
}

constexpr const char* kTwo =
    R"({"robots":[{"ruri":"rcan://a/acme/rover/1.0/r17"},{"ruri":"rcan://a/acme/arm/2.0/r17"},
                  {"ruri":"rcan://a/acme/rover/1.0/r170"}],"nextPageToken":""})";

TEST(RobotNames, ARuriIsItself) {
  FakeServer server;
  Api api = server.MakeApi();
  EXPECT_EQ(*ResolveRobot(api, "rcan://a/b/c/1/r1"), "rcan://a/b/c/1/r1");
  EXPECT_TRUE(server.asked.empty());
}

TEST(RobotNames, AShortNameIsTheOneRobotThatEndsSo) {
  FakeServer server;
  for (int i = 0; i < 2; ++i) server.Answer(200, kTwo);
  Api api = server.MakeApi();
  EXPECT_EQ(*ResolveRobot(api, "r170"), "rcan://a/acme/rover/1.0/r170");
  EXPECT_EQ(*ResolveRobot(api, "2.0/r17"), "rcan://a/acme/arm/2.0/r17");
  EXPECT_EQ(server.asked.front(), "/api/v1/robots?q=r170&parts=none&pageSize=1000");
}

TEST(RobotNames, AnAmbiguousOneListsItsRobots) {
  FakeServer server;
  server.Answer(200, kTwo);
  Api api = server.MakeApi();
  const absl::Status status = ResolveRobot(api, "r17").status();
  EXPECT_TRUE(absl::IsInvalidArgument(status));
  EXPECT_EQ(Words(status),
            "2 robots are called r17: rcan://a/acme/rover/1.0/r17, rcan://a/acme/arm/2.0/r17; name "
            "one of them");
}

TEST(RobotNames, AnUnknownOneListsThoseThatAreAlike) {
  FakeServer server;
  server.Answer(200, kTwo);
  server.Answer(200, R"({"robots":[],"nextPageToken":""})");
  Api api = server.MakeApi();
  const absl::Status alike = ResolveRobot(api, "r1").status();
  EXPECT_TRUE(absl::IsNotFound(alike));
  EXPECT_THAT(Words(alike), HasSubstr("there is no robot r1 now; alike are rcan://a/acme/rover"));
  EXPECT_THAT(Words(ResolveRobot(api, "x").status()), HasSubstr("uplinkctl robots list"));
}

}  // namespace
}  // namespace uplink::ctl
