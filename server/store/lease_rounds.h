#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <unordered_set>

#include <absl/status/status.h>

#include "schema/base/clock.h"
#include "server/config/config.h"
#include "server/fleet/fleet.h"
#include "server/journal/shards.h"
#include "server/log/logger.h"
#include "server/loop/rounds.h"
#include "server/store/lease_judge.h"
#include "server/store/lease_probe.h"
#include "server/store/process_life.h"
#include "storage/leases.h"

namespace uplink::store {

/// A robot that another process held has no row any more once it was in no list for so many looks,
/// unless the store gave it to us.
inline constexpr int kUnlistedLooksMax = 4;

/// Processes whose verdicts are kept for VerdictOf.
inline constexpr std::size_t kVerdictsMax = 64;

/// Keeps this process's lease, and follows other processes: shows their robots as they wrote them,
/// lets go of robots that moved to them, and adopts the robots of processes that are over.
///
/// Errors:  of the store: the next round tries again, and no process counts as over because of it.
/// Thread:  constructed, started and stopped by main; Round by main before Start, then by a thread
///          of its own; SetPort and StopAdopting from any.
class LeaseRounds final {
 public:
  /// The references outlive it.
  struct Context {
    fleet::Fleet& fleet;
    const journal::Shards& journals;
    const Clock& clock;
    log::Logger& logger;
    LeaseProbe& probe;
    /// This process.
    storage::ProcessId process{};
    config::PresenceConfig presence;
    /// Whether the process with this life has ended.
    std::function<bool(std::string_view life)> is_gone = IsGone;
    /// Whether a robot that was last heard then must not be in memory.
    std::function<bool(SystemTime heard_at)> is_forgotten = [](SystemTime) { return false; };
    /// The store's schema shuts this program out for good: the process must end. Called once.
    std::function<void()> on_shut_out = [] {};
  };
  /// `leases` is null if this process has the store alone: then nothing is done.
  LeaseRounds(std::unique_ptr<storage::Leases> leases, Context context);
  LeaseRounds(const LeaseRounds&) = delete;
  LeaseRounds& operator=(const LeaseRounds&) = delete;

  /// The port of this machine at which robots reach this process.
  void SetPort(std::uint16_t port);
  /// One look: renews the lease if that is due, reads the others, and acts on them.
  void Round();
  /// Rounds each kLookEvery, on a thread of its own.
  void Start();
  /// Ends the rounds. Idempotent.
  void Stop() { rounds_.Stop(); }
  enum class Left : std::uint8_t {
    /// Another process lives, and adopts the robots.
    kToOthers,
    kToNone,
  };
  /// Ends the rounds and releases this process's lease, and so its robots. If several processes
  /// leave at the same time, the last one finds no other. A failure is logged; the others then wait
  /// until the lease is silent. Thread: main.
  Left Leave();
  /// Whether a process that holds something is over, as of the last look. Empty before the first
  /// look after it was asked for, which comes at once. Thread: any.
  [[nodiscard]] std::optional<LeaseJudge::Verdict> VerdictOf(const storage::ProcessId& process);
  /// Whether other processes may hear robots without our knowledge: by the last look, or because
  /// looks fail or take too long (kLookGapMax). Ends after config::PresenceConfig::adopted_grace.
  /// Thread: any.
  [[nodiscard]] bool OthersUnseen() const;
  /// This process stops: it renews its lease until Stop, and adopts no more robots.
  void StopAdopting() { adopts_.store(false); }

 private:
  /// A holder that is over, and how many of its robots this round saw.
  struct Ended {
    LeaseJudge::Verdict holder;
    std::size_t robots = 0;
  };
  /// The result of one reading of the others' robots.
  struct Listed {
    /// Robots that this process shows.
    std::unordered_set<const robot::Robot*> robots;
    std::map<storage::ProcessId, Ended> ended;
  };

  absl::Status Look();
  /// Tells the fleet if the leases are another server's than at the last look.
  void FollowServer();
  absl::Status LookAtLeases();
  absl::Status FollowRobots();
  /// Null if it must not be shown.
  [[nodiscard]] fleet::RobotPtr FindOrAdmit(const storage::ForeignRobot& foreign);
  void Follow(const storage::ForeignRobot& foreign, Listed& listed);
  /// The robot's holder is over: this process takes the robot.
  void Adopt(robot::Robot& robot, const storage::ForeignRobot& foreign,
             const LeaseJudge::Verdict& holder);
  /// Handles robots that were another's at the last look and are in no list now. Either the store
  /// says that they are ours, by an answer that never came, or they have no row any more and leave
  /// memory.
  void TakeUnlisted(const Listed& listed);
  void LogEnded(const Listed& listed);
  void NoteOutcome(const absl::Status& status);
  void NoteVerdicts();
  void NoteLate();

  const std::unique_ptr<storage::Leases> leases_;
  const Context context_;
  LeaseJudge judge_;
  std::optional<SteadyTime> renewed_;
  /// When the leases were last read; before that, when this was made.
  std::atomic<SteadyTime> looked_;
  /// storage::Leases::ServerRun of the last look.
  std::string server_run_;
  /// Processes that were over and had robots in the last round; each is logged once.
  std::set<storage::ProcessId> over_;
  /// Processes that were late in the last round; each is logged once.
  std::map<storage::ProcessId, std::string> late_;
  /// In how many successive looks a robot was in no list; by RURI.
  std::map<std::string, int> unlisted_;
  bool failing_ = false;
  bool shut_out_ = false;
  std::atomic<std::uint16_t> port_{0};
  std::atomic<bool> adopts_{true};
  std::atomic<bool> renews_now_{false};
  std::mutex mutex_;
  /// Processes that were asked for, at most kVerdictsMax; under the mutex.
  std::map<storage::ProcessId, std::optional<LeaseJudge::Verdict>> verdicts_;
  loop::Rounds rounds_;
};

}  // namespace uplink::store
