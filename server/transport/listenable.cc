#include "server/transport/listenable.h"

#include <cerrno>
#include <cstdint>
#include <string>
#include <system_error>

#include <fmt/format.h>
#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

namespace uplink::transport {
namespace {

std::string SystemReason() { return std::error_code(errno, std::generic_category()).message(); }

/// Binds as the acceptor does, and closes; empty if that works. It does not listen, since no one
/// would answer.
std::string TryBind(const addrinfo& info) {
  const int descriptor = ::socket(info.ai_family, info.ai_socktype | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return SystemReason();
  const int on = 1;
  ::setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
  std::string reason;
  if (::bind(descriptor, info.ai_addr, info.ai_addrlen) != 0) reason = SystemReason();
  ::close(descriptor);
  return reason;
}

/// What TryBind says of a literal address.
std::string TryBind(const std::string& host, std::uint16_t port) {
  addrinfo hints{};
  hints.ai_flags = AI_PASSIVE | AI_NUMERICHOST | AI_NUMERICSERV;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int error = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found);
  if (error != 0) return ::gai_strerror(error);
  std::string reason = TryBind(*found);
  ::freeaddrinfo(found);
  return reason;
}

bool HasIpv6() {
  const int descriptor = ::socket(AF_INET6, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return errno != EAFNOSUPPORT;
  ::close(descriptor);
  return true;
}

}  // namespace

std::string ListenHost(const config::ListenAddress& address) {
  return address.host == "::" && !HasIpv6() ? "0.0.0.0" : address.host;
}

absl::Status CheckListenable(const config::ListenAddress& address) {
  const std::string reason = TryBind(ListenHost(address), address.port);
  if (reason.empty()) return absl::OkStatus();
  return absl::UnavailableError(
      fmt::format("listen.relay: cannot listen on {}: {}; set an address of this machine and a "
                  "free port",
                  config::ToText(address), reason));
}

}  // namespace uplink::transport
