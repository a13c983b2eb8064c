#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "metrics/exposition.h"
#include "metrics/ledger.h"
#include "schema/base/clock.h"
#include "server/admin/commands.h"
#include "server/config/config.h"
#include "server/config/effective.h"
#include "server/fleet/fleet.h"
#include "server/fleet/robot_settings.h"
#include "server/http/site.h"
#include "server/log/logger.h"
#include "server/loop/rounds.h"
#include "server/rcan/scrape.h"
#include "server/rpc/probe.h"
#include "server/run/broker_side.h"
#include "server/run/early_services.h"
#include "server/run/health_side.h"
#include "server/run/periodic.h"
#include "server/run/relay_side.h"
#include "server/run/store_side.h"
#include "server/run/uncrew_side.h"
#include "server/view/queries.h"
#include "server/view/watch_probe.h"
#include "server/view/watches.h"

namespace uplink::run {

/// The part of the server that operators see: the API, probes and pages of metrics.
///
/// Thread: main; the site's answers on the threads of EarlyServices.
class ViewSide final {
 public:
  /// The references outlive it.
  struct Context {
    const Clock& clock;
    log::Logger& logger;
    const config::Config& config;
    const std::string& version;
    fleet::Fleet& fleet;
    const metrics::LedgerBook& ledgers;
    EarlyServices& early;
    StoreSide& store;
    const UncrewSide& uncrew;
    RelaySide& relay;
    BrokerSide& broker;
    HealthSide& health;
    admin::Commands& commands;
    const fleet::RobotSettings& settings;
    /// Evenly drawn numbers.
    const std::function<std::uint64_t()>& random;
    const config::InEffect& in_effect;
    const rpc::RpcProbe& rpc_probe;
  };
  explicit ViewSide(const Context& context);

  ViewSide(const ViewSide&) = delete;
  ViewSide& operator=(const ViewSide&) = delete;

  [[nodiscard]] const http::Site& site() const { return site_; }
  [[nodiscard]] view::Watches& watches() { return watches_; }
  /// Watches are swept from now on.
  void BeginWatches() { sweeps_.Start(); }
  /// From the next sweep on. Any thread.
  void Follow(const config::ViewConfig& view) { watch_interval_.store(view.watch_interval); }
  /// All watches end. Before the threads of EarlyServices end.
  void EndWatches();
  /// Series of robots are left out of a scrape. Any thread.
  [[nodiscard]] bool series_left_out() const { return robots_scrape_.full(); }
  /// What is due again and again.
  void AddWork(PeriodicWork& work);

 private:
  loop::Next Sweep();

  const Context context_;
  view::FaultCounts fault_counts_;
  fleet::TopSenders top_;
  view::Queries queries_;
  /// view.watch_interval.
  std::atomic<milliseconds> watch_interval_;
  view::WatchProbe watch_probe_;
  view::Watches watches_;
  const std::vector<metrics::PageSource> page_sources_;
  rcan::RobotScrape robots_scrape_;
  http::Site site_;
  loop::Rounds sweeps_;
};

}  // namespace uplink::run
