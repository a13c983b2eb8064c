#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include <absl/status/status.h>

#include "metrics/ledger.h"
#include "schema/base/clock.h"
#include "server/config/config.h"
#include "server/fleet/fleet.h"
#include "server/forward/forwarding.h"
#include "server/front/call/relay_context.h"
#include "server/front/server.h"
#include "server/identity/deny_list.h"
#include "server/ingest/allowances.h"
#include "server/journal/shards.h"
#include "server/log/logger.h"
#include "server/loop/handshake_probe.h"
#include "server/loop/one_at_a_time.h"
#include "server/robot/connection_reports.h"
#include "server/run/drain.h"
#include "server/session/limits.h"
#include "server/session/probe.h"
#include "server/store/open.h"
#include "server/store/reject_reads.h"
#include "server/transport/methods.h"
#include "server/transport/probe.h"

namespace uplink::run {

/// The part of the server to which robots connect: the relay's listener, and what it sends them of
/// each other.
///
/// Thread: main; what says so from any.
class RelaySide final {
 public:
  /// The references outlive it.
  struct Context {
    const Clock& clock;
    const log::Logger& logger;
    const config::Config& config;
    fleet::Fleet& fleet;
    const journal::Shards& journals;
    metrics::LedgerBook& ledgers;
    const ingest::Allowances& allowances;
    store::Stores& stores;
    const std::string& version;
    /// Posts a job to the thread that may wait for the store, ahead of others.
    loop::Post reads_ahead;
    /// For the numbers of forwarded commands.
    std::uint64_t seed = 0;
    robot::ConnectionReports& reports;
    const identity::DenyList& denied;
    /// What is served beside the relay, for robots.
    transport::MethodsMaker others = {};
  };
  explicit RelaySide(const Context& context);

  /// Admits robots from now on. Errors: of the listener, naming its address or file.
  [[nodiscard]] absl::Status Listen();
  void StartForwarding() { forwarding_.Start(); }
  void StopForwarding() { forwarding_.Stop(); }
  /// Ends the streams that are left. Idempotent.
  void Shutdown() {
    if (server_ != nullptr) server_->Shutdown();
  }
  /// A commit held shapes or objects. Any thread.
  void OnSpatialCommitted() { forwarding_.Wake(); }

  /// The deny list changed. Any thread.
  void LookAtDenied() {
    if (front::FrontServer* const server = listening_.load()) server->LookAtDenied();
  }
  /// For another listener, which serves no relay and counts for itself.
  [[nodiscard]] front::RelayContext FrontContext(transport::RelayProbe& probe);

  // --- After Listen ---

  [[nodiscard]] front::FrontServer& server() { return *server_; }
  [[nodiscard]] Drain::Transport DrainTransport();
  /// Where the listener was really bound, for handshakes of our own.
  [[nodiscard]] loop::ProbeTarget Target();

  [[nodiscard]] const session::SessionLimits& session_limits() const { return session_limits_; }
  [[nodiscard]] const session::SessionProbe& session_probe() const { return session_probe_; }
  [[nodiscard]] const transport::RelayProbe& probe() const { return probe_; }
  [[nodiscard]] const forward::Forwarding& forwarding() const { return forwarding_; }

 private:
  const Context context_;
  const session::SessionLimits session_limits_;
  session::SessionProbe session_probe_;
  transport::RelayProbe probe_;
  forward::Forwarding forwarding_;
  store::RejectReads rejects_;
  std::unique_ptr<front::FrontServer> server_;
  /// The same for other threads, once it listens.
  std::atomic<front::FrontServer*> listening_{nullptr};
};

}  // namespace uplink::run
