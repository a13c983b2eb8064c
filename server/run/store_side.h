#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "metrics/ledger.h"
#include "schema/base/clock.h"
#include "server/config/config.h"
#include "server/fleet/fleet.h"
#include "server/fleet/forgetting.h"
#include "server/fleet/robot_settings.h"
#include "server/identity/deny_list.h"
#include "server/journal/connection_notes.h"
#include "server/journal/events.h"
#include "server/journal/limits.h"
#include "server/journal/probe.h"
#include "server/journal/shards.h"
#include "server/log/logger.h"
#include "server/loop/one_at_a_time.h"
#include "server/run/periodic.h"
#include "server/store/access_probe.h"
#include "server/store/access_rounds.h"
#include "server/store/clock_rounds.h"
#include "server/store/forget_rounds.h"
#include "server/store/health_log.h"
#include "server/store/lease_probe.h"
#include "server/store/lease_rounds.h"
#include "server/store/marked_clock.h"
#include "server/store/open.h"
#include "server/store/robot_load_rounds.h"
#include "server/store/space_rounds.h"
#include "server/store/writers.h"
#include "storage/identity.h"

namespace uplink::run {

/// The part of the server that works with the store: the journals that write, the robots that it
/// knows, who holds them, what is forgotten, its clock and its disk.
///
/// Thread: main; what says so from any.
class StoreSide final {
 public:
  /// The references outlive it.
  struct Context {
    store::MarkedClock& clock;
    log::Logger& logger;
    const config::Config& config;
    fleet::Fleet& fleet;
    metrics::LedgerBook& ledgers;
    storage::ProcessId process{};
    /// Evenly drawn numbers, for the backoff's jitter; called by one thread at a time.
    std::function<std::uint64_t()> random;
    /// Whether the kernel calls its civil clock synchronised. Any thread.
    std::function<bool()> kernel_clock_synchronised;
    /// A commit held shapes or objects. On a writer's thread: short.
    std::function<void()> spatial_committed;
    /// The server connected to the store anew, and may find that commits are missing. On a writer's
    /// thread: short.
    std::function<void()> reconnected;
    /// A step of the schema shuts this program out. Any thread.
    std::function<void()> shut_out;
    /// A robot moved to another fleet. On a writer's thread: short.
    std::function<void(const journal::Moved&)> moved = [](const journal::Moved& /*moved*/) {};
    /// Who may not come in, and what operators set of robots.
    identity::DenyList& denied;
    fleet::RobotSettings& settings;
    /// The deny list changed. On a thread of this side: short.
    std::function<void()> denied_changed;
    /// As store::AccessRounds::Context has it.
    std::function<std::optional<std::vector<identity::SignedSerial>>()> file_lists;
  };
  StoreSide(const Context& context, store::Stores stores);

  /// Takes over the robots that the store knows; if the store is away, later.
  void ReadRobots();
  /// Commits what comes from now on.
  void StartWriters() { writers_.Start(); }
  /// From now on follows what other servers hold, and forgets robots as operators ask. `port` is
  /// where robots reach this server.
  void StartRounds(std::uint16_t port);
  /// Ends its threads, after the calls of the store that are under way. Idempotent.
  void Stop();
  /// What is due again and again; what may wait goes to `reads`.
  void AddWork(const loop::Post& reads, PeriodicWork& work);

  [[nodiscard]] store::Stores& stores() { return stores_; }
  [[nodiscard]] const journal::Shards& journals() const { return journals_; }
  /// Keeps robots' connections. Any thread.
  [[nodiscard]] robot::ConnectionSink& connections() { return connections_; }
  [[nodiscard]] const journal::JournalLimits& journal_limits() const { return journal_limits_; }
  [[nodiscard]] const journal::JournalProbe& journal_probe() const { return journal_probe_; }
  [[nodiscard]] const store::LeaseProbe& lease_probe() const { return lease_probe_; }
  [[nodiscard]] store::LeaseRounds& leases() { return leases_; }
  [[nodiscard]] const store::SpaceRounds& space() const { return space_rounds_; }
  [[nodiscard]] fleet::Forgetting& forgetting() { return forgetting_; }
  [[nodiscard]] const store::AccessProbe& access_probe() const { return access_probe_; }
  /// An operator decided something here: follows it at once. Any thread.
  void WakeAccess() {
    if (access_) access_->Wake();
  }
  /// Neither the store nor a copy has told who may not come in. Any thread.
  [[nodiscard]] bool access_unread() const { return access_ && access_->unread(); }
  /// The robots that the store knows could not be read yet. Any thread.
  [[nodiscard]] bool robots_unread() const { return !robot_load_rounds_.done(); }

 private:
  [[nodiscard]] store::Writers::Context WritersContext();

  const Context context_;
  const journal::JournalLimits journal_limits_;
  journal::JournalProbe journal_probe_;
  store::LeaseProbe lease_probe_;
  store::Stores stores_;
  store::Writers writers_;
  const journal::Shards& journals_ = writers_.journals();
  journal::ConnectionNotes connections_{journals_};
  fleet::Forgetting forgetting_;
  store::RobotLoadRounds robot_load_rounds_;
  store::LeaseRounds leases_;
  store::ForgetRounds forget_rounds_;
  store::AccessProbe access_probe_;
  std::optional<store::AccessRounds> access_;
  store::ClockRounds clock_rounds_;
  store::SpaceRounds space_rounds_;
  store::HealthLog health_log_;
};

}  // namespace uplink::run
