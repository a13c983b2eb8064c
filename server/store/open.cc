#include "server/store/open.h"

#include <algorithm>
#include <utility>

#include "storage/postgres/link/url.h"
#include "storage/postgres/parts.h"
#include "storage/postgres/reader.h"
#include "storage/postgres/store.h"
#include "storage/sqlite/parts.h"
#include "storage/sqlite/reader.h"
#include "storage/sqlite/store.h"

namespace uplink::store {
namespace {

storage::StoreRules RulesOf(const config::Config& config, const VouchedClock& clock) {
  storage::StoreRules rules;
  rules.clock = &clock;
  rules.object_ttl = config.forward.object_ttl;
  rules.retain_history = config.store.retain_history;
  rules.retain_quarantine = config.store.retain_quarantine;
  rules.retain_connections = config.store.retain_connections;
  rules.retain_audit = config.store.retain_audit;
  return rules;
}

/// Logs before and after a whole file is read, which takes some seconds per GB. Why a file is
/// damaged is logged at the end of the start.
storage::sqlite::OnDamageCheck TellOfCheck(const std::string& path, const log::Logger& logger) {
  return [path, &logger](const storage::sqlite::DamageCheck& check) {
    using Step = storage::sqlite::DamageCheck::Step;
    const char* result = "not sound";
    switch (check.step) {
      case Step::kBegins:
        logger.Warn(
            "store_check_begins",
            {{"store", path}, {"bytes", check.bytes}, {"why", path + ".damaged lies beside it"}});
        return;
      case Step::kSound:
        result = "sound";
        break;
      case Step::kFailed:
        break;
    }
    logger.Warn("store_check_done", {{"store", path}, {"result", result}});
  };
}

/// Keeps an opened part of the stores, unless an earlier one failed.
template <typename Part>
void Keep(absl::StatusOr<std::unique_ptr<Part>> opened, std::unique_ptr<Part>& part,
          absl::Status& status) {
  if (!status.ok()) return;
  status = opened.status();
  if (status.ok()) part = *std::move(opened);
}

/// Reads that run at once: operators' questions, and one of the server's own.
std::size_t ReadsAtOnce(const config::Config& config) { return config.store.readers + 1; }

absl::StatusOr<Stores> OpenSqlite(const config::Config& config, const storage::ProcessId& process,
                                  const Clock& clock, const log::Logger& logger) {
  Stores stores;
  stores.clock = std::make_unique<VouchedClock>(clock);
  const std::string path = config::SqlitePath(config.store);
  storage::sqlite::StoreOptions options;
  options.process = process;
  options.rules = RulesOf(config, *stores.clock);
  options.migrate = config.store.migrate;
  options.on_damage_check = TellOfCheck(path, logger);
  auto store = storage::sqlite::SqliteStore::Open(path, options);
  if (!store.ok()) return store.status();
  const storage::sqlite::DamagePtr damage = (*store)->damage();
  storage::sqlite::ReaderOptions reads;
  reads.damage = damage;
  reads.connections = ReadsAtOnce(config);
  auto reader = storage::sqlite::SqliteReader::Open(path, reads);
  if (!reader.ok()) return reader.status();
  absl::Status status;
  Keep(storage::sqlite::OpenClockMarks(path, damage), stores.marks, status);
  Keep(storage::sqlite::OpenForgetStore(path, damage), stores.forget, status);
  Keep(storage::sqlite::OpenSharedItems(path, damage), stores.shared, status);
  Keep(storage::sqlite::OpenAccessStore(path, damage), stores.access, status);
  Keep(storage::sqlite::OpenAccessStore(path, damage), stores.access_writes, status);
  if (!config.mqtt.url.empty()) {
    Keep(storage::sqlite::OpenTopicLeases(path, process, damage), stores.topic_leases, status);
  }
  if (!status.ok()) return status;
  stores.writers.push_back(*std::move(store));
  stores.snapshot = std::make_unique<OldestSnapshot>(
      [asked = reader->get(), &clock] { return asked->OldestSnapshot(clock.Steady()); });
  stores.facts = [snapshot = stores.snapshot.get()] {
    storage::StoreFacts facts;
    facts.oldest_snapshot = snapshot->age();
    return facts;
  };
  stores.space = [asked = reader->get()] { return asked->Space(); };
  stores.reader = *std::move(reader);
  return stores;
}

/// The clock is the first connection's; counts are those of all; and one unsafe connection is
/// enough, since each may lead to another server after reconnecting.
storage::StoreFacts FactsOf(const std::vector<const storage::postgres::PostgresStore*>& stores) {
  storage::StoreFacts facts = stores.front()->facts();
  facts.commits_in_doubt = 0;
  for (const auto* store : stores) {
    const storage::StoreFacts its = store->facts();
    facts.commits_in_doubt += its.commits_in_doubt;
    facts.unsafe = facts.unsafe || its.unsafe;
  }
  return facts;
}

absl::StatusOr<Stores> OpenPostgres(const config::Config& config, const storage::ProcessId& process,
                                    const Clock& clock) {
  Stores stores;
  stores.clock = std::make_unique<VouchedClock>(clock);
  storage::postgres::StoreOptions options;
  options.url = config.store.url;
  options.password_file = config.store.password_file;
  options.process = process;
  options.rules = RulesOf(config, *stores.clock);
  options.migrate = config.store.migrate;
  options.accept_unsafe = config.store.accept_unsafe;
  options.connect_timeout = config.store.timeout;
  options.call_timeout = config.store.timeout;
  std::vector<const storage::postgres::PostgresStore*> opened;
  for (std::size_t shard = 0; shard < config.store.shards; ++shard) {
    auto store = storage::postgres::PostgresStore::Open(options, clock);
    if (!store.ok()) return store.status();
    // The others would wait for the same server in vain.
    options.connect_now = options.connect_now && (*store)->open_error().ok();
    if (shard == 0) stores.away = (*store)->open_error();
    opened.push_back(store->get());
    stores.writers.push_back(*std::move(store));
  }
  absl::Status status;
  Keep(storage::postgres::MakeLeases(options, clock), stores.leases, status);
  Keep(storage::postgres::MakeClockMarks(options, clock), stores.marks, status);
  Keep(storage::postgres::MakeForgetStore(options, clock), stores.forget, status);
  Keep(storage::postgres::MakeSharedItems(options, clock), stores.shared, status);
  Keep(storage::postgres::MakeAccessStore(storage::postgres::FollowingAccess(options), clock),
       stores.access, status);
  Keep(storage::postgres::MakeAccessStore(options, clock), stores.access_writes, status);
  if (!config.mqtt.url.empty()) {
    Keep(storage::postgres::MakeTopicLeases(options, clock), stores.topic_leases, status);
  }
  Keep(storage::postgres::MakeChangeSignal(options, clock), stores.change_signal, status);
  Keep(storage::postgres::MakeChangeSignal(options, clock, storage::postgres::Channel::kAccess),
       stores.access_signal, status);
  if (!status.ok()) return status;
  storage::postgres::ReaderOptions reading;
  reading.url = config.store.url;
  reading.password_file = config.store.password_file;
  reading.connections = ReadsAtOnce(config);
  reading.connect_timeout = std::min(reading.connect_timeout, config.store.timeout);
  reading.statement_timeout = std::min(reading.statement_timeout, config.store.timeout);
  auto reader = storage::postgres::PostgresReader::Open(reading, clock);
  if (!reader.ok()) return reader.status();
  stores.snapshot =
      std::make_unique<OldestSnapshot>([asked = reader->get()] { return asked->OldestSnapshot(); });
  stores.facts = [opened, snapshot = stores.snapshot.get()] {
    storage::StoreFacts facts = FactsOf(opened);
    facts.oldest_snapshot = snapshot->age();
    return facts;
  };
  stores.space = [asked = reader->get()] { return asked->Space(); };
  stores.reader = *std::move(reader);
  return stores;
}

}  // namespace

std::optional<milliseconds> AdoptGraceOf(const Stores& stores,
                                         const config::PresenceConfig& presence) {
  if (stores.leases != nullptr) return std::nullopt;
  return presence.startup_grace;
}

std::string NameOf(const config::StoreConfig& store) {
  if (!config::IsPostgres(store)) return config::SqlitePath(store);
  const auto url = storage::postgres::ParseUrl(store.url);
  return url.ok() ? url->shown : std::string();
}

absl::StatusOr<Stores> OpenStores(const config::Config& config, const storage::ProcessId& process,
                                  const Clock& clock, const log::Logger& logger) {
  return config::IsPostgres(config.store) ? OpenPostgres(config, process, clock)
                                          : OpenSqlite(config, process, clock, logger);
}

}  // namespace uplink::store
