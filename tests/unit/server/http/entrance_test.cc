#include "server/http/entrance.h"

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/server_world.h"

namespace uplink::http {
namespace {

using ::testing::HasSubstr;

class EntranceTest : public ::testing::Test {
 protected:
  [[nodiscard]] Resolved Ask(const std::string& target, Method method = Method::kGet) const {
    return entrance_.Resolve({method, target});
  }

  [[nodiscard]] int StatusUnder(const std::string& host, const std::string& target) const {
    Request request{Method::kGet, target};
    request.host = host;
    request.host_required = true;
    return entrance_.Resolve(request).run().status;
  }

  testing::ServerWorld world_;
  Entrance entrance_{KnownHosts({"uplink.example.org"})};
};

TEST_F(EntranceTest, WhileTheServerStartsItLivesAndIsNotReady) {
  EXPECT_EQ(Ask("/livez").run().status, 200);
  EXPECT_EQ(Ask("/livez").run().body, R"({"relayLastHandshakeSeconds":0})");
  const Response ready = Ask("/readyz").run();
  EXPECT_EQ(ready.status, 503);
  EXPECT_EQ(ready.body, R"({"refuses":["starting"]})");
}

TEST_F(EntranceTest, WhileTheServerStartsEverythingElseIs503) {
  for (const char* target : {"/metrics", "/metrics/robots", "/api/v1/status", "/api/v1/robots/a",
                             "/api/v1/faults", "/", "/nowhere"}) {
    const Resolved resolved = Ask(target);
    EXPECT_EQ(resolved.lane, Lane::kIo) << target << " waits for nothing";
    const Response response = resolved.run();
    EXPECT_EQ(response.status, 503) << target;
    EXPECT_THAT(response.body, HasSubstr(R"("code":"UNAVAILABLE")"));
    EXPECT_THAT(response.body, HasSubstr("the server starts"));
  }
  EXPECT_EQ(Ask("/nowhere", Method::kOther).run().status, 503);
  EXPECT_EQ(RouteName(Ask("/api/v1/status").route), "status");
  EXPECT_EQ(RouteName(Ask("/nowhere").route), "other");
}

TEST_F(EntranceTest, AWrongRequestIsAnsweredDuringTheStartAsItIsLater) {
  const auto expect_refusals = [this] {
    for (const char* target : {"/livez", "/readyz"}) {
      const Response method = Ask(target, Method::kOther).run();
      EXPECT_EQ(method.status, 405) << target;
      EXPECT_EQ(method.allow, "GET, HEAD");
      const Response parameter = Ask(std::string(target) + "?x=1").run();
      EXPECT_EQ(parameter.status, 400) << target;
      EXPECT_THAT(parameter.body, HasSubstr(R"("field":"x")"));
    }
    EXPECT_EQ(Ask("/metrics", Method::kOther).run().status, 405);
    EXPECT_EQ(Ask("/api/v1/status", Method::kOther).run().status, 405);
  };
  expect_refusals();
  entrance_.Open(world_.site);
  expect_refusals();
}

TEST_F(EntranceTest, TheSiteAnswersOnceItIsThere) {
  entrance_.Open(world_.site);
  EXPECT_EQ(Ask("/readyz").run().body, R"({"degraded":[]})");
  EXPECT_EQ(Ask("/api/v1/status").run().status, 200);
  EXPECT_EQ(Ask("/nowhere").run().status, 404);
  EXPECT_EQ(Ask("/readyz", Method::kOther).run().status, 405);
}

TEST_F(EntranceTest, DataAreShownUnderKnownHostsAlone) {
  for (const char* target :
       {"/api/v1/status", "/api/v1/robots", "/api/v1/events", "/", "/nowhere"}) {
    EXPECT_EQ(StatusUnder("rebound.example:7480", target), 421) << target << " while it starts";
  }
  entrance_.Open(world_.site);
  for (const char* target :
       {"/api/v1/status", "/api/v1/robots", "/api/v1/events", "/", "/nowhere"}) {
    EXPECT_EQ(StatusUnder("rebound.example:7480", target), 421) << target;
    EXPECT_NE(StatusUnder("127.0.0.1:7480", target), 421) << target;
    EXPECT_NE(StatusUnder("uplink.example.org", target), 421) << target;
  }
}

TEST_F(EntranceTest, ProbesAndScrapesAreAnsweredUnderAnyName) {
  entrance_.Open(world_.site);
  for (const char* target : {"/livez", "/readyz", "/metrics", "/metrics/robots"}) {
    EXPECT_EQ(StatusUnder("uplinkd.monitoring.svc:7480", target), 200) << target;
  }
}

TEST_F(EntranceTest, ScrapesAreShownUnderKnownHostsAloneWhereThatIsSet) {
  Entrance strict{KnownHosts({"uplink.example.org"}), Entrance::Covered::kDataAndScrapes};
  strict.Open(world_.site);
  const auto status = [&](const std::string& host, const std::string& target) {
    Request request{Method::kGet, target};
    request.host = host;
    return strict.Resolve(request).run().status;
  };
  for (const char* target : {"/metrics", "/metrics/robots", "/api/v1/status"}) {
    EXPECT_EQ(status("uplinkd.monitoring.svc:7480", target), 421) << target;
    EXPECT_EQ(status("uplink.example.org:7480", target), 200) << target;
    EXPECT_EQ(status("127.0.0.1:7480", target), 200) << target;
  }
  for (const char* target : {"/livez", "/readyz"}) {
    EXPECT_EQ(status("uplinkd.monitoring.svc:7480", target), 200) << target;
  }
}

TEST_F(EntranceTest, OnTheListenerOfMetricsThereAreProbesAndScrapesAlone) {
  Request request{Method::kGet, ""};
  request.listener = ListenerId::kMetrics;
  request.host = "uplinkd.monitoring.svc:9090";
  request.host_required = true;
  Entrance strict{KnownHosts({"uplink.example.org"}), Entrance::Covered::kDataAndScrapes};
  const auto ask = [&](const std::string& target) {
    request.target = target;
    return strict.Resolve(request);
  };
  const auto expect_no_data = [&] {
    for (const char* target : {"/api/v1/status", "/api/v1/robots", "/api/v1/events", "/",
                               "/nowhere", "/metrics/", "http://localhost/api/v1/status"}) {
      const Resolved resolved = ask(target);
      EXPECT_EQ(resolved.run().status, 404) << target;
      EXPECT_EQ(RouteName(resolved.route), "other") << target;
    }
  };
  expect_no_data();
  EXPECT_EQ(ask("/readyz").run().body, R"({"refuses":["starting"]})");
  EXPECT_EQ(ask("/metrics").run().status, 503);
  strict.Open(world_.site);
  expect_no_data();
  for (const char* target :
       {"/livez", "/readyz", "/metrics", "/metrics/robots", "http://elsewhere.example/livez"}) {
    EXPECT_EQ(ask(target).run().status, 200) << target << " under any name, whatever is covered";
  }
  request.host.reset();
  EXPECT_EQ(ask("/livez").run().status, 400) << "a request of HTTP/1.1 names its host all the same";
  request.host = "x";
  request.method = Method::kOther;
  EXPECT_EQ(ask("/metrics").run().status, 405);
  EXPECT_EQ(ask("/api/v1/status").run().status, 404);
}

TEST_F(EntranceTest, ATokenInTheAddressIsRefusedEverywhere) {
  entrance_.Open(world_.site);
  for (const char* target :
       {"/api/v1/robots?token=x", "/api/v1/robots?fleet=a&access_token=x", "/livez?token",
        "/nowhere?%74oken=x", "http://localhost/metrics?token=x"}) {
    const Response response = Ask(target).run();
    EXPECT_EQ(response.status, 400) << target;
    EXPECT_THAT(response.body, HasSubstr("Authorization: Bearer")) << target;
  }
}

TEST_F(EntranceTest, TheGuardStandsBehindHostAndOriginAndBeforeTheSite) {
  Guard guard({world_.clock, world_.logger, world_.http_probe}, {.asks = true});
  Entrance guarded{KnownHosts({"uplink.example.org"}), Entrance::Covered::kData, &guard};
  Request request{Method::kGet, ""};
  request.host = "127.0.0.1";
  const auto status = [&](const char* target) {
    request.target = target;
    return guarded.Resolve(request).run().status;
  };
  for (const bool opened : {false, true}) {
    if (opened) guarded.Open(world_.site);
    EXPECT_EQ(status("/api/v1/robots"), 401);
    EXPECT_EQ(status("/metrics"), 401);
    EXPECT_EQ(status("/nowhere"), 401);
    EXPECT_EQ(status("/livez"), 200);
  }
  request.method = Method::kOther;
  EXPECT_EQ(status("/api/v1/robots"), 401);
  EXPECT_EQ(status("/livez"), 405);
  request.method = Method::kGet;
  request.certificate = std::make_shared<const PeerCertificate>(
      PeerCertificate{.identity = identity::PeerIdentity{identity::Role::kAdmin, "*"},
                      .subject = "CN=anna",
                      .expiry = world_.clock.System() + std::chrono::hours(1)});
  EXPECT_EQ(status("/api/v1/robots"), 200);
  EXPECT_EQ(status("/nowhere"), 404);
  request.fetch_site = "cross-site";
  EXPECT_EQ(status("/api/v1/robots"), 403);
  request.host = "elsewhere.example";
  EXPECT_EQ(status("/api/v1/robots"), 421);
}

TEST_F(EntranceTest, APageOfAnotherSiteIsShownNoData) {
  entrance_.Open(world_.site);
  Request request{Method::kGet, ""};
  request.host = "127.0.0.1:7480";
  const auto status = [&](const char* target) {
    request.target = target;
    return entrance_.Resolve(request).run().status;
  };
  const auto expect_refused = [&] {
    for (const char* target : {"/api/v1/status", "/api/v1/robots", "/api/v1/nothing"}) {
      EXPECT_EQ(status(target), 403) << target;
    }
    EXPECT_EQ(status("/livez"), 200);
    EXPECT_EQ(status("/metrics"), 200);
  };
  for (const char* site : {"cross-site", "Cross-Site"}) {
    request.fetch_site = site;
    expect_refused();
  }
  for (const char* site : {"same-origin", "same-site", "none", ""}) {
    request.fetch_site = site;
    EXPECT_EQ(status("/api/v1/status"), 200) << site;
  }
  for (const char* origin : {"https://evil.example", "null", ""}) {
    request.origin = origin;
    expect_refused();
  }
  request.origin = "http://127.0.0.1:7480";
  EXPECT_EQ(status("/api/v1/status"), 200);
  request.fetch_site = "cross-site";
  EXPECT_EQ(status("/api/v1/status"), 403);
}

TEST_F(EntranceTest, APageOfAnotherPortChangesNothing) {
  entrance_.Open(world_.site);
  Request request{Method::kPost, "/api/v1/reload"};
  request.host = "127.0.0.1:7480";
  request.content_type = "application/json";
  const auto refused = [&](const char* site, std::optional<std::string> origin) {
    request.fetch_site = site;
    request.origin = std::move(origin);
    return entrance_.Resolve(request).run().status == 403;
  };
  EXPECT_FALSE(refused("", std::nullopt)) << "a program";
  EXPECT_FALSE(refused("none", std::nullopt));
  EXPECT_FALSE(refused("same-origin", "http://127.0.0.1:7480"));
  EXPECT_FALSE(refused("", "http://127.0.0.1:7480"));
  EXPECT_TRUE(refused("", "http://127.0.0.1:3000"));
  EXPECT_TRUE(refused("", "http://localhost:7480"));
  EXPECT_TRUE(refused("same-site", std::nullopt));
  EXPECT_TRUE(refused("same-site", "http://127.0.0.1:3000"));
}

}  // namespace
}  // namespace uplink::http
