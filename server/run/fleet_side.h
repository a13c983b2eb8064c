#pragma once

#include <atomic>
#include <memory>
#include <string>

#include <absl/status/status.h>

#include "schema/base/clock.h"
#include "server/config/config.h"
#include "server/front/server.h"
#include "server/http/guard.h"
#include "server/http/site.h"
#include "server/log/logger.h"
#include "server/rpc/fleet_methods.h"
#include "server/rpc/probe.h"
#include "server/rpc/unary_call.h"
#include "server/run/early_services.h"
#include "server/run/health_side.h"
#include "server/run/relay_side.h"
#include "server/view/watches.h"

namespace uplink::run {

/// The listener for operators' gRPC. Without listen.fleet it does nothing.
///
/// Order:  Listen; Stop, while the threads that answer still run.
/// Thread: main; Look on the loop's.
class FleetSide final {
 public:
  /// The references outlive it.
  struct Context {
    const log::Logger& logger;
    const config::Config& config;
    EarlyServices& early;
    RelaySide& relay;
    HealthSide& health;
    const http::Site& site;
    view::Watches& watches;
    rpc::RpcProbe& probe;
  };
  explicit FleetSide(const Context& context);

  /// Takes calls from now on. Errors: of the listener, naming its address or file.
  [[nodiscard]] absl::Status Listen();
  /// Reads the PEM files again. A change, and why they do not fit, have a line each.
  void Look();
  /// The deny list changed. Any thread.
  void LookAtDenied() {
    if (front::FrontServer* const server = listening_.load()) server->LookAtDenied();
  }
  /// Lets calls under way end, for a moment, and takes no more. Idempotent.
  void Stop();
  /// Where it listens; without a host if it does not.
  [[nodiscard]] config::ListenAddress address() const;

 private:
  const Context context_;
  rpc::UnaryCalls calls_;
  /// Why the files did not fit at the last look.
  std::string why_;
  std::unique_ptr<front::FrontServer> server_;
  /// The same for other threads, once it listens.
  std::atomic<front::FrontServer*> listening_{nullptr};
};

}  // namespace uplink::run
