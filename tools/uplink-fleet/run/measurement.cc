#include "tools/uplink-fleet/run/measurement.h"

#include <chrono>

#include <unistd.h>

namespace uplink::synthetic {
namespace {

/// The server, if it is a process of this machine.
std::optional<pid_t> ServerAt(const std::string& target) {
  const std::string host = target.substr(0, target.rfind(':'));
  if (host != "localhost" && host != "[::1]" && !host.starts_with("127.")) return std::nullopt;
  return ListenerOf(
      static_cast<std::uint16_t>(std::stoul("0" + target.substr(target.rfind(':') + 1))));
}

}  // namespace

Measurement::Measurement(const std::string& target, const Clock& clock, const Shared& shared)
    : clock_(clock), shared_(shared), server_(ServerAt(target)) {}

void Measurement::Begin() {
  server_before_ = server_ ? UseOf(*server_) : std::nullopt;
  own_before_ = UseOf(getpid()).value_or(ProcessUse());
  sent_before_ = shared_.sent.load();
  began_ = clock_.Steady();
}

void Measurement::End(RunFigures& figures) const {
  const std::optional<ProcessUse> server_after = server_ ? UseOf(*server_) : std::nullopt;
  if (server_before_ && server_after) figures.server = server_after->Since(*server_before_);
  figures.sent_while_measured = shared_.sent.load() - sent_before_;
  figures.own = UseOf(getpid()).value_or(ProcessUse()).Since(own_before_);
  figures.seconds = std::chrono::duration<double>(clock_.Steady() - began_).count();
}

}  // namespace uplink::synthetic
