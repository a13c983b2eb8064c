// What listen.metrics shows, and what its clients cannot do to those of listen.http.
#include <algorithm>
#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/component/http/http_server_fixture.h"
#include "tests/component/http/long_scrapes.h"
#include "tests/support/eventually.h"
#include "tests/support/raw_http.h"

namespace uplink::http {
namespace {

using ::testing::HasSubstr;
using testing::HttpGet;
using testing::RawAnswer;
using testing::RawConnection;
using ::testing::StartsWith;

/// Another source than 127.0.0.1.
constexpr const char* kElsewhere = "127.0.0.2";

/// Keeps a thread busy until Release, or its end.
class BusyThread final {
 public:
  explicit BusyThread(loop::ReadThreads& thread) {
    std::promise<void> begun;
    const auto job = thread.TryPost([&begun, opened = gate_.get_future().share()] {
      begun.set_value();
      opened.wait();
    });
    EXPECT_TRUE(job.has_value());
    if (job) begun.get_future().wait();
  }
  void Release() { gate_.set_value(); }

 private:
  std::promise<void> gate_;
};

class MetricsListenerTest : public HttpServerTest {
 protected:
  ~MetricsListenerTest() override { loop_.Stop(); }

  /// Both listeners; the port of listen.metrics.
  std::uint16_t ServeBoth(const ListenerLimits& limits = kMetricsLimits) {
    monitoring_ = Listen({ListenerId::kMetrics, {"127.0.0.1", 0}, limits});
    http_port_ = Serve();
    return monitoring_->bound().port;
  }

  [[nodiscard]] const ConnectionProbe& Metrics() const { return Connections(ListenerId::kMetrics); }

