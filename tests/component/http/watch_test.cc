// /api/v1/watch on a real connection: its events, its place among connections, its end.
#include <string>
#include <utility>
#include <vector>

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include "server/robot/live_bytes.h"
#include "tests/component/http/http_server_fixture.h"
#include "tests/support/eventually.h"
#include "tests/support/raw_http.h"
#include "tests/support/records.h"

namespace uplink::http {
namespace {

using testing::Eventually;
using ::testing::HasSubstr;
using testing::HttpGet;
using ::testing::Not;
using ::testing::StartsWith;

/// A client that reads what comes, as it comes. Reads give up after ten seconds.
class EventReader final {
 public:
  EventReader(std::uint16_t port, const std::string& target)
      : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval wait{.tv_sec = 10, .tv_usec = 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &wait, sizeof(wait));
    EXPECT_EQ(::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
    const std::string request = "GET " + target + " HTTP/1.1\r\nHost: localhost\r\n\r\n";
    EXPECT_EQ(::send(socket_, request.data(), request.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(request.size()));
  }
  ~EventReader() { ::close(socket_); }
  EventReader(const EventReader&) = delete;
  EventReader& operator=(const EventReader&) = delete;

  /// What came, up to this text and with it; all of it if the connection ends first.
  std::string Until(const std::string& text) {
    std::size_t at = 0;
    while ((at = read_.find(text)) == std::string::npos) {
      if (!ReadMore()) return std::exchange(read_, {});
    }
    std::string first = read_.substr(0, at + text.size());
    read_.erase(0, at + text.size());
    return first;
  }
  bool AtEnd() {
    while (ReadMore()) continue;
    return true;
  }

 private:
  bool ReadMore() {
    char bytes[4096];
    const ssize_t n = ::recv(socket_, bytes, sizeof(bytes), 0);
    if (n <= 0) return false;
    read_.append(bytes, static_cast<std::size_t>(n));
    return true;
  }

  const int socket_;
  std::string read_;
};

class WatchTest : public HttpServerTest {
 protected:
  WatchTest() : port_(Serve()) {}

  /// A message of the robot comes.
  void Touch(robot::Robot& robot) {
    std::vector<model::Record> records;
    records.push_back(test::RecordOf(model::StatusTelemetry{.faulted = true}));
    robot.state.Apply(records, world_.clock.Steady());
  }

  const std::uint16_t port_;
};

TEST_F(WatchTest, ShowsASnapshotItsEndAndWhatChanges) {
  robot::Robot& robot = world_.AddRobot("rcan://a", "north");
  world_.AddRobot("rcan://b", "south");
  EventReader reader(port_, "/api/v1/watch?fleet=north&parts=none");
  const std::string head = reader.Until("\r\n\r\n");
  EXPECT_THAT(head, StartsWith("HTTP/1.1 200 OK\r\n"));
  EXPECT_THAT(head, HasSubstr("Content-Type: text/event-stream\r\n"));
  EXPECT_THAT(head, HasSubstr("Cache-Control: no-store\r\n"));
  const std::string snapshot = reader.Until("event: snapshotEnd\n");
  EXPECT_THAT(snapshot, StartsWith("id: 1\nevent: robot\ndata: {\"robot\":{\"ruri\":\"rcan://a\""));
  EXPECT_THAT(snapshot, Not(HasSubstr("rcan://b")));
  EXPECT_EQ(reader.Until("\n\n"), "data: {\"snapshotEnd\":{\"robots\":\"1\"}}\n\n");
  Touch(robot);
  world_.watches.Sweep();
  EXPECT_THAT(reader.Until("\n\n"), StartsWith("id: 3\nevent: robot\ndata: {\"robot\":"));
  robot.SetFleet("south");
  world_.watches.Sweep();
  EXPECT_EQ(reader.Until("\n\n"), "id: 4\nevent: removed\ndata: {\"removed\":\"rcan://a\"}\n\n");
}

TEST_F(WatchTest, EndsWithItsClient) {
  {
    EventReader reader(port_, "/api/v1/watch");
    reader.Until("snapshotEnd");
    EXPECT_EQ(world_.watches.size(), 1U);
  }
  EXPECT_TRUE(Eventually([&] { return world_.watches.size() == 0; }));
  EXPECT_TRUE(Eventually([&] { return Connections().open.value() == 0; }));
}

TEST_F(WatchTest, SaysWhyItEnds) {
  EventReader reader(port_, "/api/v1/watch");
  reader.Until("snapshotEnd");
  reader.Until("\n\n");
  world_.watches.Stop();
  EXPECT_THAT(reader.Until("\n\n"),
              HasSubstr("event: end\ndata: {\"error\":{\"code\":\"UNAVAILABLE\""));
  EXPECT_TRUE(reader.AtEnd());
}

TEST_F(WatchTest, TakesHalfOfThePlacesAtMost) {
  std::vector<std::unique_ptr<EventReader>> readers;
  for (std::size_t i = 0; i < kConnectionsMax / 2; ++i) {
    readers.push_back(std::make_unique<EventReader>(port_, "/api/v1/watch"));
    readers.back()->Until("snapshotEnd");
  }
  const testing::RawAnswer refused = HttpGet(port_, "/api/v1/watch");
  EXPECT_EQ(refused.status, 503);
  EXPECT_THAT(refused.body, HasSubstr("http.connections_max"));
  EXPECT_EQ(HttpGet(port_, "/livez").status, 200);
}

TEST_F(WatchTest, AnswersWrongParametersAndHeadAsOtherPathsDo) {
  EXPECT_EQ(HttpGet(port_, "/api/v1/watch?parts=wheels").status, 400);
  EXPECT_EQ(HttpGet(port_, "/api/v1/watch?pageSize=1").status, 400);
  EXPECT_EQ(HttpGet(port_, "/api/v1/watch?orderBy=battery").status, 400);
  testing::RawConnection head(port_);
  head.Send("HEAD /api/v1/watch HTTP/1.1\r\nHost: localhost\r\n\r\n");
  const auto answer = head.Read(testing::RawConnection::Body::kNone);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, 200);
  EXPECT_TRUE(Eventually([&] { return world_.watches.size() == 0; }));
}

}  // namespace
}  // namespace uplink::http
