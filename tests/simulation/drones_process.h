#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "metrics/ledger.h"
#include "server/fleet/fleet.h"
#include "server/ingest/allowances.h"
#include "server/journal/journal.h"
#include "server/journal/shards.h"
#include "server/store/lease_rounds.h"
#include "server/store/restore.h"
#include "server/store/robot_loader.h"
#include "server/uncrew/avatar_methods.h"
#include "tests/simulation/drones_backend.h"
#include "tests/simulation/drones_line.h"
#include "tests/simulation/sim_call.h"
#include "tests/simulation/trace.h"
#include "tests/simulation/traced_store.h"

namespace uplink::simulation {

/// uncrew.answer_within of every simulated server.
inline constexpr std::chrono::seconds kAnswerWithin{5};

/// Small, so that bounds are met. A value.
struct DronesLimits {
  journal::JournalLimits journal;
  std::size_t in_flight_max = 1'000;
  robot::PresenceLimits presence;
};

/// One life of a server that drones call, of one or two on one store: the real calls, drones,
/// journal, fleet and leases, and the calls' way in and out moved by hand.
///
/// Thread: confined to its caller.
class DronesProcess final : public loop::WakeInbox {
 public:
  /// The references outlive it.
  struct Ground {
    const Clock& clock;
    DronesBackend& backend;
    DronesBook& book;
    /// Null: nothing is traced.
    Trace* trace = nullptr;
    std::size_t place = 0;
    storage::ProcessId id{};
    /// For people, and in place of where it runs.
    std::string name;
    std::function<bool(std::string_view life)> is_gone;
    std::uint64_t seed = 0;
    DronesLimits limits;
  };
  explicit DronesProcess(const Ground& ground);
  ~DronesProcess() override { calls_.clear(); }
  DronesProcess(const DronesProcess&) = delete;
  DronesProcess& operator=(const DronesProcess&) = delete;

  // --- Calls, by numbers of the world ---

  void Serve(std::uint64_t call, const identity::PeerIdentity& peer, SampleType type,
             std::string_view request);
  /// How it ended; nothing while it is served. An end is told once.
  [[nodiscard]] std::optional<CallEnd> TakeEnd(std::uint64_t call);
  /// The drone's connection is gone, or it cancelled.
  void Break(std::uint64_t call);
  /// Calls that are served now.
  [[nodiscard]] std::size_t serving() const { return calls_.size(); }

  // --- Steps of its threads ---

  [[nodiscard]] bool HasWakes() const { return !woken_.empty(); }
  /// Delivers one of the wakes that wait.
  void DeliverWake(std::size_t which);
  /// One step of the journal's writer; false if it did nothing, or failed.
  bool Write();
  /// What is due now: timers of calls, the rounds of the leases, the sweep.
  void Tick();

  // --- Its end in order ---

  /// Each call is answered within `grace`, and no further one is taken.
  void Drain(milliseconds grace);
  [[nodiscard]] bool draining() const { return draining_; }
  /// The rest, once no call is served.
  void Stop();

  // loop::WakeInbox
  void Wake(std::uint64_t call) override { woken_.insert(call); }

  [[nodiscard]] DronesLine& line() { return line_; }
  [[nodiscard]] const std::string& name() const { return ground_.name; }
  [[nodiscard]] bool idle() const { return journal_.idle() && woken_.empty(); }
  [[nodiscard]] metrics::MessageCounts counts() const {
    return ledgers_.Sum(model::MessageSource::kUncrew).messages;
  }
  /// Null if it was not heard here.
  [[nodiscard]] uncrew::DronePtr Find(const std::string& ruri) const { return drones_.Find(ruri); }
  /// Another process holds the robot, by what this one knows.
  [[nodiscard]] bool HeldElsewhere(const std::string& ruri) const;

 private:
  struct Served {
    std::unique_ptr<SimCall> call;
    std::unique_ptr<transport::CallHandler> handler;
  };

  [[nodiscard]] storage::Store& WayToStore();
  [[nodiscard]] std::unique_ptr<storage::Leases> MakeLeases();
  [[nodiscard]] uncrew::AvatarContext ContextOfCalls();

  const Ground ground_;
  DronesLine line_;
  std::optional<TracedStore> traced_;
  log::Logger logger_;
  metrics::LedgerBook ledgers_;
  journal::JournalProbe journal_probe_;
  store::LeaseProbe lease_probe_;
  const ingest::Allowances allowances_;
  fleet::Fleet fleet_;
  journal::Journal journal_;
  journal::Shards shards_{{&journal_}};
  uncrew::AvatarProbe probe_;
  uncrew::Drones drones_;
  /// Of two threads, which calls of one drone come to.
  std::array<transport::Methods, 2> methods_;
  store::RobotLoader loader_;
  store::Restore restore_;
  store::LeaseRounds leases_;
  std::map<std::uint64_t, Served> calls_;
  std::set<std::uint64_t> woken_;
  bool draining_ = false;
  std::optional<SteadyTime> round_;
  std::optional<SteadyTime> sweep_;
  std::optional<SteadyTime> let_go_;
};

}  // namespace uplink::simulation
