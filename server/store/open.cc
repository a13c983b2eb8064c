#include "server/store/open.h"

#include <algorithm>
#include <utility>

#include "storage/postgres/change_signal.h"
#include "storage/postgres/clock_marks.h"
#include "storage/postgres/forget_store.h"
#include "storage/postgres/leases.h"
#include "storage/postgres/link/url.h"
#include "storage/postgres/reader.h"
#include "storage/postgres/shared_items.h"
#include "storage/postgres/store.h"
#include "storage/postgres/topic_leases.h"
#include "storage/sqlite/clock_marks.h"
#include "storage/sqlite/forget_store.h"
#include "storage/sqlite/reader.h"
#include "storage/sqlite/shared_items.h"
#include "storage/sqlite/store.h"
#include "storage/sqlite/topic_leases.h"

namespace uplink::store {
namespace {

storage::StoreRules RulesOf(const config::Config& config, const VouchedClock& clock) {
  storage::StoreRules rules;
  rules.clock = &clock;
  rules.object_ttl = config.forward.object_ttl;
  rules.retain_history = config.store.retain_history;
  rules.retain_quarantine = config.store.retain_quarantine;
  return rules;
}

/// Tells the log before and after a whole file is read, which takes some seconds per GB. Why one
/// is not sound is told with the end of the start.
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
  auto reader = storage::sqlite::SqliteReader::Open(path, reads);
  if (!reader.ok()) return reader.status();
  auto marks = storage::sqlite::SqliteClockMarks::Open(path, damage);
  if (!marks.ok()) return marks.status();
  stores.marks = *std::move(marks);
  auto forget = storage::sqlite::SqliteForgetStore::Open(path, damage);
  if (!forget.ok()) return forget.status();
  stores.forget = *std::move(forget);
  auto shared = storage::sqlite::SqliteSharedItems::Open(path, damage);
  if (!shared.ok()) return shared.status();
  stores.shared = *std::move(shared);
  if (!config.mqtt.url.empty()) {
    auto topics = storage::sqlite::SqliteTopicLeases::Open(path, process, damage);
    if (!topics.ok()) return topics.status();
    stores.topic_leases = *std::move(topics);
  }
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

/// The clock of the first connection; what is counted is counted of all, and one that is unsafe is
/// enough: each may lead to another server since it was made anew.
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
  auto leases = storage::postgres::PostgresLeases::Make(options, clock);
  if (!leases.ok()) return leases.status();
  stores.leases = *std::move(leases);
  auto marks = storage::postgres::PostgresClockMarks::Make(options, clock);
  if (!marks.ok()) return marks.status();
  stores.marks = *std::move(marks);
  auto forget = storage::postgres::PostgresForgetStore::Make(options, clock);
  if (!forget.ok()) return forget.status();
  stores.forget = *std::move(forget);
  auto shared = storage::postgres::PostgresSharedItems::Make(options, clock);
  if (!shared.ok()) return shared.status();
  stores.shared = *std::move(shared);
  if (!config.mqtt.url.empty()) {
    auto topics = storage::postgres::PostgresTopicLeases::Make(options, clock);
    if (!topics.ok()) return topics.status();
    stores.topic_leases = *std::move(topics);
  }
  auto change_signal = storage::postgres::PostgresChangeSignal::Make(options, clock);
  if (!change_signal.ok()) return change_signal.status();
  stores.change_signal = *std::move(change_signal);
  storage::postgres::ReaderOptions reading;
  reading.url = config.store.url;
  reading.password_file = config.store.password_file;
  reading.connections = config.store.readers;
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
