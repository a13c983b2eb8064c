#include "server/http/server.h"

#include <atomic>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/http/places.h"
#include "tests/component/http/http_server_fixture.h"
#include "tests/component/http/long_scrapes.h"
#include "tests/support/eventually.h"
#include "tests/support/raw_http.h"
#include "tests/support/server_world.h"

namespace uplink::http {
namespace {

using ::testing::HasSubstr;
using testing::HttpGet;
using ::testing::Not;
using testing::RawAnswer;
using testing::RawConnection;

TEST_F(HttpServerTest, AnswersManyRequestsOnOneConnection) {
  RawConnection connection(Serve());
  for (const char* target : {"/livez", "/api/v1/status", "/nowhere", "/metrics", "/readyz"}) {
    connection.SendGet(target);
    const std::optional<RawAnswer> answer = connection.Read();
    ASSERT_TRUE(answer) << target;
    EXPECT_EQ(answer->status, std::string(target) == "/nowhere" ? 404 : 200) << target;
  }
  EXPECT_EQ(Connections().open.value(), 1);
}

TEST_F(HttpServerTest, AnswersRequestsThatCameTogetherInOrder) {
  RawConnection connection(Serve());
  connection.Send(
      "GET /api/v1/status HTTP/1.1\r\nHost: localhost\r\n\r\n"
      "GET /readyz HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
  EXPECT_THAT(connection.Read()->body, HasSubstr("startedAt"));
  EXPECT_THAT(connection.Read()->body, HasSubstr("degraded"));
  EXPECT_TRUE(connection.AtEnd());
}

TEST_F(HttpServerTest, NotModifiedHasItsTagAndNeitherLengthNorBody) {
  RawConnection connection(Serve());
  connection.SendGet("/api/v1/robots");
  const std::optional<RawAnswer> first = connection.Read();
  ASSERT_TRUE(first);
  EXPECT_THAT(first->head, HasSubstr("Cache-Control: private, no-cache\r\n"));
  EXPECT_THAT(first->head, HasSubstr("Vary: Accept, Accept-Encoding\r\n"));
  const std::size_t at = first->head.find("ETag: W/\"");
  ASSERT_NE(at, std::string::npos) << first->head;
  const std::string tag = first->head.substr(at + 6, first->head.find('\r', at) - at - 6);
  for (const char* method : {"GET", "HEAD"}) {
    connection.Send(std::string(method) + " /api/v1/robots HTTP/1.1\r\nHost: localhost\r\n" +
                    "If-None-Match: \"x\"\r\nIf-None-Match: " + tag + "\r\n\r\n");
    const std::optional<RawAnswer> second = connection.Read(RawConnection::Body::kNone);
    ASSERT_TRUE(second);
    EXPECT_EQ(second->status, 304);
    EXPECT_THAT(second->head, HasSubstr("ETag: " + tag));
    EXPECT_THAT(second->head, Not(HasSubstr("\r\nContent-")));
  }
  // The connection is still in step.
  connection.SendGet("/readyz");
  EXPECT_EQ(connection.Read()->body, R"({"degraded":[]})");
}

TEST_F(HttpServerTest, AHeadSaysHowLongTheZippedAnswerIs) {
  RawConnection connection(Serve());
  const std::string rest =
      " /api/v1/openapi.yaml HTTP/1.1\r\nHost: localhost\r\nAccept-Encoding: gzip\r\n\r\n";
  connection.Send("GET" + rest);
  const std::optional<RawAnswer> whole = connection.Read();
  ASSERT_TRUE(whole);
  EXPECT_THAT(whole->head, HasSubstr("Content-Encoding: gzip\r\n"));
  connection.Send("HEAD" + rest);
  const std::optional<RawAnswer> head = connection.Read(RawConnection::Body::kNone);
  ASSERT_TRUE(head);
  EXPECT_THAT(head->head,
              HasSubstr("Content-Length: " + std::to_string(whole->body.size()) + "\r\n"));
}

TEST_F(HttpServerTest, EachUnavailableSaysWhenToAskAgain) {
  const std::uint16_t port = Serve();
  world_.reader.SetAway(true);
  EXPECT_THAT(HttpGet(port, "/api/v1/events").head, HasSubstr("503 "));
  EXPECT_THAT(HttpGet(port, "/api/v1/events").head, HasSubstr("Retry-After: 2\r\n"));
  world_.monitor.BeginDrain();
  EXPECT_THAT(HttpGet(port, "/readyz").head, HasSubstr("Retry-After: 2\r\n"));
  EXPECT_THAT(HttpGet(port, "/livez").head, Not(HasSubstr("Retry-After")));
}

TEST_F(HttpServerTest, HeadHasTheLengthAndNoBody) {
  RawConnection connection(Serve());
  connection.Send("HEAD /readyz HTTP/1.1\r\nHost: localhost\r\n\r\n");
  const std::optional<RawAnswer> head = connection.Read(RawConnection::Body::kNone);
  ASSERT_TRUE(head);
  EXPECT_EQ(head->status, 200);
  EXPECT_THAT(head->head, HasSubstr("Content-Length: 15\r\n"));
  // The connection is still in step: nothing of a body lies before the next answer.
  connection.SendGet("/readyz");
  EXPECT_EQ(connection.Read()->body, R"({"degraded":[]})");
}

TEST_F(HttpServerTest, OtherMethodsNameTheAllowedOnes) {
  RawConnection connection(Serve());
  connection.Send("POST /api/v1/robots HTTP/1.1\r\nHost: localhost\r\nContent-Length: 2\r\n\r\nhi");
  const std::optional<RawAnswer> answer = connection.Read();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, 405);
  EXPECT_THAT(answer->head, HasSubstr("Allow: GET, HEAD\r\n"));
  connection.SendGet("/readyz");
  EXPECT_EQ(connection.Read()->status, 200);
}

TEST_F(HttpServerTest, TheLastFourConnectionsAnswerProbesAndScrapesAlone) {
  const std::uint16_t port = Serve();
  std::vector<std::unique_ptr<RawConnection>> held;
  for (std::size_t i = 0; i < kConnectionsMax - kMonitoringPlaces; ++i) {
    held.push_back(std::make_unique<RawConnection>(port));
    held.back()->SendGet("/api/v1/status");
    ASSERT_EQ(held.back()->Read()->status, 200);
  }
  RawConnection client(port);
  client.SendGet("/api/v1/status");
  const std::optional<RawAnswer> refused = client.Read();
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->status, 503);
  EXPECT_THAT(refused->head, HasSubstr("Connection: close\r\n"));
  EXPECT_THAT(refused->body, HasSubstr("too many connections"));
  EXPECT_TRUE(client.AtEnd());
  RawConnection probe(port);
  for (const char* target : {"/livez", "/readyz", "/metrics", "/metrics/robots"}) {
    probe.SendGet(target);
    EXPECT_EQ(probe.Read()->status, 200) << target;
  }
  held.front()->SendGet("/api/v1/status");
  EXPECT_EQ(held.front()->Read()->status, 200);
}

TEST_F(HttpServerTest, IdleConnectionsGiveWayToAProbe) {
  const std::uint16_t port = Serve();
  std::vector<std::unique_ptr<RawConnection>> idle;
  for (std::size_t i = 0; i < kConnectionsMax; ++i) {
    idle.push_back(std::make_unique<RawConnection>(port));
    idle.back()->Send("GET /api");  // and no more of it
  }
  ASSERT_TRUE(testing::Eventually(
      [&] { return Connections().open.value() == static_cast<int>(kConnectionsMax); }));
  EXPECT_EQ(HttpGet(port, "/livez").status, 200);
  EXPECT_EQ(HttpGet(port, "/metrics").status, 200);
  EXPECT_GE(Connections().given_up.value(), 1);
  EXPECT_EQ(Connections().refused.value(), 0);
  EXPECT_TRUE(idle.front()->AtEnd()) << "the first has waited for longest";
}

TEST_F(HttpServerTest, RequestsThatWaitForTheStoreShutNoProbeOut) {
  const std::uint16_t port = Serve();
  world_.reader.Hold();
  std::vector<std::unique_ptr<RawConnection>> slow;
  for (std::size_t i = 0; i < kConnectionsMax; ++i) {
    slow.push_back(std::make_unique<RawConnection>(port));
    slow.back()->SendGet("/api/v1/faults");
  }
  ASSERT_TRUE(world_.reader.WaitUntilHeld(std::chrono::seconds(10)));
  for (int i = 0; i < 3; ++i) EXPECT_EQ(HttpGet(port, "/readyz").status, 200);
  world_.reader.Release();
  EXPECT_EQ(slow.front()->Read()->status, 200) << "none that is answered gives way";
}

TEST_F(HttpServerTest, ScrapesThatAreSentAheadAndNeverReadShutNoProbeOut) {
  constexpr int kLittle = 4096;
  constexpr int kAhead = 100;
  std::string ahead;
  for (int i = 0; i < kAhead; ++i) ahead += "GET /metrics HTTP/1.1\r\nHost: localhost\r\n\r\n";
  const auto begun = std::make_shared<std::atomic<bool>>(false);
  std::promise<void> gate;  // its end opens it, too
  world_.page_sources.push_back([begun, opened = gate.get_future().share()](auto&) {
    *begun = true;
    opened.wait();
  });
  const std::uint16_t port = Serve();
  RawConnection first(port);
  first.SendGet("/metrics");
  ASSERT_TRUE(testing::Eventually([&] { return begun->load(); }));
  std::vector<std::unique_ptr<RawConnection>> flood;
  for (std::size_t i = 1; i < kConnectionsMax; ++i) {
    flood.push_back(std::make_unique<RawConnection>(port, kLittle));
    flood.back()->Send(ahead);
  }
  // Each has one request under way, and all places are taken by them.
  ASSERT_TRUE(testing::Eventually([&] {
    return world_.http_probe.metrics_waiting.value() == static_cast<int>(kConnectionsMax - 1);
  }));
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(HttpGet(port, "/livez").status, 200);
    EXPECT_EQ(HttpGet(port, "/readyz").status, 200);
  }
  EXPECT_EQ(Connections().refused.value(), 0);
  gate.set_value();
  EXPECT_EQ(HttpGet(port, "/metrics").status, 200);
  const std::optional<RawAnswer> answer = first.Read();
  ASSERT_TRUE(answer) << "the one that has waited for longest does not give way";
  EXPECT_EQ(answer->status, 200);
}

