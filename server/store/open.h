#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/config/config.h"
#include "server/log/logger.h"
#include "server/store/oldest_snapshot.h"
#include "server/store/vouched_clock.h"
#include "storage/access_store.h"
#include "storage/change_signal.h"
#include "storage/clock_marks.h"
#include "storage/disk_space.h"
#include "storage/forget_store.h"
#include "storage/leases.h"
#include "storage/reader.h"
#include "storage/shared_items.h"
#include "storage/store.h"
#include "storage/store_facts.h"
#include "storage/topic_leases.h"

namespace uplink::store {

/// The store that the configuration names: a writer per shard, and the query side.
struct Stores {
  /// The judgement of the civil clock, which the writers use, and the mark that it relies on.
  std::unique_ptr<VouchedClock> clock;
  std::unique_ptr<storage::ClockMarks> marks;
  std::unique_ptr<storage::ForgetStore> forget;
  /// What operators decide: for the thread that follows it, and for those who change it.
  std::unique_ptr<storage::AccessStore> access;
  std::unique_ptr<storage::AccessStore> access_writes;
  std::vector<std::unique_ptr<storage::Store>> writers;
  std::unique_ptr<storage::Reader> reader;
  /// Null for a store of one process at a time.
  std::unique_ptr<storage::Leases> leases;
  /// Who reads which topics of a broker; null where no broker is read.
  std::unique_ptr<storage::TopicLeases> topic_leases;
  /// What robots of a fleet share.
  std::unique_ptr<storage::SharedItems> shared;
  /// Null for a store of one process at a time.
  std::unique_ptr<storage::ChangeSignal> change_signal;
  /// The same of what operators decide.
  std::unique_ptr<storage::ChangeSignal> access_signal;
  /// Why the store cannot be reached now; it will be tried again. OK if it can.
  absl::Status away;
  /// As they are now. Any thread, while the writers live.
  std::function<storage::StoreFacts()> facts = [] { return storage::StoreFacts(); };
  /// What its disk has left; empty if that cannot be known. May wait; uses the reader.
  std::function<absl::StatusOr<std::optional<storage::DiskSpace>>()> space = [] {
    return std::optional<storage::DiskSpace>();
  };
  /// Part of the facts once it has asked; uses the reader.
  std::unique_ptr<OldestSnapshot> snapshot = std::make_unique<OldestSnapshot>(nullptr);
};

/// RobotLoader::Context::adopt_grace: a store without leases is this process's alone.
[[nodiscard]] std::optional<milliseconds> AdoptGraceOf(const Stores& stores,
                                                       const config::PresenceConfig& presence);

/// What the store is called in the log: the file's path, or `host:port/database` without user and
/// password.
[[nodiscard]] std::string NameOf(const config::StoreConfig& store);

/// Opens the store. `clock` must outlive it. Logs if a whole SQLite file must be read first.
///
/// Errors: a store that exists and cannot be used as it is; the message says what to do.
[[nodiscard]] absl::StatusOr<Stores> OpenStores(const config::Config& config,
                                                const storage::ProcessId& process,
                                                const Clock& clock, const log::Logger& logger);

}  // namespace uplink::store
