#include "server/http/site.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/server_world.h"

namespace uplink::http {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class SiteTest : public ::testing::Test {
 protected:
  Response Get(const std::string& target) { return world_.Get(target); }

  testing::ServerWorld world_;
};

TEST_F(SiteTest, LivezFailsAfterAMinuteWithoutAHandshake) {
  world_.clock.Advance(fleet::kAliveMax);
  EXPECT_EQ(Get("/livez").status, 200);
  world_.clock.Advance(milliseconds(1));
  EXPECT_EQ(Get("/livez").status, 503);
  world_.monitor.liveness().NoteHandshake();
  EXPECT_EQ(Get("/livez").status, 200);
}

TEST_F(SiteTest, ReadyzSaysWhatIsDegradedAndStaysReady) {
  EXPECT_EQ(Get("/readyz").body, R"({"degraded":[]})");
  world_.journal_probe.store_failing.Set(1);
  const Response response = Get("/readyz");
  EXPECT_EQ(response.status, 200);
  EXPECT_EQ(response.body, R"({"degraded":["store"]})");
}

TEST_F(SiteTest, ReadyzFailsWhenANewStreamWouldBeRefused) {
  for (std::size_t i = 0; i < testing::ServerWorld::kRobotsMax; ++i) {
    EXPECT_EQ(Get("/readyz").status, 200);
    world_.AddRobot("rcan://" + std::to_string(i));
  }
  world_.monitor.BeginDrain();
  const Response response = Get("/readyz");
  EXPECT_EQ(response.status, 503);
  EXPECT_EQ(response.body, R"({"refuses":["draining"]})") << "a known robot still finds its place";
}

TEST_F(SiteTest, ScrapesComeInTheFormatAndCodingThatIsAskedFor) {
  world_.AddRobot("rcan://a").state.SignOfLife(world_.clock.Steady(), world_.clock.System(), {});
  for (const char* path : {"/metrics", "/metrics/robots"}) {
    Request request{Method::kGet, path};
    const Response plain = world_.Get(request);
    EXPECT_EQ(plain.content_type, "text/plain; version=0.0.4; charset=utf-8");
    EXPECT_EQ(plain.coding, "");
    EXPECT_TRUE(plain.varies);
    EXPECT_THAT(std::string(plain.content()), Not(HasSubstr("# EOF")));
    request.accept = "application/openmetrics-text;version=1.0.0";
    const Response open_metrics = world_.Get(request);
    EXPECT_EQ(open_metrics.content_type,
              "application/openmetrics-text; version=1.0.0; charset=utf-8");
    EXPECT_TRUE(open_metrics.content().ends_with("# EOF\n"));
    request.accept_encoding = "gzip";
    const Response zipped = world_.Get(request);
    EXPECT_EQ(zipped.coding, "gzip");
    EXPECT_TRUE(zipped.content().starts_with("\x1f\x8b"));
    EXPECT_EQ(world_.Get(std::string(path) + "?x=1").status, 400);
  }
}

TEST_F(SiteTest, TheRobotsScrapeIsRefusedWhileTooManyAreRead) {
  std::vector<Response> held;
  for (std::size_t i = 0; i < rcan::kTextsMax; ++i) {
    held.push_back(Get("/metrics/robots"));
    world_.clock.Advance(rcan::kTextShared);
  }
  EXPECT_EQ(Get("/metrics/robots").status, 503);
  EXPECT_THAT(Get("/metrics").body, HasSubstr("uplinkd_rcan_scrapes_refused_total 1\n"));
  held.pop_back();
  EXPECT_EQ(Get("/metrics/robots").status, 200);
}

TEST_F(SiteTest, ReadyzFailsOnceTheCertificateExpired) {
  world_.clock.Advance(std::chrono::hours(24 * 365));
  EXPECT_THAT(Get("/readyz").body, HasSubstr("certificate_expired"));
}

TEST_F(SiteTest, ReadyzFollowsACertificateThatWasReplaced) {
  world_.clock.Advance(std::chrono::hours(24 * 365));
  EXPECT_FALSE(
      world_.monitor.NoteCertificate(world_.clock.System() + std::chrono::hours(24 * 90), true));
  EXPECT_EQ(Get("/readyz").body, R"({"degraded":[]})");
}

TEST_F(SiteTest, StatusNamesWhatIsDegraded) {
  world_.journal_probe.store_failing.Set(1);
  const Response response = Get("/api/v1/status");
  EXPECT_EQ(response.status, 200);
  EXPECT_THAT(response.body, HasSubstr(R"("degraded":["store"])"));
  EXPECT_THAT(response.body, HasSubstr(R"("version":"9.9.9")"));
}

TEST_F(SiteTest, RobotsAreFilteredAndPaged) {
  world_.AddRobot("rcan://a", "north");
  world_.AddRobot("rcan://b", "south");
  EXPECT_THAT(Get("/api/v1/robots?fleet=north").body, HasSubstr(R"("total":"1")"));
  EXPECT_THAT(Get("/api/v1/robots?presence=online").body, HasSubstr(R"("total":"0")"));
  EXPECT_THAT(Get("/api/v1/robots?presence=unknown").body, HasSubstr(R"("total":"2")"));
  const Response first = Get("/api/v1/robots?pageSize=1");
  EXPECT_THAT(first.body, HasSubstr("rcan://a"));
  EXPECT_THAT(first.body, Not(HasSubstr("rcan://b")));
  const std::string marker = R"("nextPageToken":")";
  const std::size_t at = first.body.find(marker) + marker.size();
  const std::string token = first.body.substr(at, first.body.find('"', at) - at);
  EXPECT_THAT(Get("/api/v1/robots?pageSize=1&pageToken=" + token).body, HasSubstr("rcan://b"));
}