TEST_F(HttpServerTest, AcceptsManyInATurn) {
  constexpr std::size_t kCallers = 12;
  constexpr int kTurns = 6;
  const std::uint16_t port = Serve();
  std::promise<void> gate;
  std::promise<std::int64_t> counted;
  std::function<void(int)> turn = [&](int left) {
    if (left == 0) return counted.set_value(Connections().open.value());
    loop_.Post([&turn, left] { turn(left - 1); });
  };
  loop_.Post([&turn, opened = gate.get_future().share()] {
    opened.wait();
    turn(kTurns);
  });
  std::vector<std::unique_ptr<RawConnection>> callers;
  for (std::size_t i = 0; i < kCallers; ++i) {
    callers.push_back(std::make_unique<RawConnection>(port));
  }
  gate.set_value();
  EXPECT_EQ(counted.get_future().get(), static_cast<std::int64_t>(kCallers));
}

TEST_F(HttpServerTest, WhatMemoryKnowsNeverWaitsBehindASlowRead) {
  world_.AddRobot("rcan://a");
  const std::uint16_t port = Serve();
  world_.reader.Hold();
  RawConnection slow(port);
  slow.SendGet("/api/v1/faults");
  ASSERT_TRUE(world_.reader.WaitUntilHeld(std::chrono::seconds(10)));
  for (const char* target : {"/livez", "/readyz", "/metrics", "/api/v1/status"}) {
    EXPECT_EQ(HttpGet(port, target).status, 200) << target;
  }
  EXPECT_THAT(HttpGet(port, "/api/v1/robots").body, HasSubstr(R"("ruri":"rcan://a")"));
  EXPECT_THAT(HttpGet(port, "/api/v1/robots?parts=health").body, HasSubstr(R"("total":"1")"));
  world_.reader.Release();
  EXPECT_EQ(slow.Read()->status, 200);
}

TEST_F(HttpServerTest, ReadsPastTheirBoundAre503) {
  const std::uint16_t port = Serve();
  world_.reader.Hold();
  RawConnection slow(port);
  slow.SendGet("/api/v1/faults");
  ASSERT_TRUE(world_.reader.WaitUntilHeld(std::chrono::seconds(10)));
  for (std::size_t i = 0; i < loop::kReadsWaitingMax; ++i) ASSERT_TRUE(reads_->TryPost([] {}));
  const RawAnswer refused = HttpGet(port, "/api/v1/missions");
  EXPECT_EQ(refused.status, 503);
  EXPECT_THAT(refused.body, HasSubstr("UNAVAILABLE"));
}

TEST_F(HttpServerTest, AClientThatLeavesDuringAReadHarmsNobody) {
  const std::uint16_t port = Serve();
  world_.reader.Hold();
  {
    RawConnection leaver(port);
    leaver.SendGet("/api/v1/faults");
    ASSERT_TRUE(world_.reader.WaitUntilHeld(std::chrono::seconds(10)));
  }
  world_.reader.Release();
  EXPECT_EQ(HttpGet(port, "/api/v1/faults").status, 200);
}

TEST_F(HttpServerTest, ScrapersThatDoNotReadHoldFourTextsAndNoMore) {
  constexpr int kLittle = 4096;
  AddRobotsOfManyWords(world_);
  const std::uint16_t port = Serve();
  std::vector<std::unique_ptr<RawConnection>> slow;
  for (std::size_t i = 0; i < rcan::kTextsMax; ++i) {
    slow.push_back(std::make_unique<RawConnection>(port, kLittle));
    slow.back()->SendGet("/metrics/robots");
    ASSERT_TRUE(testing::Eventually([&] { return ScrapesWritten(world_) == i + 1; }));
    world_.clock.Advance(rcan::kTextShared);  // the next one gets a text of its own
  }
  EXPECT_EQ(HttpGet(port, "/metrics/robots").status, 503);
  EXPECT_EQ(world_.rcan_probe.refused_total.value(), 1);
  // Other requests do not wait for them.
  EXPECT_EQ(HttpGet(port, "/livez").status, 200);
  EXPECT_EQ(HttpGet(port, "/metrics").status, 200);
  EXPECT_EQ(HttpGet(port, "/api/v1/status").status, 200);
  // One hangs up, and its text is free again.
  slow.pop_back();
  EXPECT_TRUE(testing::Eventually([&] {
    world_.clock.Advance(rcan::kTextShared);
    return HttpGet(port, "/metrics/robots").status == 200;
  }));
}

TEST_F(HttpServerTest, ListensOnBothFamiliesOfAnUnspecifiedAddress) {
  EXPECT_EQ(HttpGet(Serve("::"), "/readyz").status, 200);
  EXPECT_EQ(server_->bound().host, "::");
}

TEST_F(HttpServerTest, CountsAnswersByRouteAndClass) {
  const std::uint16_t port = Serve();
  EXPECT_EQ(HttpGet(port, "/readyz").status, 200);
  EXPECT_EQ(HttpGet(port, "/nowhere").status, 404);
  const std::string text = HttpGet(port, "/metrics").body;
  EXPECT_THAT(text, HasSubstr("uplinkd_http_requests_total{route=\"readyz\",code=\"2xx\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("uplinkd_http_requests_total{route=\"other\",code=\"4xx\"} 1\n"));
}

TEST_F(HttpServerTest, JsonOfARobotComesOverTheWire) {
  world_.AddRobot("rcan://a/b", "north");
  const RawAnswer answer = HttpGet(Serve(), "/api/v1/robots/rcan%3A%2F%2Fa%2Fb");
  EXPECT_EQ(answer.status, 200);
  EXPECT_THAT(answer.head, HasSubstr("Content-Type: application/json\r\n"));
  EXPECT_THAT(answer.body, HasSubstr(R"("ruri":"rcan://a/b")"));
}

}  // namespace
}  // namespace uplink::http
