#include "tools/uplink-fleet/report/process_use.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace uplink::synthetic {
namespace {

/// A socket on a free port of the loopback, not yet listening.
class Port {
 public:
  Port() : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    socklen_t size = sizeof address;
    getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size);
    number_ = ntohs(address.sin_port);
  }
  ~Port() { close(socket_); }
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;

  void Listen() const { ASSERT_EQ(listen(socket_, 1), 0); }
  [[nodiscard]] std::uint16_t number() const { return number_; }

 private:
  int socket_;
  std::uint16_t number_ = 0;
};

TEST(ProcessUseTest, AProcessUsesMemoryAndItsCpuOnlyGrows) {
  const auto before = UseOf(getpid());
  ASSERT_TRUE(before.has_value());
  EXPECT_GT(before->rss_bytes, 100'000U);
  EXPECT_GE(UseOf(getpid())->Since(*before).cpu_seconds, 0);
}

TEST(ProcessUseTest, NoProcessUsesNothing) {
  // Above what the kernel gives (PID_MAX_LIMIT, 2^22).
  EXPECT_FALSE(UseOf(1 << 23).has_value());
}

TEST(ProcessUseTest, FindsWhoListens) {
  const Port port;
  EXPECT_FALSE(ListenerOf(port.number()).has_value());
  port.Listen();
  EXPECT_EQ(ListenerOf(port.number()), getpid());
}

}  // namespace
}  // namespace uplink::synthetic
