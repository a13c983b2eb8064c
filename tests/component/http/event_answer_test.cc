// How an answer of events ends, on a real socket whose reader is slow.
#include "server/http/event_answer.h"

#include <array>
#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <boost/asio/generic/stream_protocol.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include "tests/component/http/http_server_fixture.h"
#include "tests/support/eventually.h"

namespace uplink::http {
namespace {

using ::testing::EndsWith;
using testing::Eventually;
using ::testing::HasSubstr;

/// More than a socket takes.
constexpr std::size_t kEventBytes = std::size_t{16} * 1024 * 1024;
/// Long enough that a reader takes the last event before the next one is due.
constexpr milliseconds kComment{200};
constexpr milliseconds kJudge{20};

/// One large event, and then nothing, or the same again and again.
class OneEvent final : public EventStream {
 public:
  Taken Take() override {
    if (std::exchange(taken_, true) && !endless) return {};
    return {.text = "data: " + std::string(kEventBytes, 'x') + "\n\n"};
  }
  void OnReady(std::function<void()> /*ready*/) override {}
  [[nodiscard]] const std::string& caller() const override { return caller_; }
  void NoteDenied() override { denied = true; }

  std::atomic<bool> denied{false};
  std::atomic<bool> endless{false};

 private:
  const std::string caller_;
  bool taken_ = false;
};

/// What a connection has of one.
struct Held {
  Held(const HttpServer::Context& all, RawStream::socket_type socket)
      : context(all, HttpServer::Options{}), wire(std::move(socket)) {}

  ConnectionContext context;
  Wire wire;
  std::optional<EventAnswer> answer;
};

class EventAnswerTest : public HttpServerTest {
 protected:
  EventAnswerTest() {
    std::array<int, 2> ends{};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()), 0);
    client_ = ends[0];
    const timeval patience{.tv_sec = 20, .tv_usec = 0};
    ::setsockopt(client_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
    RawStream::socket_type socket(loop_.io());
    socket.assign(boost::asio::generic::stream_protocol(AF_UNIX, 0), ends[1]);
    held_ = std::make_shared<Held>(
        HttpServer::Context{loop_.io(), entrance_, *memory_, *reads_, *metrics_, *scrapes_,
                            *watches_, world_.http_probe, clock_, logger_},
        std::move(socket));
    loop_.Start();
    loop_.Post([this, held = held_] {
      held->answer.emplace(EventAnswer::Parts{.context = held->context,
                                              .wire = held->wire,
                                              .connection = held,
                                              .events = events_,
                                              .may_go_on =
                                                  [this] {
                                                    ++asked_;
                                                    return may_go_on_.load();
                                                  },
                                              .comment_every = kComment,
                                              .judge_every = kJudge});
      held->answer->Begin();
    });
  }
  ~EventAnswerTest() override {
    ::close(client_);
    // It ends on the loop's thread, as connections do.
    std::weak_ptr<Held> gone = held_;
    loop_.Post([held = std::exchange(held_, nullptr)] { held->answer->End(); });
    EXPECT_TRUE(Eventually([&] { return gone.expired(); }));
  }

  /// Until the server has asked again, after now, whether the caller may go on.
  bool AskedAgain() {
    const int before = asked_;
    return Eventually([&] { return asked_ > before; });
  }
  /// Until the event is being sent: a socket does not take it whole.
  void ReadItsBegin() {
    std::array<char, 256> bytes{};
    while (read_.find("data: ") == std::string::npos) {
      const ssize_t n = ::recv(client_, bytes.data(), bytes.size(), 0);
      ASSERT_GT(n, 0);
      read_.append(bytes.data(), static_cast<std::size_t>(n));
    }
  }
  /// All that comes until the server ends it.
  std::string ReadAll() {
    std::string all = std::move(read_);
    std::string bytes(64UL * 1024, '\0');
    while (true) {
      const ssize_t n = ::recv(client_, bytes.data(), bytes.size(), 0);
      if (n <= 0) return all;
      all.append(bytes, 0, static_cast<std::size_t>(n));
    }
  }

  const std::shared_ptr<OneEvent> events_ = std::make_shared<OneEvent>();
  std::atomic<bool> may_go_on_{true};
  std::atomic<int> asked_{0};
  int client_ = -1;
  /// What ReadAll begins with.
  std::string read_;
  std::shared_ptr<Held> held_;
};

TEST_F(EventAnswerTest, ACallerThatIsDeniedWhileItsEventsAreSentIsToldAfterThem) {
  ReadItsBegin();
  may_go_on_ = false;
  ASSERT_TRUE(AskedAgain()) << "while the event is sent";
  const std::string all = ReadAll();
  EXPECT_GT(all.size(), kEventBytes) << "the event is whole";
  const std::string end = all.substr(all.rfind("event: "));
  EXPECT_THAT(end, HasSubstr("event: end\ndata: {\"error\":{\"code\":\"UNAUTHENTICATED\""));
  EXPECT_THAT(end, EndsWith("}}\n\n"));
  EXPECT_TRUE(events_->denied);
}

TEST_F(EventAnswerTest, AfterTheEventThatIsSentOneWhoIsDeniedSeesNoFurtherOne) {
  events_->endless = true;
  ReadItsBegin();
  may_go_on_ = false;
  ASSERT_TRUE(AskedAgain()) << "while an event is sent";
  const std::string all = ReadAll();
  EXPECT_LT(all.size(), 2 * kEventBytes) << "although more is there";
  EXPECT_THAT(all, EndsWith("}}\n\n"));
}

}  // namespace
}  // namespace uplink::http
