#include "server/relay/listenable.h"

#include <cerrno>
#include <string>
#include <system_error>

#include <fmt/format.h>
#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

namespace uplink::relay {
namespace {

std::string SystemReason() { return std::error_code(errno, std::generic_category()).message(); }

/// Binds as gRPC does, and lets go; empty if that works. It does not listen: nobody would answer.
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

}  // namespace

absl::Status CheckListenable(const config::ListenAddress& address) {
  const std::string text = config::ToText(address);
  addrinfo hints{};
  hints.ai_flags = AI_PASSIVE | AI_NUMERICHOST | AI_NUMERICSERV;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int error =
      ::getaddrinfo(address.host.c_str(), std::to_string(address.port).c_str(), &hints, &found);
  if (error != 0) {
    return absl::UnavailableError(
        fmt::format("cannot listen on {}: {}", text, ::gai_strerror(error)));
  }
  const std::string reason = TryBind(*found);
  ::freeaddrinfo(found);
  if (reason.empty()) return absl::OkStatus();
  return absl::UnavailableError(fmt::format("cannot listen on {}: {}", text, reason));
}

}  // namespace uplink::relay
