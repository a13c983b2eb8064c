// Requests as other clients write them, and as somebody does who wants two programs to read one
// differently.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/component/http/http_server_fixture.h"
#include "tests/support/raw_http.h"

namespace uplink::http {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::Not;
using testing::RawAnswer;
using testing::RawConnection;

constexpr const char* kLivez = "GET /livez HTTP/1.1\r\nHost: localhost\r\n";

class HttpRequestsTest : public HttpServerTest {
 protected:
  HttpRequestsTest() : port_(Serve()) {}

  /// The answer to bytes on a connection of their own.
  [[nodiscard]] RawAnswer Ask(const std::string& bytes) const {
    RawConnection connection(port_);
    connection.Send(bytes);
    return connection.Read().value_or(RawAnswer());
  }

  /// The bytes are answered with this status, and nothing that comes behind them is.
  void ExpectRefused(const std::string& bytes, int status) const {
    RawConnection connection(port_);
    connection.Send(bytes + std::string(kLivez) + "\r\n");
    const std::optional<RawAnswer> answer = connection.Read();
    ASSERT_TRUE(answer) << bytes;
    EXPECT_EQ(answer->status, status) << bytes;
    EXPECT_THAT(answer->head, HasSubstr("Connection: close\r\n")) << bytes;
    EXPECT_TRUE(connection.AtEnd()) << bytes;
  }

