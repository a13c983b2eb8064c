#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/admin/actions.h"
#include "server/http/entrance.h"
#include "server/http/routes.h"
#include "server/limits/policies.h"
#include "tests/support/server_world.h"

// What operators decide, by POST.
namespace uplink::http {
namespace {

using ::testing::HasSubstr;

constexpr const char* kNorth = "rcan://example.com/north/1";
constexpr const char* kSouth = "rcan://example.com/south/1";

class HttpCommandsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    world_.AddRobot(kNorth, "north");
    world_.AddRobot(kSouth, "south");
  }

  static Request PostOf(const std::string& target, const std::string& body = {},
                        const std::string& type = "application/json") {
    Request request{Method::kPost, target};
    request.body = body;
    request.content_type = type;
    return request;
  }
  Response Post(const std::string& target, const std::string& body = {}) {
    return world_.Get(PostOf(target, body));
  }
  static identity::Caller OfNorth() {
    return {.role = identity::Role::kOperator,
            .scope = identity::Scope::Of({"north"}),
            .proof = identity::Proof::kToken,
            .name = "1f2e3d4c"};
  }

  /// The newest first.
  std::vector<storage::AuditRow> Audit() {
    world_.audit.Flush(world_.shared_access);
    const auto page = world_.reader.Audit({});
    EXPECT_TRUE(page.ok()) << page.status();
    return page.ok() ? page->rows : std::vector<storage::AuditRow>();
  }

  testing::ServerWorld world_;
};

TEST_F(HttpCommandsTest, BlocksByParameterAndByBody) {
  const Response by_parameter = Post("/api/v1/robot/block?ruri=" + std::string(kNorth));
  EXPECT_EQ(by_parameter.status, 200) << by_parameter.body;
  EXPECT_THAT(by_parameter.body, HasSubstr(R"("blocked":true)"));
  const Response by_body = Post("/api/v1/robot/block", R"({"ruri":"rcan://example.com/south/1",)"
                                                       R"("reason":"stolen"})");
  EXPECT_EQ(by_body.status, 200) << by_body.body;
  EXPECT_THAT(by_body.body, HasSubstr(R"("blockedWhy":"stolen")"));
  EXPECT_EQ(Audit().size(), 2U);
}