TEST_F(SiteTest, ARobotIsFoundByItsEncodedRuri) {
  world_.AddRobot("rcan://a/b");
  EXPECT_EQ(Get("/api/v1/robots/rcan%3A%2F%2Fa%2Fb").status, 200);
  EXPECT_EQ(Get("/api/v1/robots/rcan://a/b").status, 404);
  const Response missing = Get("/api/v1/robots/rcan%3A%2F%2Fx");
  EXPECT_EQ(missing.status, 404);
  EXPECT_THAT(missing.body, HasSubstr(R"("code":"NOT_FOUND")"));
  EXPECT_THAT(missing.body, HasSubstr("rcan://x"));
}

TEST_F(SiteTest, FaultsAreTheActiveSetOrTheHistory) {
  world_.AddRobot("rcan://a");
  world_.CommitFault("rcan://a",
                     {.unix_time_ms = 1, .fault_id = "E", .source = "s", .active = true});
  EXPECT_THAT(Get("/api/v1/faults?active=true&ruri=rcan%3A%2F%2Fa").body,
              HasSubstr(R"("faultId":"E")"));
  world_.CommitFault("rcan://a",
                     {.unix_time_ms = 2, .fault_id = "E", .source = "s", .active = false});
  EXPECT_THAT(Get("/api/v1/faults?active=true").body, HasSubstr(R"("faults":[])"));
  EXPECT_THAT(Get("/api/v1/faults").body, HasSubstr(R"("faultId":"E")"));
  EXPECT_THAT(Get("/api/v1/faults?fleet=other").body, HasSubstr(R"("faults":[])"));
}

TEST_F(SiteTest, QuarantineAndGapsAreARobotsOwn) {
  world_.AddRobot("rcan://a");
  world_.AddRobot("rcan://b");
  world_.CommitQuarantine("rcan://a", {model::RejectReason::kOutOfRange, "x", "far"}, "bytes");
  world_.CommitGap("rcan://a", 10, 12);
  EXPECT_THAT(Get("/api/v1/quarantine?ruri=rcan%3A%2F%2Fa").body,
              HasSubstr(R"("reason":"out_of_range")"));
  EXPECT_THAT(Get("/api/v1/gaps?ruri=rcan%3A%2F%2Fa").body, HasSubstr(R"("firstSeq":"10")"));
  EXPECT_THAT(Get("/api/v1/quarantine?ruri=rcan%3A%2F%2Fb").body, HasSubstr(R"("quarantined":[])"));
  EXPECT_THAT(Get("/api/v1/gaps?ruri=rcan%3A%2F%2Fb").body, HasSubstr(R"("gaps":[])"));
  EXPECT_EQ(Get("/api/v1/robots/rcan%3A%2F%2Fc").status, 404);
}

