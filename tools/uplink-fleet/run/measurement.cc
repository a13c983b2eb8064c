#include "tools/uplink-fleet/run/measurement.h"

#include <chrono>

#include <unistd.h>

namespace uplink::synthetic {
namespace {

/// The server, if it is a process of this machine.
std::optional<pid_t> ServerAt(const std::string& address) {
  const std::string host = address.substr(0, address.rfind(':'));
  if (host != "localhost" && host != "[::1]" && !host.starts_with("127.")) return std::nullopt;
  return ListenerOf(
      static_cast<std::uint16_t>(std::stoul("0" + address.substr(address.rfind(':') + 1))));
}

}  // namespace

Measurement::Measurement(const std::string& address, const Clock& clock)
    : clock_(clock), server_(ServerAt(address)) {}

void Measurement::Begin() {
  server_before_ = server_ ? UseOf(*server_) : std::nullopt;
  own_before_ = UseOf(getpid()).value_or(ProcessUse());
  began_ = clock_.Steady();
}

Measured Measurement::SinceBegin() const {
  Measured measured{.seconds = std::chrono::duration<double>(clock_.Steady() - began_).count(),
                    .server = server_ ? UseOf(*server_) : std::nullopt,
                    .own = UseOf(getpid()).value_or(ProcessUse()).Since(own_before_)};
  if (measured.server) {
    measured.server =
        server_before_ ? std::optional(measured.server->Since(*server_before_)) : std::nullopt;
  }
  return measured;
}

}  // namespace uplink::synthetic