TEST_F(HttpCommandsTest, ABodyAndAParameterThatDifferAreRefused) {
  const Response response = Post("/api/v1/robot/block?ruri=" + std::string(kNorth),
                                 R"({"ruri":"rcan://example.com/south/1"})");
  EXPECT_EQ(response.status, 400);
  EXPECT_THAT(response.body, HasSubstr(R"("field":"ruri")"));
}

TEST_F(HttpCommandsTest, RefusesWhatIsNoJsonOrHasAnotherField) {
  const std::string target = "/api/v1/robot/block?ruri=" + std::string(kNorth);
  EXPECT_EQ(world_.Get(PostOf(target, "a=b", "application/x-www-form-urlencoded")).status, 415);
  for (const char* body : {"", "{}"}) {
    const Response untyped = world_.Get(PostOf(target, body, ""));
    EXPECT_EQ(untyped.status, 415) << "a page of any site may send it";
    EXPECT_THAT(untyped.body, HasSubstr("Content-Type: application/json"));
  }
  EXPECT_EQ(world_.Get(PostOf(target, "{}", "Application/JSON ; charset=utf-8")).status, 200);
  const Response other = Post(target, R"({"blokced":true})");
  EXPECT_EQ(other.status, 400);
  EXPECT_THAT(other.body, HasSubstr("blokced"));
  EXPECT_EQ(Post(target, "{").status, 400);
  EXPECT_EQ(Post(target + "&x=1").status, 400);
}

TEST_F(HttpCommandsTest, NamesTheFieldThatIsWrong) {
  const Response response = Post("/api/v1/robot/block");
  EXPECT_EQ(response.status, 400);
  EXPECT_THAT(response.body, HasSubstr(R"("field":"ruri")"));
}

TEST_F(HttpCommandsTest, ACallerThatIsTooFastIsToldWhenToComeAgain) {
  const std::string target = "/api/v1/robot/note?ruri=" + std::string(kNorth);
  constexpr std::uint64_t kAtOnce = limits::PolicyOf(limits::PolicyId::kCommandsOfCaller).at_once;
  for (std::uint64_t i = 0; i < kAtOnce; ++i) {
    ASSERT_EQ(Post(target, R"({"note":"x"})").status, 200) << i;
  }
  const Response over = Post(target, R"({"note":"x"})");
  EXPECT_EQ(over.status, 429);
  EXPECT_EQ(over.retry_after, std::chrono::seconds(1));
  EXPECT_THAT(over.body, HasSubstr("RESOURCE_EXHAUSTED"));
  EXPECT_THAT(over.body, HasSubstr("5 commands about robots per second, 20 at once"));
  EXPECT_THAT(world_.ScrapeText(), HasSubstr(R"(uplinkd_http_denied_total{why="rate"} 1)"));
  EXPECT_EQ(Audit().size(), 2U) << "what changed something, and what was refused";
}

TEST_F(HttpCommandsTest, APathTakesOneMethod) {
  for (const Route& route : Routes()) {
    if (route.action.empty()) continue;
    const Response get = world_.Get(std::string(route.pattern));
    EXPECT_EQ(get.status, 405) << route.pattern;
    EXPECT_EQ(get.allow, "POST");
  }
  EXPECT_EQ(Post("/api/v1/robots").status, 405);
  EXPECT_EQ(Post("/livez").status, 405);
}

TEST_F(HttpCommandsTest, ARobotOutOfScopeIsAnUnknownOne) {
  for (const char* path : {"block", "unblock", "disconnect", "note"}) {
    const std::string target = std::string("/api/v1/robot/") + path + "?ruri=rcan://example.com/";
    const std::string body = std::string(path) == "note" ? R"({"note":"x"})" : "";
    Request south = PostOf(target + "south/1", body);
    south.caller = OfNorth();
    Request unknown = PostOf(target + "other/1", body);
    unknown.caller = OfNorth();
    Response of_south = world_.Get(south);
    EXPECT_EQ(of_south.status, 404) << path;
    of_south.body.replace(of_south.body.find("south"), 5, "other");
    EXPECT_EQ(of_south.body, world_.Get(unknown).body);
    Request north = PostOf(target + "north/1", body);
    north.caller = OfNorth();
    EXPECT_EQ(world_.Get(north).status, 200) << path;
  }
}

TEST_F(HttpCommandsTest, ShowsTheAuditAndTheRevocations) {
  EXPECT_EQ(Post("/api/v1/certificates/revoke",
                 R"({"sha256":")" + std::string(64, 'a') + R"(","reason":"stolen"})")
                .status,
            200);
  EXPECT_THAT(world_.Get("/api/v1/audit?action=certificate_revoke").body,
              HasSubstr(R"("action":"certificate_revoke")"));
  EXPECT_THAT(world_.Get("/api/v1/certificates/revocations").body,
              HasSubstr(R"("reason":"stolen")"));
  EXPECT_EQ(world_.Get("/api/v1/audit?pageSize=0").status, 400);
}

TEST_F(HttpCommandsTest, AStoreThatIsAwayIs503) {
  world_.access_store.status = absl::UnavailableError("away");
  EXPECT_EQ(Post("/api/v1/robot/block?ruri=" + std::string(kNorth)).status, 503);
}

TEST_F(HttpCommandsTest, AnActiveFaultShowsWhoHasSeenIt) {
  world_.CommitFault(kNorth, {.unix_time_ms = 1, .fault_id = "E7", .source = "s", .active = true});
  const Response seen = Post("/api/v1/faults/acknowledge?faultId=E7&ruri=" + std::string(kNorth),
                             R"({"note":"on her way"})");
  EXPECT_EQ(seen.status, 200) << seen.body;
  EXPECT_THAT(seen.body, HasSubstr(R"("by":"local")"));
  EXPECT_THAT(world_.Get("/api/v1/faults?active=true").body, HasSubstr(R"("note":"on her way")"));
  EXPECT_EQ(Post("/api/v1/faults/acknowledge?faultId=E8&ruri=" + std::string(kNorth)).status, 404);
}

TEST_F(HttpCommandsTest, ABoundThatIsReachedIs409) {
  world_.access_store.status = absl::ResourceExhaustedError("too many labels");
  const Response response = Post("/api/v1/robot/block?ruri=" + std::string(kNorth));
  EXPECT_EQ(response.status, 409);
  EXPECT_THAT(response.body, HasSubstr("too many labels"));
}

TEST_F(HttpCommandsTest, ATwinHasNoStreamToDisconnect) {
  const Response response = Post(
      "/api/v1/robot/disconnect?ruri=rcan://local.rcan/cyberwave/twin/"
      "11111111-2222-4333-8444-555555555555");
  EXPECT_EQ(response.status, 409);
  EXPECT_THAT(response.body, HasSubstr("FAILED_PRECONDITION"));
  EXPECT_THAT(response.body, HasSubstr("block it"));
}

TEST_F(HttpCommandsTest, TheAuditTellsWhatARoleForbids) {
  Request request = PostOf("/api/v1/robot/block?ruri=" + std::string(kNorth));
  request.caller = OfNorth();
  request.from = "192.0.2.1";
  world_.site.NoteForbidden(request, FindRoute("/api/v1/robot/block").id);
  const std::vector<storage::AuditRow> rows = Audit();
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].outcome, "PERMISSION_DENIED");
  EXPECT_EQ(rows[0].target, kNorth);
  request.target = "/api/v1/robot/block";
  request.body = R"({"reason":"x","ruri":"rcan://example.com/\n"})";
  world_.site.NoteForbidden(request, FindRoute("/api/v1/robot/block").id);
  EXPECT_THAT(Audit().front().target, ::testing::StartsWith("rcan://example.com/"))
      << "of the body";
  EXPECT_THAT(Audit().front().target, ::testing::Not(HasSubstr("\n")));
  request.body = "[{";
  world_.site.NoteForbidden(request, FindRoute("/api/v1/robot/block").id);
  EXPECT_EQ(Audit().front().target, "");
  world_.site.NoteForbidden(request, FindRoute("/api/v1/audit").id);
  EXPECT_EQ(world_.audit.waiting(), 0U) << "questions leave no row";
}

