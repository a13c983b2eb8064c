#include "server/front/loop/socket.h"

#include <array>
#include <string>

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/support/eventually.h"

namespace uplink::front {
namespace {

/// The two ends of a TCP connection on loopback.
std::array<int, 2> Connected() {
  const int listener = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  auto* const any = reinterpret_cast<sockaddr*>(&address);
  EXPECT_EQ(::bind(listener, any, size), 0);
  EXPECT_EQ(::listen(listener, 1), 0);
  EXPECT_EQ(::getsockname(listener, any, &size), 0);
  const int peer = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  EXPECT_EQ(::connect(peer, any, size), 0);
  const int mine = ::accept4(listener, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  EXPECT_GE(mine, 0);
  ::close(listener);
  return {mine, peer};
}

class SocketTest : public ::testing::Test, public SocketOwner {
 protected:
  SocketTest() : ends_(Connected()), socket_(loop_, ends_[0], *this, shared_) {
    EXPECT_TRUE(socket_.Start());
  }
  ~SocketTest() override { ::close(ends_[1]); }

  void OnReceived(std::string_view /*bytes*/) override {}
  void OnReceiveEnd() override {}
  void OnUnblocked() override {}
  void AfterEvent() override {}

  /// Until the system takes no more.
  void Fill() {
    while (!socket_.blocked()) ASSERT_TRUE(socket_.Send(std::string(kSendBytesMax, 'x')));
  }
  void PeerReads(std::size_t bytes) {
    std::string into(bytes, '\0');
    EXPECT_EQ(::recv(ends_[1], into.data(), bytes, MSG_WAITALL), static_cast<ssize_t>(bytes));
  }

  EventLoop loop_{{.timer = [] {}, .after = [] {}}};
  std::array<char, kSharedReadBytes> shared_{};
  std::array<int, 2> ends_;
  Socket socket_;
};

TEST_F(SocketTest, APeerThatHasNothingToReadTakesNothing) {
  EXPECT_FALSE(socket_.TakesSome());
  ASSERT_TRUE(socket_.Send("x"));
  PeerReads(1);
  EXPECT_FALSE(socket_.TakesSome()) << "its system takes what is little, whatever it does itself";
}

TEST_F(SocketTest, APeerThatReadsSomeOfMuchTakesSome) {
  Fill();
  ASSERT_TRUE(testing::Eventually([this] { return !socket_.TakesSome(); }))
      << "its system has no room for more";
  EXPECT_FALSE(socket_.TakesSome()) << "it reads nothing";
  PeerReads(std::size_t{1024} * 1024);
  EXPECT_TRUE(testing::Eventually([this] { return socket_.TakesSome(); }));
  EXPECT_TRUE(testing::Eventually([this] { return !socket_.TakesSome(); }));
}

TEST_F(SocketTest, AClosedOneTakesNothing) {
  Fill();
  socket_.Close();
  EXPECT_FALSE(socket_.TakesSome());
}

}  // namespace
}  // namespace uplink::front
