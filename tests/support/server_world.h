#pragma once

#include <string>
#include <vector>

#include "metrics/exposition.h"
#include "metrics/ledger.h"
#include "server/admin/commands.h"
#include "server/broker/broker.h"
#include "server/config/effective.h"
#include "server/cyberwave/twins.h"
#include "server/fleet/fleet.h"
#include "server/fleet/live_budget.h"
#include "server/fleet/robot_settings.h"
#include "server/forward/forwarding.h"
#include "server/health/monitor.h"
#include "server/http/probe.h"
#include "server/http/site.h"
#include "server/journal/shards.h"
#include "server/log/logger.h"
#include "server/rcan/scrape.h"
#include "server/rpc/probe.h"
#include "server/session/probe.h"
#include "server/store/access_probe.h"
#include "server/store/lease_probe.h"
#include "server/store/space_judge.h"
#include "server/store/vouched_clock.h"
#include "server/transport/probe.h"
#include "server/uncrew/drones.h"
#include "server/uncrew/probe.h"
#include "server/view/queries.h"
#include "server/view/watch_probe.h"
#include "server/view/watches.h"
#include "tests/support/fake_access_store.h"
#include "tests/support/fake_shared_items.h"
#include "tests/support/fake_store.h"
#include "tests/support/manual_clock.h"
#include "tests/support/switched_reader.h"

namespace uplink::testing {

/// What stands behind the HTTP site, on a fake store and a clock moved by hand.
class ServerWorld {
 public:
  static constexpr std::size_t kRobotsMax = 5;

  explicit ServerWorld(std::size_t robots_max = kRobotsMax);
  ~ServerWorld();

  /// Admits a robot and writes its row.
  robot::Robot& AddRobot(const std::string& ruri, const std::string& fleet = "default");
  /// Commits these for the robot, numbered on from the last.
  void Commit(const std::string& ruri, std::vector<storage::CommitRecord> records,
              std::vector<storage::GapItem> gaps = {});
  void CommitJudged(const std::string& ruri, model::Record record);
  /// A message of a durable kind, judged first.
  void CommitBody(const std::string& ruri, const model::Body& body);
  void CommitFault(const std::string& ruri, const model::Fault& fault) { CommitBody(ruri, fault); }
  void CommitPresence(const std::string& ruri, model::Presence presence,
                      std::optional<model::ConnectionEnd> why = {});
  void CommitConnection(storage::ConnectionItem item);
  void CommitQuarantine(const std::string& ruri, const model::Rejection& rejection,
                        const std::string& payload, storage::OriginRef origin = nullptr);
  /// Of what stands for no robot, of this fleet.
  void CommitScopeUpdate(const model::ScopeUpdate& update, const std::string& of_fleet);
  void CommitGap(const std::string& ruri, model::Seq first, model::Seq last);

  [[nodiscard]] http::Response Get(const std::string& target) const {
    return Get(http::Request{http::Method::kGet, target});
  }
  [[nodiscard]] http::Response Get(const http::Request& request) const;

  /// What /metrics answers.
  [[nodiscard]] std::string ScrapeText() const {
    return metrics::PageText(page_sources, metrics::Format::kText);
  }

  ManualClock clock;
  FakeDatabase database;
  FakeStore store{database, storage::ProcessId{1}};
  SwitchedReader reader{store};
  metrics::LedgerBook ledgers;
  ingest::Allowances allowances;
  journal::JournalLimits journal_limits;
  journal::JournalProbe journal_probe;
  session::SessionProbe sessions;
  http::HttpProbe http_probe;
  rcan::RcanProbe rcan_probe;
  transport::RelayProbe relay_probe;
  rpc::RpcProbe rpc_probe;
  store::VouchedClock vouched_clock{clock};
  store::SpaceView space_view{
      .space = storage::DiskSpace{.free_bytes = 7, .total_bytes = 9, .wal_bytes = 1}};
  store::LeaseProbe lease_probe;
  store::AccessProbe access_probe;
  FakeSharedItems shared_items{database};
  metrics::LatencyDistribution sweep_seconds{metrics::kLatencyBoundsSeconds};
  /// Enough that the text of few robots is more than a socket takes.
  config::RcanConfig rcan_config{.robot_series_max = 2'000};
  log::Logger logger;
  forward::Forwarding forwarding;
  fleet::Fleet fleet;
  journal::Journal journal;
  journal::Shards shards{{&journal}};
  cyberwave::Twins twins{kRobotsMax, fleet.live_total()};
  fleet::LiveBudget live_budget{{clock, fleet, twins, logger, std::size_t{1} << 30U}};
  /// It has no broker.
  broker::Broker broker;
  uncrew::AvatarProbe avatar_probe;
  uncrew::Drones drones{{clock, fleet, shards, ledgers.NewPage(model::MessageSource::kUncrew)}};
  /// Where lists look into the store briefly; empty: on the thread that asks.
  view::BriefLook::Post to_store_thread;
  bool robots_unread = false;
  view::FaultCounts fault_counts{clock};
  fleet::RobotSettings settings{100};
  fleet::TopSenders top{clock, fleet};
  view::Queries queries;
  view::WatchProbe watch_probe;
  view::Watches watches;
  health::Monitor monitor;
  std::vector<metrics::PageSource> page_sources;
  rcan::RobotScrape robots_scrape;
  FakeAccessStore access_store{database};
  admin::SharedStore shared_access{access_store};
  admin::AuditTrail audit{logger};
  admin::Commands commands;
  config::InEffect in_effect{"/etc/uplinkd/uplinkd.toml", {}, {{"log.level", "uplinkd.toml:7"}}};
  http::Site site;

  static model::SessionId session();

 private:
  [[nodiscard]] std::vector<metrics::PageSource> PageSources();
  [[nodiscard]] storage::RobotRef IdOf(const std::string& ruri) const;
  storage::CommitRecord Next(const std::string& ruri);

  model::Seq last_seq_ = 0;
  model::Seq last_presence_ = 0;
};

}  // namespace uplink::testing