  const std::uint16_t port_;
};

TEST_F(HttpRequestsTest, AnyTransferEncodingEndsTheConnection) {
  for (const char* coding : {"chunked", "Chunked", "gzip", "gzip, chunked", "xchunked", "identity",
                             "chunked;q=1", "\"chunked\"", "chunked, identity", ""}) {
    const std::string header = std::string("Transfer-Encoding: ") + coding + "\r\n";
    ExpectRefused(kLivez + header + "\r\n0\r\n\r\n", 400);
    ExpectRefused(kLivez + header + "Content-Length: 5\r\n\r\n0\r\n\r\n", 400);
    ExpectRefused(kLivez + ("Content-Length: 5\r\n" + header) + "\r\n0\r\n\r\n", 400);
    ExpectRefused("GET /livez HTTP/1.0\r\n" + header + "\r\n", 400);
  }
  EXPECT_THAT(Ask(kLivez + std::string("Transfer-Encoding: gzip\r\n\r\n")).body,
              HasSubstr("Transfer-Encoding is not taken"));
}

TEST_F(HttpRequestsTest, ALineThatGoesOnEndsTheConnection) {
  ExpectRefused(kLivez + std::string("X-A: b\r\n c\r\n\r\n"), 400);
  ExpectRefused(kLivez + std::string("X-A: b\r\n\tc\r\n\r\n"), 400);
  ExpectRefused(kLivez + std::string("X-A:\r\n \r\n\r\n"), 400);
  ExpectRefused("GET /livez HTTP/1.1\r\n Host: localhost\r\n\r\n", 400);
  ExpectRefused(kLivez + std::string("Transfer-Encoding:\r\n chunked\r\n\r\n"), 400);
  EXPECT_EQ(Ask(kLivez + std::string("X-A: b c\r\nX-B: \r\n\r\n")).status, 200);
}

TEST_F(HttpRequestsTest, EachAnswerIsALine) {
  ExpectRefused(kLivez + std::string("Transfer-Encoding: chunked\r\n\r\n0\r\n\r\n"), 400);
  const auto ask = [this](const std::string& line, const std::string& headers) {
    static_cast<void>(Ask(line + " HTTP/1.1\r\n" + headers + "\r\n"));
  };
  ask("GET /api/v1/status", "Host: localhost\r\n");
  ask("GET /api/v1/status", "");
  ask("GET /api/v1/status", "Host: localhost\r\nSec-Fetch-Site: cross-site\r\n");
  ask("GET /api/v1/status", "Host: elsewhere.example\r\n");
  ask("POST /api/v1/status", "Host: localhost\r\n");
  ask("GET /nothing", "Host: localhost\r\n");
  loop_.Stop();
  const auto line = [](const std::string& of) { return HasSubstr("debug http_answered " + of); };
  EXPECT_THAT(lines_,
              ElementsAre(line("route=other status=400 ms="), line("route=status status=200 ms="),
                          line("route=status status=400 ms="), line("route=status status=403 ms="),
                          line("route=status status=421 ms="), line("route=status status=405 ms="),
                          line("route=other status=404 ms=")));
}

TEST_F(HttpRequestsTest, BytesOneByOneAreTheSameRequest) {
  RawConnection connection(port_);
  const std::string request =
      "\r\nGET /livez HTTP/1.1\r\nHost: localhost\r\nContent-Length: 3\r\n\r\nabc";
  for (const char byte : request) connection.Send(std::string(1, byte));
  EXPECT_EQ(connection.Read()->status, 200);
  for (const char byte : kLivez + std::string("X-A: b\r\n c\r\n\r\n")) {
    connection.Send(std::string(1, byte));
  }
  EXPECT_EQ(connection.Read()->status, 400);
}

TEST_F(HttpRequestsTest, LineAndHeadersTogetherHaveOneBound) {
  const auto request = [](std::size_t bytes) {
    const std::string line = "GET /livez?" + std::string(8000, 'x') + " HTTP/1.1\r\n";
    const std::string rest = "Host: localhost\r\nX-Fill: ";
    const std::string end = "\r\n\r\n";
    return line + rest + std::string(bytes - line.size() - rest.size() - end.size(), 'x') + end;
  };
  EXPECT_EQ(Ask(request(kHttpLimits.header_bytes_max)).status, 400) << "no parameter of the path";
  ExpectRefused(request(kHttpLimits.header_bytes_max + 1), 431);
}

TEST_F(HttpRequestsTest, TheHostOfAnAbsoluteTargetTakesThePlaceOfTheHeader) {
  const auto status = [this](const std::string& target, const std::string& host) {
    return Ask("GET " + target + " HTTP/1.1\r\n" + host + "\r\n").status;
  };
  const std::string local = "Host: localhost\r\n";
  const std::string foreign = "Host: rebound.example\r\n";
  EXPECT_EQ(status("http://localhost/livez", local), 200);
  EXPECT_EQ(status("HTTP://LOCALHOST:7480/api/v1/robots?fleet=a", foreign), 200);
  EXPECT_EQ(status("http://uplink.example.org/api/v1/status", foreign), 200);
  EXPECT_EQ(status("http://rebound.example/api/v1/status", local), 421);
  EXPECT_EQ(status("http://localhost", local), 404);
  EXPECT_EQ(status("http://localhost?x=1", local), 404);
  EXPECT_EQ(status("http://localhost/livez", ""), 400) << "HTTP/1.1 has the header all the same";
  EXPECT_EQ(status("http://localhost/livez", local + foreign), 400);
  EXPECT_EQ(status("http:///livez", local), 400);
  EXPECT_EQ(status("http://me@localhost/livez", local), 400);
}

TEST_F(HttpRequestsTest, WhoWaitsWithABodyIsToldToGoOn) {
  RawConnection connection(port_);
  for (int i = 0; i < 2; ++i) {
    connection.Send(kLivez + std::string("Content-Length: 3\r\nExpect: 100-Continue\r\n\r\n"));
    const std::optional<RawAnswer> interim = connection.Read();
    ASSERT_TRUE(interim);
    EXPECT_EQ(interim->head, "HTTP/1.1 100 Continue\r\n");
    connection.Send("abc");
    EXPECT_EQ(connection.Read()->status, 200);
  }
}

TEST_F(HttpRequestsTest, WhoDoesNotWaitIsNotTold) {
  const std::string expect = "Expect: 100-continue\r\n";
  EXPECT_EQ(Ask(kLivez + expect + "Content-Length: 3\r\n\r\nabc").status, 200);
  EXPECT_EQ(Ask(kLivez + expect + "\r\n").status, 200) << "there is no body";
  EXPECT_EQ(Ask(kLivez + expect + "Content-Length: 0\r\n\r\n").status, 200);
  const std::string most = std::to_string(kHttpLimits.body_bytes_max);
  EXPECT_EQ(Ask(kLivez + expect + "Content-Length: " + most + "\r\n\r\n").status, 100);
  ExpectRefused(kLivez + expect + "Content-Length: " +
                    std::to_string(kHttpLimits.body_bytes_max + 1) + "\r\n\r\n",
                413);
  EXPECT_EQ(Ask(kLivez + ("Content-Length: " + most + "\r\n\r\n") +
                std::string(kHttpLimits.body_bytes_max, 'x'))
                .status,
            200);
  RawConnection old(port_);
  old.Send("GET /livez HTTP/1.0\r\n" + expect + "Content-Length: 3\r\n\r\n");
  old.Send("abc");
  EXPECT_EQ(old.Read()->status, 200) << "HTTP/1.0 knows no 100";
}

TEST_F(HttpRequestsTest, OneEmptyLineBeforeARequestIsSkipped) {
  RawConnection connection(port_);
  for (int i = 0; i < 2; ++i) {
    connection.Send("\r\n" + std::string(kLivez) + "\r\n");
    EXPECT_EQ(connection.Read()->status, 200);
  }
  ExpectRefused("\r\n\r\n", 400);
  ExpectRefused("\n", 400);
}

TEST_F(HttpRequestsTest, WhatIsNotHttpIs400) {
  const std::string tls = "\x16\x03\x01 this is no request\r\n\r\n";
  EXPECT_THAT(Ask(tls).body, HasSubstr("INVALID_ARGUMENT"));
  ExpectRefused(tls, 400);
}

TEST_F(HttpRequestsTest, TheHeaderNamesOneHostWhereTheVersionHasIt) {
  EXPECT_EQ(Ask("GET /api/v1/status HTTP/1.0\r\n\r\n").status, 200);
  EXPECT_EQ(Ask("GET /livez HTTP/1.1\r\n\r\n").status, 400);
  EXPECT_EQ(Ask("GET /livez HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n").status, 400);
  EXPECT_EQ(Ask("GET /livez HTTP/1.1\r\nHost: rebound.example\r\n\r\n").status, 200);
  EXPECT_EQ(Ask("GET /api/v1/status HTTP/1.1\r\nHost: rebound.example\r\n\r\n").status, 421);
}

TEST_F(HttpRequestsTest, EachAnswerHasADateAndSaysHowLongItsConnectionIsKept) {
  const std::string date =
      ".*\r\nDate: [A-Z][a-z]+, [0-9]+ [A-Z][a-z]+ [0-9]+ [0-9]+:[0-9]+:[0-9]+ GMT\r\n.*";
  for (const char* target : {"/livez", "/metrics", "/metrics/robots", "/nowhere"}) {
    RawConnection connection(port_);
    connection.SendGet(target);
    const std::string head = connection.Read()->head;
    EXPECT_THAT(head, MatchesRegex(date));
    EXPECT_THAT(head, HasSubstr("\r\nConnection: keep-alive\r\n"));
    EXPECT_THAT(head, HasSubstr("\r\nKeep-Alive: timeout=75\r\n"));
  }
  const std::string last = Ask(std::string(kLivez) + "Connection: close\r\n\r\n").head;
  EXPECT_THAT(last, MatchesRegex(date));
  EXPECT_THAT(last, Not(HasSubstr("Keep-Alive")));
  EXPECT_THAT(Ask("no request\r\n\r\n").head, MatchesRegex(date));
}

TEST_F(HttpRequestsTest, PagesOfOtherSitesAreShownNoData) {
  const auto status = [this](const std::string& target, const std::string& header) {
    return Ask("GET " + target + " HTTP/1.1\r\nHost: localhost\r\n" + header + "\r\n\r\n").status;
  };
  EXPECT_EQ(status("/api/v1/status", "Sec-Fetch-Site: cross-site"), 403);
  EXPECT_EQ(status("/api/v1/status", "Sec-Fetch-Site: same-origin"), 200);
  EXPECT_EQ(status("/api/v1/status", "Origin: https://evil.example"), 403);
  EXPECT_EQ(status("/api/v1/status", "Origin: http://localhost:3000"), 200);
  EXPECT_EQ(status("/livez", "Origin: https://evil.example"), 200);
}

class HttpWaitsTest : public HttpServerTest {
 protected:
  static constexpr milliseconds kShort{50};
};

TEST_F(HttpWaitsTest, AnIdleConnectionOutlivesTheTimeOfARequest) {
  const std::uint16_t port = Serve("127.0.0.1", kShort);
  RawConnection idle(port);
  idle.SendGet("/livez");
  ASSERT_EQ(idle.Read()->status, 200);
  RawConnection fresh(port);
  // These time pass: each is closed at the end of its request's time.
  for (int i = 0; i < 2; ++i) {
    RawConnection begun(port);
    begun.Send("GET /livez HTTP/1.1\r\n");
    EXPECT_TRUE(begun.AtEnd());
  }
  idle.SendGet("/livez");
  EXPECT_TRUE(idle.Read());
  fresh.SendGet("/livez");
  EXPECT_TRUE(fresh.Read());
  // A request that is begun late has its own time, and no more.
  idle.Send("G");
  EXPECT_TRUE(idle.AtEnd());
}

TEST_F(HttpWaitsTest, AConnectionWithoutARequestEndsAtItsTime) {
  const std::uint16_t port = Serve("127.0.0.1", kHttpLimits.request_wait, kShort);
  RawConnection silent(port);
  EXPECT_TRUE(silent.AtEnd());
  RawConnection empty(port);
  empty.Send("\r\n");
  EXPECT_TRUE(empty.AtEnd()) << "an empty line begins no request";
  RawConnection answered(port);
  answered.SendGet("/livez");
  EXPECT_EQ(answered.Read()->status, 200);
  EXPECT_TRUE(answered.AtEnd());
}

}  // namespace
}  // namespace uplink::http
