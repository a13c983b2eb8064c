#pragma once

#include <functional>

#include "metrics/cells.h"
#include "schema/base/clock.h"
#include "server/config/config.h"
#include "server/fleet/fleet.h"
#include "server/fleet/live_budget.h"
#include "server/fleet/presence_watch.h"
#include "server/health/certificate_watch.h"
#include "server/health/monitor.h"
#include "server/log/logger.h"
#include "server/loop/event_loop.h"
#include "server/run/broker_side.h"
#include "server/run/periodic.h"
#include "server/run/relay_side.h"
#include "server/run/store_side.h"
#include "server/run/supervisor.h"

namespace uplink::run {

/// The part of the server that judges: which robots are there, whether the server is ready and
/// well, and whether live state has room.
///
/// Thread: main; the work on the loop's.
class HealthSide final {
 public:
  /// The references outlive it.
  struct Context {
    const Clock& clock;
    log::Logger& logger;
    const config::Config& config;
    fleet::Fleet& fleet;
    StoreSide& store;
    RelaySide& relay;
    BrokerSide& broker;
    loop::EventLoop& loop;
    /// When the served certificate expires, as of the start.
    SystemTime certificate_expiry;
    /// Series of robots are left out of a scrape.
    std::function<bool()> series_left_out;
    std::function<health::HttpFacts()> http;
  };
  explicit HealthSide(const Context& context);

  /// Robots are heard from now on.
  void BeginListening();
  /// What is due again and again.
  void AddWork(PeriodicWork& work);

  [[nodiscard]] health::Monitor& monitor() { return monitor_; }
  [[nodiscard]] const fleet::LiveBudget& live_budget() const { return live_budget_; }
  [[nodiscard]] const metrics::LatencyDistribution& sweep_seconds() const { return sweep_seconds_; }

 private:
  const Context context_;
  metrics::LatencyDistribution sweep_seconds_{metrics::kLatencyBoundsSeconds};
  fleet::LiveBudget live_budget_;
  health::Monitor monitor_;
  health::CertificateWatch certificate_watch_;
  fleet::PresenceWatch presence_watch_;
  const Watchdog watchdog_;
};

}  // namespace uplink::run
