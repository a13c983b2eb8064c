#include "tests/support/raw_http.h"

#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <system_error>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "schema/base/check.h"

namespace uplink::testing {

RawConnection::RawConnection(std::uint16_t port, int receive_bytes, const char* from)
    : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
  UPLINK_CHECK(socket_ >= 0, "a test can open a socket");
  const timeval wait{.tv_sec = 10, .tv_usec = 0};
  setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &wait, sizeof(wait));
  if (receive_bytes > 0) {
    setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_bytes, sizeof(receive_bytes));
  }
  sockaddr_in address{};
  address.sin_family = AF_INET;
  if (from != nullptr) {
    address.sin_addr.s_addr = inet_addr(from);
    UPLINK_CHECK(bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0,
                 "a test can have an address of loopback");
  }
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  // Without a connection nothing can be sent or read below.
  if (connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    const std::error_code why(errno, std::generic_category());
    std::fprintf(stderr, "no connection to port %d: %s\n", port, why.message().c_str());
  }
}

RawConnection::~RawConnection() { close(socket_); }

void RawConnection::Send(const std::string& bytes) {
  std::size_t sent = 0;
  while (sent < bytes.size()) {
    const ssize_t n = send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (n <= 0) return;  // the peer closed: what it answered can still be read
    sent += static_cast<std::size_t>(n);
  }
}

void RawConnection::SendGet(const std::string& target) {
  Send("GET " + target + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
}

bool RawConnection::ReadMore() {
  char bytes[8192];
  const ssize_t n = recv(socket_, bytes, sizeof(bytes), 0);
  if (n <= 0) return false;
  buffer_.append(bytes, static_cast<std::size_t>(n));
  return true;
}

std::optional<RawAnswer> RawConnection::Read(Body body) {
  std::size_t end = 0;
  while ((end = buffer_.find("\r\n\r\n")) == std::string::npos) {
    if (!ReadMore()) return std::nullopt;
  }
  RawAnswer answer;
  answer.head = buffer_.substr(0, end + 2);
  buffer_.erase(0, end + 4);
  answer.status = static_cast<int>(
      std::strtol(answer.head.substr(answer.head.find(' ') + 1, 3).c_str(), nullptr, 10));
  const std::string name = "Content-Length: ";
  const std::size_t at = answer.head.find(name);
  if (body == Body::kNone || at == std::string::npos) return answer;
  const std::size_t length = std::strtoul(answer.head.c_str() + at + name.size(), nullptr, 10);
  while (buffer_.size() < length) {
    if (!ReadMore()) return std::nullopt;
  }
  answer.body = buffer_.substr(0, length);
  buffer_.erase(0, length);
  return answer;
}

bool RawConnection::AtEnd() { return buffer_.empty() && !ReadMore(); }

RawAnswer HttpGet(std::uint16_t port, const std::string& target) {
  RawConnection connection(port);
  connection.SendGet(target);
  return connection.Read().value_or(RawAnswer());
}

}  // namespace uplink::testing
