#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "server/fleet/checkpoint.h"
#include "server/fleet/fleet.h"
#include "server/fleet/presence_watch.h"
#include "server/journal/journal.h"
#include "server/journal/shards.h"
#include "server/store/lease_rounds.h"
#include "server/store/restore.h"
#include "server/store/robot_loader.h"
#include "tests/simulation/holders_store.h"

namespace uplink::simulation {

/// More robots than a world has.
inline constexpr std::size_t kHoldersRobotsMax = 100;
/// Longer than any process is cut off from the store, so that no robot is offline for that.
inline constexpr std::chrono::minutes kHoldersAdoptedGrace{15};

/// One life of a server process, of several on one store: the real fleet, journal, leases, seed,
/// restoring and sweep; what a stream does of that when it opens, hears and ends; and the end of a
/// drain. Each public call is a step of its threads, in any order.
///
/// Thread: confined to its caller.
class HoldersProcess final : public loop::WakeInbox {
 public:
  /// The references outlive it.
  struct Ground {
    const Clock& clock;
    const BootClock& boot;
    testing::FakeDatabase& database;
    HoldersTruth& truth;
    Random& random;
    HoldersFault fault = HoldersFault::kNone;
    storage::ProcessId id{};
    /// For people, and where it runs.
    std::string name;
    std::function<bool(std::string_view life)> is_gone;
    /// Whether the peer of this stream of the robot answers a ping.
    std::function<bool(const std::string& ruri, std::uint64_t stream)> peer_answers;
  };
  explicit HoldersProcess(const Ground& ground);

  void Wake(std::uint64_t stream) override { woken_.insert(stream); }

  /// Reads the robots that the store knows; `away` if that cannot be reached.
  void Start();

  // --- Steps of its threads ---

  /// What is due now of the leases' rounds, the sweep, the reads and the handshake, in a random
  /// order, with as many steps of the journal as `writes` at some place among them. The relay is
  /// unread while not `hears`.
  void Step(std::size_t writes, bool hears);

  // --- Streams ---

  /// A stream of the robot came; its number.
  std::uint64_t Open(const storage::RobotRef& robot);
  /// The stream must not be read any more.
  [[nodiscard]] bool Superseded(const std::string& ruri, std::uint64_t stream);
  void Close(const std::string& ruri, std::uint64_t stream);
  /// The robot's stream brought a sign of life.
  void Hear(const std::string& ruri);
  /// The same of a stream that has ended meanwhile.
  void HearLate(const std::string& ruri);
  /// The robot's stream brought a Goodbye.
  void Park(const std::string& ruri, SystemTime until);

  // --- The end ---

  /// The rest of a drain, once every stream has ended.
  void Stop();

  // --- The way to the store ---

  [[nodiscard]] HoldersStore& store() { return store_; }

  [[nodiscard]] const storage::ProcessId& id() const { return ground_.id; }
  [[nodiscard]] const std::string& name() const { return ground_.name; }
  [[nodiscard]] fleet::Fleet& fleet() { return fleet_; }
  /// No sweep judges any more.
  bool draining = false;

 private:
  [[nodiscard]] HoldersStore::Context ContextOfStore();
  [[nodiscard]] store::LeaseRounds::Context ContextOfLeases();
  void Round();
  void Sweep();
  void Read();
  void Write(std::size_t steps);
  void AskRelay(bool hears);
  /// What streams do that were woken, and what their peers answer.
  void AskPeers();

  const Ground ground_;
  std::uint64_t next_stream_ = 1;
  std::map<std::string, std::uint64_t> streams_;
  std::set<std::uint64_t> woken_;
  /// Robots whose peers were asked and have not answered.
  std::set<std::string> asked_peers_;
  HoldersStore store_;
  metrics::Ledger ledger_;
  journal::JournalProbe journal_probe_;
  metrics::Cell streams_total_;
  store::LeaseProbe lease_probe_;
  metrics::LatencyDistribution sweep_seconds_{metrics::kLatencyBoundsSeconds};
  log::Logger logger_;
  fleet::Fleet fleet_;
  journal::Journal journal_;
  journal::Shards shards_{{&journal_}};
  store::RobotLoader loader_;
  store::Restore restore_;
  fleet::Checkpoint checkpoint_;
  store::LeaseRounds leases_;
  fleet::Liveness liveness_;
  fleet::PresenceWatch watch_;
  std::optional<SteadyTime> round_;
  std::optional<SteadyTime> sweep_;
  std::optional<SteadyTime> asked_;
  std::function<void(bool)> answer_;
};

}  // namespace uplink::simulation