  std::unique_ptr<HttpServer> monitoring_;
  std::uint16_t http_port_ = 0;
};

std::string Ask(const std::string& line, const std::string& host, const std::string& rest = "") {
  return line + " HTTP/1.1\r\nHost: " + host + "\r\n" + rest + "\r\n";
}

TEST_F(MetricsListenerTest, ShowsProbesAndScrapesUnderAnyNameAndNothingElse) {
  RawConnection connection(ServeBoth());
  for (const char* target : {"/livez", "/readyz", "/metrics", "/metrics/robots"}) {
    connection.Send(Ask(std::string("GET ") + target, "uplinkd.example:9090"));
    EXPECT_EQ(connection.Read()->status, 200) << target;
  }
  for (const char* target : {"/api/v1/status", "/api/v1/robots", "/", "/nowhere"}) {
    connection.SendGet(target);
    EXPECT_EQ(connection.Read()->status, 404) << target;
  }
  for (const char* method : {"POST", "PUT", "DELETE", "OPTIONS"}) {
    connection.Send(Ask(std::string(method) + " /metrics", "uplinkd.example"));
    const std::optional<RawAnswer> answer = connection.Read();
    ASSERT_TRUE(answer) << method;
    EXPECT_EQ(answer->status, 405) << method;
    EXPECT_THAT(answer->head, HasSubstr("Allow: GET, HEAD\r\n"));
  }
  EXPECT_EQ(HttpGet(http_port_, "/api/v1/status").status, 200);
  EXPECT_EQ(HttpGet(http_port_, "/metrics").status, 200);
}

TEST_F(MetricsListenerTest, RequestsHaveBoundsOfTheirOwn) {
  const std::uint16_t port = ServeBoth();
  const auto status = [port](const std::string& request) {
    RawConnection connection(port);
    connection.Send(request);
    return connection.Read().value_or(RawAnswer()).status;
  };
  const std::string least = Ask("GET /livez", "x", "X-Fill: \r\n");
  const auto filled = [&](std::size_t bytes) {
    return Ask("GET /livez", "x", "X-Fill: " + std::string(bytes - least.size(), 'x') + "\r\n");
  };
  EXPECT_EQ(status(filled(kMetricsLimits.header_bytes_max)), 200);
  EXPECT_EQ(status(filled(kMetricsLimits.header_bytes_max + 1)), 431);
  const auto body = [](std::size_t bytes) {
    return Ask("POST /metrics", "x", "Content-Length: " + std::to_string(bytes) + "\r\n") +
           std::string(bytes, 'x');
  };
  EXPECT_EQ(status(body(kMetricsLimits.body_bytes_max)), 405);
  EXPECT_EQ(status(body(kMetricsLimits.body_bytes_max + 1)), 413);
}

TEST_F(MetricsListenerTest, ARequestThatIsNotWholeEndsAtItsTime) {
  ListenerLimits limits = kMetricsLimits;
  limits.request_wait = milliseconds(50);
  RawConnection connection(ServeBoth(limits));
  connection.Send("GET /livez HTTP/1.1\r\n");
  EXPECT_TRUE(connection.AtEnd());
}

TEST_F(MetricsListenerTest, ConnectionsAreBoundedAndTakeNoPlaceOfTheOthers) {
  const std::uint16_t port = ServeBoth();
  std::vector<std::unique_ptr<RawConnection>> slow;
  for (std::size_t i = 0; i < kMetricsLimits.connections_max; ++i) {
    const std::string from = "127.0.0." + std::to_string(2 + i / kMetricsLimits.source_share);
    slow.push_back(std::make_unique<RawConnection>(port, 0, from.c_str()));
    slow.back()->Send("GET /metr");  // and no more of it
  }
  const auto most = static_cast<int>(kMetricsLimits.connections_max);
  ASSERT_TRUE(testing::Eventually([&] { return Metrics().open.value() == most; }));
  EXPECT_EQ(Metrics().given_up.value(), 0);
  EXPECT_EQ(Connections().open.value(), 0);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(HttpGet(http_port_, "/readyz").status, 200);
    EXPECT_EQ(HttpGet(http_port_, "/api/v1/status").status, 200);
  }
  EXPECT_EQ(Connections().given_up.value(), 0);
  EXPECT_EQ(HttpGet(port, "/metrics").status, 200) << "one that is idle gives way";
  EXPECT_GE(Metrics().given_up.value(), 1);
  EXPECT_TRUE(slow.front()->AtEnd());
  const std::string page = HttpGet(http_port_, "/metrics").body;
  EXPECT_THAT(page, HasSubstr("uplinkd_http_connections{listener=\"http\"} 1\n"));
  EXPECT_THAT(page, HasSubstr("uplinkd_http_connections{listener=\"metrics\"} "));
  EXPECT_THAT(page, HasSubstr("uplinkd_http_connections_given_up_total{listener=\"http\"} 0\n"));
}

TEST_F(MetricsListenerTest, ASourceThatHasItsShareGivesWayToItselfAlone) {
  const std::uint16_t port = ServeBoth();
  RawConnection first(port);
  first.SendGet("/livez");
  ASSERT_EQ(first.Read()->status, 200);
  std::vector<std::unique_ptr<RawConnection>> slow;
  const auto hold_one = [&] {
    slow.push_back(std::make_unique<RawConnection>(port, 0, kElsewhere));
    slow.back()->Send("GET /liv");
  };
  for (std::size_t i = 0; i < kMetricsLimits.source_share; ++i) hold_one();
  const auto open = static_cast<int>(kMetricsLimits.source_share) + 1;
  ASSERT_TRUE(testing::Eventually([&] { return Metrics().open.value() == open; }));
  EXPECT_EQ(Metrics().given_up.value(), 0);
  hold_one();
  EXPECT_TRUE(slow.front()->AtEnd());
  EXPECT_EQ(Metrics().given_up.value(), 1);
  EXPECT_EQ(Metrics().refused.value(), 0);
  first.SendGet("/livez");
  EXPECT_EQ(first.Read()->status, 200) << "idle for longer, and of another source";
}

TEST_F(MetricsListenerTest, ASourceIsRefusedPastItsShareAndKeepsNoOtherOut) {
  constexpr int kLittle = 4096;
  AddRobotsOfManyWords(world_);
  // By a clock that stands still none of them is slow.
  auto monitoring =
      HttpServer::Listen({loop_.io(), entrance_, *memory_, *reads_, *metrics_, *scrapes_, *watches_,
                          world_.http_probe, world_.clock, logger_},
                         {ListenerId::kMetrics, {"::", 0}, kMetricsLimits});
  ASSERT_TRUE(monitoring.ok()) << monitoring.status();
  monitoring_ = *std::move(monitoring);
  Serve();
  const std::uint16_t port = monitoring_->bound().port;
  std::vector<std::unique_ptr<RawConnection>> unread;
  for (std::size_t i = 0; i < kMetricsLimits.source_share; ++i) {
    unread.push_back(std::make_unique<RawConnection>(port, kLittle, kElsewhere));
    unread.back()->SendGet("/metrics/robots");
  }
  const std::string answered =
      "uplinkd_http_requests_total{route=\"metrics_robots\",code=\"2xx\"} " +
      std::to_string(kMetricsLimits.source_share) + "\n";
  ASSERT_TRUE(testing::Eventually(
      [&] { return HttpGet(port, "/metrics").body.find(answered) != std::string::npos; }));
  EXPECT_EQ(Metrics().refused.value(), 0);
  RawConnection further(port, 0, kElsewhere);
  EXPECT_TRUE(further.AtEnd());
  EXPECT_EQ(Metrics().refused.value(), 1);
  for (const char* path : {"/livez", "/readyz"}) EXPECT_EQ(HttpGet(port, path).status, 200) << path;
  EXPECT_EQ(Metrics().given_up.value(), 0);
  unread.pop_back();
  EXPECT_TRUE(testing::Eventually([&] {
    RawConnection again(port, 0, kElsewhere);
    again.SendGet("/livez");
    return again.Read().value_or(RawAnswer()).status == 200;
  }));
}

TEST_F(MetricsListenerTest, OverHalfOfAShareIsNotKeptAfterItsAnswer) {
  const std::uint16_t port = ServeBoth();
  const std::string twice = Ask("GET /livez", "x") + Ask("GET /livez", "x");
  std::vector<std::unique_ptr<RawConnection>> kept;
  for (std::size_t i = 0; i < kMetricsLimits.source_share / 2; ++i) {
    kept.push_back(std::make_unique<RawConnection>(port, 0, kElsewhere));
    kept.back()->Send(twice);
    for (int answer = 0; answer < 2; ++answer) {
      EXPECT_THAT(kept.back()->Read()->head, HasSubstr("Connection: keep-alive\r\n"));
    }
  }
  RawConnection further(port, 0, kElsewhere);
  further.Send(twice);
  EXPECT_THAT(further.Read()->head, HasSubstr("Connection: close\r\n"));
  EXPECT_TRUE(further.AtEnd());
  RawConnection other(port);
  other.Send(twice);
  for (int answer = 0; answer < 2; ++answer) EXPECT_EQ(other.Read()->status, 200);
}

TEST_F(MetricsListenerTest, ProbesThatAreSentAheadShutNoOtherOut) {
  constexpr int kAhead = 100;
  const std::uint16_t port = ServeBoth();
  std::string ahead;
  for (int i = 0; i < kAhead; ++i) ahead += Ask("GET /livez", "x");
  std::vector<std::unique_ptr<RawConnection>> flood;
  for (std::size_t i = 0; i < 2 * kMetricsLimits.connections_max; ++i) {
    flood.push_back(std::make_unique<RawConnection>(port, 0, kElsewhere));
    flood.back()->Send(ahead);
    EXPECT_EQ(HttpGet(port, "/livez").status, 200) << i;
  }
}

TEST_F(MetricsListenerTest, ScrapersThatLeaveAtOnceTakeNoRoomOfOthersInTheQueue) {
  const std::uint16_t port = ServeBoth();
  BusyThread busy(*metrics_);
  const auto share = static_cast<int>(kMetricsLimits.source_share);
  const http::HttpProbe& probe = world_.http_probe;
  // The queue has room for kConnectionsMax.
  for (int i = 0; i < 2 * static_cast<int>(kConnectionsMax); ++i) {
    RawConnection(port, 0, kElsewhere).SendGet("/metrics");
    const int waiting = std::min(i + 1, share);
    ASSERT_TRUE(testing::Eventually([&] {
      return Metrics().given_up.value() == i + 1 - waiting &&
             probe.metrics_waiting.value() == waiting;
    })) << i;
  }
  RawConnection other(port);
  other.SendGet("/metrics");
  ASSERT_TRUE(testing::Eventually([&] { return probe.metrics_waiting.value() == share + 1; }));
  busy.Release();
  EXPECT_EQ(other.Read().value_or(RawAnswer()).status, 200);
  EXPECT_EQ(probe.reads_refused.value(), 0);
  EXPECT_EQ(probe.metrics_waiting.value(), 0);
}

TEST_F(MetricsListenerTest, ScrapersThatDoNotReadLeaveATextToThoseOfTheMachine) {
  constexpr int kLittle = 4096;
  AddRobotsOfManyWords(world_);
  const std::uint16_t port = ServeBoth();
  std::vector<std::unique_ptr<RawConnection>> slow;
  for (std::size_t i = 0; i < rcan::kTextsMax - rcan::kTextsReserved; ++i) {
    slow.push_back(std::make_unique<RawConnection>(port, kLittle));
    slow.back()->SendGet("/metrics/robots");
    ASSERT_TRUE(testing::Eventually([&] { return ScrapesWritten(world_) == i + 1; }));
    world_.clock.Advance(rcan::kTextShared);  // the next one gets a text of its own
  }
  EXPECT_EQ(HttpGet(port, "/metrics/robots").status, 503);
  EXPECT_EQ(world_.rcan_probe.refused_total.value(), 1);
  EXPECT_EQ(HttpGet(http_port_, "/metrics/robots").status, 200);
}

TEST_F(MetricsListenerTest, ScrapesThatWaitDelayNoneOfTheMachine) {
  const std::uint16_t port = ServeBoth();
  BusyThread busy(*scrapes_);
  for (std::size_t i = 0; i < loop::kReadsWaitingMax; ++i) {
    ASSERT_TRUE(scrapes_->TryPost([] {}));
  }
  const RawAnswer refused = HttpGet(port, "/metrics/robots");
  EXPECT_EQ(refused.status, 503) << "no room behind those that wait";
  EXPECT_THAT(refused.body, HasSubstr("too many scrapes are under way; try again"));
  RawConnection of_the_machine(http_port_);
  of_the_machine.SendGet("/metrics/robots");
  ASSERT_TRUE(testing::Eventually([&] {
    return world_.http_probe.scrapes_waiting.value() ==
           static_cast<int>(loop::kReadsWaitingMax + 1);
  }));
  busy.Release();
  EXPECT_EQ(of_the_machine.Read()->status, 200);
}

TEST_F(MetricsListenerTest, ListensOnBothFamiliesOfAnUnspecifiedAddress) {
  monitoring_ = Listen({ListenerId::kMetrics, {"::", 0}, kMetricsLimits});
  Serve();
  EXPECT_EQ(HttpGet(monitoring_->bound().port, "/readyz").status, 200);
  EXPECT_EQ(monitoring_->bound().host, "::");
}

TEST_F(MetricsListenerTest, AnAddressThatIsTakenIsNamedWithItsKey) {
  ServeBoth();
  const auto second = TryListen({ListenerId::kMetrics, monitoring_->bound(), kMetricsLimits});
  ASSERT_FALSE(second.ok());
  EXPECT_THAT(std::string(second.status().message()),
              StartsWith("listen.metrics: " + config::ToText(monitoring_->bound()) +
                         " cannot be bound: Address already in use"));
}

}  // namespace
}  // namespace uplink::http
