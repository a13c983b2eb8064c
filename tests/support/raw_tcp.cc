#include "tests/support/raw_tcp.h"

#include <algorithm>
#include <cerrno>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "schema/base/check.h"

namespace uplink::testing {
namespace {

sockaddr_in AddressOf(const std::string& host, std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  UPLINK_CHECK(inet_pton(AF_INET, host.c_str(), &address.sin_addr) == 1, "a literal address");
  return address;
}

}  // namespace

RawTcp::RawTcp(std::uint16_t port, const std::string& source)
    : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  UPLINK_CHECK(socket_ >= 0, "a test can open a socket");
  const int yes = 1;
  if (!source.empty()) {
    const sockaddr_in from = AddressOf(source, 0);
    // The port is chosen with the peer known, so that each source may use all of them.
    setsockopt(socket_, IPPROTO_IP, IP_BIND_ADDRESS_NO_PORT, &yes, sizeof(yes));
    const int bound = bind(socket_, reinterpret_cast<const sockaddr*>(&from), sizeof(from));
    UPLINK_CHECK(bound == 0, "127.0.0.0/8 is this machine");
  }
  setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof(yes));
  const sockaddr_in to = AddressOf("127.0.0.1", port);
  // Loopback's answer is immediate: the kernel takes connections for the server.
  const int connected = connect(socket_, reinterpret_cast<const sockaddr*>(&to), sizeof(to));
  if (connected != 0) end_ = End::kReset;
}

RawTcp::~RawTcp() { close(socket_); }

std::size_t RawTcp::SendSome(std::string_view bytes) {
  const ssize_t sent = send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  if (sent >= 0) return static_cast<std::size_t>(sent);
  if (errno != EAGAIN && errno != EINTR && end_ == End::kNone) end_ = End::kReset;
  return 0;
}

std::string RawTcp::Receive() {
  std::string bytes(kReceiveBytesMax, '\0');
  const ssize_t received = recv(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT);
  if (received == 0 && end_ == End::kNone) end_ = End::kClosed;
  if (received < 0 && errno != EAGAIN && errno != EINTR) end_ = End::kReset;
  bytes.resize(static_cast<std::size_t>(std::max<ssize_t>(received, 0)));
  return bytes;
}

bool RawTcp::Wait(For what, SteadyTime deadline) const {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - SystemClock{}.Steady());
  if (left.count() <= 0) return false;
  const short events = static_cast<short>(what == For::kInput ? POLLIN : POLLIN | POLLOUT);
  pollfd one{.fd = socket_, .events = events, .revents = 0};
  return poll(&one, 1, static_cast<int>(left.count())) > 0;
}

bool RawTcp::WaitForEnd(std::chrono::milliseconds patience) {
  const SteadyTime deadline = SystemClock{}.Steady() + patience;
  while (end_ == End::kNone && Wait(For::kInput, deadline)) static_cast<void>(Receive());
  return end_ != End::kNone;
}

}  // namespace uplink::testing
