#include "server/run/fleet_side.h"

#include <chrono>
#include <utility>

#include "server/health/process.h"
#include "server/run/from_config.h"

namespace uplink::run {
namespace {

/// How long calls under way have when the server stops.
constexpr std::chrono::seconds kLastCalls{1};

}  // namespace

FleetSide::FleetSide(const Context& context) : context_(context) {
  calls_.post = [&early = context.early](http::Lane lane, std::function<void()> job) {
    return early.Post(lane, std::move(job));
  };
}

absl::Status FleetSide::Listen() {
  if (!config::IsSet(context_.config.listen.fleet)) return absl::OkStatus();
  auto server = front::FrontServer::Start(
      FleetOptionsOf(context_.config, health::MemoryMax()),
      context_.relay.FrontContext(context_.probe.listener),
      rpc::FleetMethods({context_.site, context_.early.access().guard(), context_.health.monitor(),
                         context_.watches, calls_, context_.probe}));
  if (!server.ok()) return server.status();
  server_ = *std::move(server);
  listening_.store(server_.get());
  return absl::OkStatus();
}

void FleetSide::Look() {
  if (server_ == nullptr) return;
  const transport::FilesLook look = server_->RefreshFiles();
  const std::string before = std::exchange(why_, std::string(look.status.message()));
  if (why_ == before) return;
  if (look.status.ok()) {
    context_.logger.Info("fleet_certificate_served", {});
  } else {
    context_.logger.Error("fleet_certificate_mismatch", {{"why", why_}});
  }
}

void FleetSide::Stop() {
  if (server_ == nullptr) return;
  server_->Drain(kLastCalls);
  static_cast<void>(server_->WaitForStreams(kLastCalls));
  server_->Shutdown();
}

config::ListenAddress FleetSide::address() const {
  if (server_ == nullptr) return {};
  return {.host = context_.config.listen.fleet.host, .port = server_->port()};
}

}  // namespace uplink::run
