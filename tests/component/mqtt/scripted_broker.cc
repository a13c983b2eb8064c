#include "tests/component/mqtt/scripted_broker.h"

#include <array>
#include <cerrno>

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include "schema/base/check.h"

namespace uplink::testing {

ScriptedBroker::ScriptedBroker()
    : listener_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  auto* const generic = reinterpret_cast<sockaddr*>(&address);
  UPLINK_CHECK(listener_ >= 0 && bind(listener_, generic, size) == 0 && listen(listener_, 8) == 0 &&
                   getsockname(listener_, generic, &size) == 0,
               "a test can listen");
  port_ = ntohs(address.sin_port);
}

ScriptedBroker::~ScriptedBroker() {
  Hang();
  close(listener_);
}

std::size_t ScriptedBroker::Poll() {
  const int next = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (next >= 0) {
    Hang();
    socket_ = next;
    const int yes = 1;
    setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof(yes));
    ended_ = false;
    received_.clear();
    ++accepted_;
  }
  return accepted_;
}

const std::string& ScriptedBroker::received() {
  Poll();
  std::array<char, 4096> bytes{};
  ssize_t count = 0;
  while (socket_ >= 0 && (count = recv(socket_, bytes.data(), bytes.size(), 0)) > 0) {
    received_.append(bytes.data(), static_cast<std::size_t>(count));
  }
  if (socket_ >= 0 && (count == 0 || (errno != EAGAIN && errno != EINTR))) ended_ = true;
  return received_;
}

bool ScriptedBroker::ended() {
  static_cast<void>(received());
  return ended_;
}

void ScriptedBroker::Send(std::string_view bytes) {
  const ssize_t sent = send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  UPLINK_CHECK(sent == static_cast<ssize_t>(bytes.size()), "the system takes what a test says");
}

void ScriptedBroker::Hang() {
  if (socket_ >= 0) close(socket_);
  socket_ = -1;
}

}  // namespace uplink::testing
