#include "server/run/relay_side.h"

#include <utility>

#include "server/front/door/proxy_header.h"
#include "server/health/process.h"
#include "server/run/from_config.h"

namespace uplink::run {

RelaySide::RelaySide(const Context& context)
    : context_(context),
      session_limits_(SessionLimitsOf(context.config, context.version)),
      forwarding_({context.clock, context.logger, *context.stores.shared, *context.stores.clock,
                   context.seed, context.stores.change_signal.get()}),
      rejects_(*context.stores.reader, context.reads_ahead) {}

absl::Status RelaySide::Listen() {
  auto server = front::FrontServer::Start(RelayOptionsOf(context_.config, health::MemoryMax()),
                                          FrontContext(probe_), context_.others);
  if (!server.ok()) return server.status();
  server_ = *std::move(server);
  listening_.store(server_.get());
  return absl::OkStatus();
}

front::RelayContext RelaySide::FrontContext(transport::RelayProbe& probe) {
  return {context_.clock,
          context_.fleet,
          context_.journals,
          session_probe_,
          probe,
          context_.ledgers,
          session_limits_,
          JudgeLimitsOf(context_.config.limits),
          context_.allowances,
          rejects_,
          *context_.stores.clock,
          &forwarding_.source(),
          &context_.logger,
          &context_.reports,
          &context_.denied};
}

Drain::Transport RelaySide::DrainTransport() {
  return {.streams = [this] { return server_->streams(); },
          .drain = [this](milliseconds wait) { server_->Drain(wait); },
          .wait_for_streams = [this](milliseconds wait) { return server_->WaitForStreams(wait); }};
}

loop::ProbeTarget RelaySide::Target() {
  const config::ListenConfig& own = context_.config.listen;
  return {{own.relay.host, server_->port()},
          own.proxy_protocol_from,
          std::string(front::kLocalProxyHeader),
          &probe_.own_port};
}

}  // namespace uplink::run
