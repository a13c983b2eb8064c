#include "tests/support/server_world.h"

#include <utility>

#include "schema/base/check.h"
#include "server/broker/samples.h"
#include "server/fleet/samples.h"
#include "server/health/samples.h"
#include "server/http/samples.h"
#include "server/journal/samples.h"
#include "server/log/samples.h"
#include "server/rcan/samples.h"
#include "server/session/samples.h"
#include "server/store/samples.h"
#include "server/uncrew/samples.h"
#include "server/view/samples.h"
#include "tests/support/kept_lines.h"
#include "tests/support/records.h"

namespace uplink::testing {
ServerWorld::ServerWorld(std::size_t robots_max)
    : logger(std::make_unique<NoLines>(), clock, log::Format::kText, log::Level::kError),
      forwarding({clock, logger, shared_items, vouched_clock, 1}),
      fleet(clock, robots_max, robot::PresenceLimits{}),
      journal(store, journal_limits, clock, ledgers.NewPage(), journal_probe,
              storage::ProcessId{1}),
      broker({.clock = clock,
              .logger = logger,
              .fleet = fleet,
              .journals = shards,
              .ledger = ledgers.NewPage(model::MessageSource::kCyberwave),
              .twins = twins,
              .clients = std::vector<mqtt::ClientSettings>(2),
              .terms = {},
              .journal_over_half = [] { return false; },
              .random = [] { return 0U; },
              .allowances = allowances}),
      queries({.clock = clock,
               .fleet = fleet,
               .reader = reader,
               .journals = shards,
               .ledgers = ledgers,
               .streams = sessions.streams,
               .version = "9.9.9",
               .to_store_thread =
                   [this](auto job) {
                     if (to_store_thread) return to_store_thread(std::move(job));
                     job();
                     return true;
                   },
               .robots_unread = [this] { return robots_unread; },
               .faults = &fault_counts,
               .top = &top,
               .settings = &settings}),
      watches({clock, fleet, queries, watch_probe, logger}),
      monitor({clock, fleet, shards, journal_probe, sessions, journal_limits,
               clock.System() + std::chrono::hours(24 * 365)}),
      page_sources(PageSources()),
      robots_scrape({clock, fleet, rcan_config, fault_counts, rcan_probe, logger}),
      commands({.clock = clock,
                .store = shared_access,
                .audit = audit,
                .rows_of_audit =
                    [this](const storage::AuditQuery& query) { return reader.Audit(query); },
                .fleet_of = [this](std::string_view ruri) -> std::optional<std::string> {
                  const fleet::RobotPtr robot = fleet.Find(ruri);
                  if (robot == nullptr) return std::nullopt;
                  return robot->id()->fleet;
                }}),
      site({queries, watches, commands, monitor, http_probe,
            [this](metrics::Format format) { return metrics::PageText(page_sources, format); },
            robots_scrape, logger, in_effect}) {}

ServerWorld::~ServerWorld() = default;

std::vector<metrics::PageSource> ServerWorld::PageSources() {
  static constexpr http::ConnectionsMax kConnectionsMax{4, 2};
  return {
      [this](auto& page) { page.AddLedger(ledgers.Sum(model::MessageSource::kUplink)); },
      [this](auto& page) { page.AddAges(ledgers); },
      [this](auto& page) { session::AddSamples(sessions, page); },
      [this](auto& page) { fleet::AddSamples(fleet, page); },
      [this](auto& page) { fleet::AddSamples(live_budget, page); },
      [this](auto& page) { health::AddSweepSamples(sweep_seconds, page); },
      [this](auto& page) { journal::AddSamples(shards, journal_limits, clock.Steady(), page); },
      [this](auto& page) { journal::AddSamples(journal_probe, page); },
      [](auto& page) { store::AddSamples(storage::StoreFacts(), page); },
      [this](auto& page) { store::AddSamples(space_view, page); },
      [this](auto& page) { store::AddSamples(vouched_clock, page); },
      [this](auto& page) { store::AddSamples(lease_probe, page); },
      [this](auto& page) { store::AddSamples(access_probe, page); },
      [this](auto& page) { forwarding.AddSamples(page); },
      [this](auto& page) { broker::AddSamples(broker, page); },
      [this](auto& page) { uncrew::AddSamples(drones, avatar_probe, clock.Steady(), page); },
      [this](auto& page) { view::AddSamples(watch_probe, page); },
      [this](auto& page) { http::AddSamples(http_probe, kConnectionsMax, page); },
      [this](auto& page) { rcan::AddSamples(rcan_probe, rcan_config.series_max, page); },
      [this](auto& page) { health::AddSamples(monitor, page); },
      [this](auto& page) { log::AddSamples(logger, page); },
      [start = health::ProcessStart{"9.9.9", clock.System()}](auto& page) {
        health::AddProcessSamples(start, page);
      },
      [this](auto& page) { session::AddSamples(relay_probe, rpc_probe.listener, sessions, page); },
      [this](auto& page) { rpc::AddSamples(rpc_probe, page); },
  };
}

robot::Robot& ServerWorld::AddRobot(const std::string& ruri, const std::string& fleet_name) {
  const absl::StatusOr<fleet::RobotPtr> robot = fleet.FindOrAdmit({ruri, fleet_name});
  UPLINK_CHECK(robot.ok(), "the test's robots fit the fleet");
  return **robot;
}

model::SessionId ServerWorld::session() {
  return *model::SessionId::FromHex("000102030405060708090a0b0c0d0e0f");
}

storage::RobotRef ServerWorld::IdOf(const std::string& ruri) const {
  if (storage::IsNoRobot(ruri)) {
    return std::make_shared<const model::RobotId>(model::RobotId{ruri, "default"});
  }
  const fleet::RobotPtr robot = fleet.Find(ruri);
  UPLINK_CHECK(robot != nullptr, "AddRobot comes first");
  return robot->id();
}

storage::CommitRecord ServerWorld::Next(const std::string& ruri) {
  const storage::OpenRequest open{.robot = IdOf(ruri), .session = session(), .at = clock.System()};
  const auto opened = store.OpenStreams(std::span(&open, 1));
  UPLINK_CHECK(opened.ok(), "the fake store opens");
  storage::CommitRecord record{.robot = open.robot,
                               .session = session(),
                               .seq = ++last_seq_,
                               .held_since = opened->front().held_since,
                               .received_at = clock.System(),
                               .content = storage::QuarantineItem{}};
  return record;
}

void ServerWorld::Commit(const std::string& ruri, std::vector<storage::CommitRecord> records,
                         std::vector<storage::GapItem> gaps) {
  storage::Batch batch;
  batch.records = std::move(records);
  batch.gaps = std::move(gaps);
  const auto outcomes = store.Commit(batch);
  UPLINK_CHECK(outcomes.ok(), ruri);
}

void ServerWorld::CommitJudged(const std::string& ruri, model::Record judged) {
  storage::CommitRecord record = Next(ruri);
  record.content = std::move(judged);
  std::vector<storage::CommitRecord> records;
  records.push_back(std::move(record));
  Commit(ruri, std::move(records));
}

void ServerWorld::CommitBody(const std::string& ruri, const model::Body& body) {
  CommitJudged(ruri, uplink::test::RecordOf(body));
}

void ServerWorld::CommitPresence(const std::string& ruri, model::Presence presence,
                                 std::optional<model::ConnectionEnd> why) {
  // A batch makes no robot.
  if (database.EpochOf(ruri) == 0) static_cast<void>(Next(ruri));
  storage::Batch batch;
  batch.presence_session = session();
  batch.presence.push_back({.robot = fleet.Find(ruri)->id(),
                            .presence = presence,
                            .at = clock.System(),
                            .number = ++last_presence_,
                            .held_since = database.HeldSinceOf(ruri),
                            .why = why});
  UPLINK_CHECK(store.Commit(batch).ok(), ruri);
}

void ServerWorld::CommitConnection(storage::ConnectionItem item) {
  const std::string ruri = item.robot->ruri;
  if (database.EpochOf(ruri) == 0) static_cast<void>(Next(ruri));
  storage::Batch batch;
  batch.connections.push_back(std::move(item));
  UPLINK_CHECK(store.Commit(batch).ok(), ruri);
}

void ServerWorld::CommitQuarantine(const std::string& ruri, const model::Rejection& rejection,
                                   const std::string& payload, storage::OriginRef origin) {
  storage::CommitRecord record = Next(ruri);
  record.content = storage::QuarantineItem{rejection};
  record.origin = std::move(origin);
  record.payload = payload;
  record.payload_bytes = payload.size();
  std::vector<storage::CommitRecord> records;
  records.push_back(std::move(record));
  Commit(ruri, std::move(records));
}

void ServerWorld::CommitScopeUpdate(const model::ScopeUpdate& update, const std::string& of_fleet) {
  storage::CommitRecord record = Next(storage::NoRobotOf(""));
  const std::string ruri = record.robot->ruri;
  record.robot = std::make_shared<const model::RobotId>(model::RobotId{ruri, of_fleet});
  record.content = update;
  std::vector<storage::CommitRecord> records;
  records.push_back(std::move(record));
  Commit(ruri, std::move(records));
}

void ServerWorld::CommitGap(const std::string& ruri, model::Seq first, model::Seq last) {
  const storage::CommitRecord like = Next(ruri);
  Commit(ruri, {},
         {{.robot = like.robot,
           .session = session(),
           .first = first,
           .last = last,
           .held_since = like.held_since,
           .seen_at = clock.System()}});
}

http::Response ServerWorld::Get(const http::Request& request) const {
  return site.Resolve(request).run();
}

}  // namespace uplink::testing