TEST_F(HttpCommandsTest, RobotsShowAndAreFoundByWhatIsSet) {
  world_.settings.Apply({{.ruri = kNorth,
                          .blocked = true,
                          .labels = {{"line", "2"}, {"site", "hall=2"}},
                          .note = "new wheels",
                          .version = 1},
                         {.ruri = kSouth, .labels = {{"line", "2"}}, .version = 2}});
  const std::string list = "/api/v1/robots?parts=none&";
  const std::string both = world_.Get(list + "label=line=2").body;
  EXPECT_THAT(both, HasSubstr(kNorth));
  EXPECT_THAT(both, HasSubstr(kSouth));
  const std::string one = world_.Get(list + "label=line=2&label=site=hall=2").body;
  EXPECT_THAT(one, HasSubstr(R"("total":"1")"));
  EXPECT_THAT(one, HasSubstr(R"("note":"new wheels")"));
  EXPECT_THAT(one, HasSubstr(R"("site":"hall=2")"));
  EXPECT_THAT(world_.Get(list + "blocked=true").body, HasSubstr(kNorth));
  const std::string others = world_.Get(list + "blocked=false").body;
  EXPECT_THAT(others, HasSubstr(kSouth));
  EXPECT_THAT(others, HasSubstr(R"("total":"1")"));
  EXPECT_EQ(world_.Get(list + "label=line").status, 400);
  EXPECT_THAT(world_.Get("/api/v1/robot?ruri=" + std::string(kNorth)).body,
              HasSubstr(R"("blocked":true)"));
}

}  // namespace
}  // namespace uplink::http
