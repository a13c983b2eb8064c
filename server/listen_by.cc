#include "server/listen_by.h"

#include "server/front/server.h"
#include "server/health/process.h"
#include "server/lifecycle/from_config.h"
#include "server/relay/server.h"

namespace uplink {

absl::StatusOr<std::unique_ptr<transport::Listener>> ListenBy(
    const config::Config& config, const transport::RelayContext& context) {
  const transport::RelayOptions options = lifecycle::RelayOptionsOf(config, health::MemoryMax());
  switch (config.listen.transport) {
    case config::Transport::kNative:
      return front::FrontServer::Start(options, context);
    case config::Transport::kGrpc:
      return relay::RelayServer::Start(options, context);
  }
  return absl::InternalError("no such transport");
}

}  // namespace uplink