TEST_F(SiteTest, AReadWhileTheStoreIsAwayIs503) {
  world_.AddRobot("rcan://a");
  world_.reader.SetAway(true);
  for (const char* target :
       {"/api/v1/faults", "/api/v1/faults?active=true", "/api/v1/quarantine?ruri=rcan%3A%2F%2Fa",
        "/api/v1/gaps?ruri=rcan%3A%2F%2Fa", "/api/v1/events?ruri=rcan%3A%2F%2Fa",
        "/api/v1/messages?ruri=rcan%3A%2F%2Fa", "/api/v1/presence?ruri=rcan%3A%2F%2Fa",
        "/api/v1/missions", "/api/v1/shapes", "/api/v1/objects", "/api/v1/scope-updates",
        "/api/v1/quarantine", "/api/v1/robots?parts=motion,settings",
        "/api/v1/robots?parts=agentInfo", "/api/v1/robots?parts=uiCapabilities"}) {
    const Response response = Get(target);
    EXPECT_EQ(response.status, 503) << target;
    EXPECT_THAT(response.body, HasSubstr(R"("code":"UNAVAILABLE")"));
  }
  // What memory knows is still answered.
  EXPECT_EQ(Get("/api/v1/robots").status, 200);
  EXPECT_EQ(Get("/api/v1/robots/rcan%3A%2F%2Fa").status, 200);
  EXPECT_EQ(Get("/api/v1/robots?parts=health").status, 200);
  EXPECT_EQ(Get("/api/v1/status").status, 200);
}

TEST_F(SiteTest, PathsThatAreNotOursAre404) {
  for (const char* target :
       {"/", "", "*", "/api", "/api/v1/robots/", "/metrics/", "/api/v2/status"}) {
    EXPECT_EQ(Get(target).status, 404) << target;
  }
}

TEST_F(SiteTest, OtherMethodsAre405WithAllow) {
  for (const char* target : {"/api/v1/robots", "/api/v1/events?ruri=a", "/api/v1/shapes"}) {
    const Response response = world_.site.Resolve({Method::kOther, target}).run();
    EXPECT_EQ(response.status, 405) << target;
    EXPECT_EQ(response.allow, "GET, HEAD");
  }
  EXPECT_EQ(world_.site.Resolve({Method::kOther, "/nowhere"}).run().status, 404);
}

TEST_F(SiteTest, ProbesAndScrapesNeverWaitForTheStore) {
  for (const char* target : {"/livez", "/readyz", "/nowhere"}) {
    EXPECT_EQ(world_.site.Resolve({Method::kGet, target}).lane, Lane::kIo) << target;
    EXPECT_NE(Get(target).status, 500);
  }
  EXPECT_EQ(world_.site.Resolve({Method::kGet, "/metrics"}).lane, Lane::kMetrics);
  EXPECT_EQ(Get("/metrics").status, 200);
  EXPECT_EQ(world_.reader.calls(), 0);
  for (const char* target :
       {"/api/v1/faults", "/api/v1/robots/a", "/api/v1/presence?ruri=a", "/api/v1/missions",
        "/api/v1/objects", "/api/v1/robots?parts=motion,settings"}) {
    EXPECT_EQ(world_.site.Resolve({Method::kGet, target}).lane, Lane::kRead) << target;
  }
}

TEST_F(SiteTest, WhatIsInMemoryIsNotAnsweredByTheThreadThatReads) {
  for (const char* target : {"/api/v1/status", "/api/v1/robots", "/api/v1/robots?parts=health",
                             "/api/v1/robots?parts=nonsense"}) {
    EXPECT_EQ(world_.site.Resolve({Method::kGet, target}).lane, Lane::kMemory) << target;
  }
}

TEST_F(SiteTest, TheLogHasWhatAClientIsNotTold) {
  world_.AddRobot("rcan://a");
  world_.reader.Fail(absl::InternalError("postgresql db.internal:5432: SELECT broke"));
  const Response response = Get("/api/v1/faults");
  EXPECT_EQ(response.status, 500);
  EXPECT_THAT(response.body, Not(HasSubstr("db.internal")));
  EXPECT_THAT(response.cause, HasSubstr("SELECT broke"));
  world_.reader.Fail(absl::DeadlineExceededError("57014"));
  EXPECT_EQ(Get("/api/v1/faults").status, 504);
  EXPECT_EQ(Get("/api/v1/robots?parts=settings").status, 504);
  world_.reader.Fail(absl::OkStatus());
  EXPECT_EQ(Get("/api/v1/faults").status, 200);
}

}  // namespace
}  // namespace uplink::http
