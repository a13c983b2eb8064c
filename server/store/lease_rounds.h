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

/// A robot that another process held, that is in nobody's list, and that the store did not give to
/// us in so many looks has no row any more.
inline constexpr int kUnlistedLooksMax = 4;

/// Processes whose verdicts are kept for others to ask.
inline constexpr std::size_t kVerdictsMax = 64;

/// Keeps this process's lease, and follows what other processes hold: shows their robots as they
/// wrote them, lets go of robots that went to them, and adopts the robots of those that are over.
///
/// Errors:  of the store: the next round tries again, and no other process is called over for it.
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
    /// Whether the process that had a life is not there any more.
    std::function<bool(std::string_view life)> is_gone = IsGone;
    /// Whether a robot that was heard last then is to be in memory no more.
    std::function<bool(SystemTime heard_at)> is_forgotten = [](SystemTime) { return false; };
    /// The store's schema shuts this program out for good: the process has to end. Called once.
    std::function<void()> on_shut_out = [] {};
  };
  /// `leases` is null for a store that this process has alone: then there is nothing to do.
  LeaseRounds(std::unique_ptr<storage::Leases> leases, Context context);
  LeaseRounds(const LeaseRounds&) = delete;
  LeaseRounds& operator=(const LeaseRounds&) = delete;

  /// At which port of this machine robots reach this process.
  void SetPort(std::uint16_t port);
  /// One look: renews the lease where that is due, reads the others, and acts on what they show.
  void Round();
  /// Rounds each kLookEvery, on a thread of its own.
  void Start();
  /// Ends the rounds. Idempotent.
  void Stop() { rounds_.Stop(); }
  enum class Left : std::uint8_t {
    /// Another process is not over: it adopts the robots.
    kToOthers,
    kToNobody,
  };
  /// Ends the rounds and gives this process's robots up. Of processes that leave at the same time,
  /// the last one finds nobody. A failure is logged: the others wait for the lease to fall silent
  /// then. Thread: main.
  Left Leave();
  /// Whether a process that holds something is over, as of the last look. Nothing before the first
  /// look after it was asked for, which comes at once. Thread: any.
  [[nodiscard]] std::optional<LeaseJudge::Verdict> VerdictOf(const storage::ProcessId& process);
  /// Other processes may hear robots and cannot tell this one: by the last look, or since looks
  /// fail or take too long (kLookGapMax); after config::PresenceConfig::adopted_grace no longer.
  /// Thread: any.
  [[nodiscard]] bool OthersUnseen() const;
  /// This process stops: it renews its lease until Stop, and adopts nobody any more.
  void StopAdopting() { adopts_.store(false); }

 private:
  /// A holder that is over, and how many robots of it this round saw.
  struct Ended {
    LeaseJudge::Verdict holder;
    std::size_t robots = 0;
  };
  /// What one reading of the robots of others showed.
  struct Listed {
    /// Those that this process shows.
    std::unordered_set<const robot::Robot*> robots;
    std::map<storage::ProcessId, Ended> ended;
  };

  absl::Status Look();
  /// The fleet is told where the leases are those of another server than at the last look.
  void FollowServer();
  absl::Status LookAtLeases();
  absl::Status FollowRobots();
  /// Null if it is not to be shown.
  [[nodiscard]] fleet::RobotPtr FindOrAdmit(const storage::ForeignRobot& foreign);
  void Follow(const storage::ForeignRobot& foreign, Listed& listed);
  /// The robot's holder is over: it becomes this process's.
  void Adopt(robot::Robot& robot, const storage::ForeignRobot& foreign,
             const LeaseJudge::Verdict& holder);
  /// Robots that were another's at the last look and are in nobody else's hands now: the store says
  /// that they are ours, by an answer that never came, or they have no row any more: then they
  /// leave memory.
  void TakeUnlisted(const Listed& listed);
  void LogEnded(const Listed& listed);
  void NoteOutcome(const absl::Status& status);
  void NoteVerdicts();
  void NoteLate();

  const std::unique_ptr<storage::Leases> leases_;
  const Context context_;
  LeaseJudge judge_;
  std::optional<SteadyTime> renewed_;
  /// When the leases were read last; before that when this was made.
  std::atomic<SteadyTime> looked_;
  /// storage::Leases::ServerRun of the last look.
  std::string server_run_;
  /// Processes that were over and had robots in the last round: each is a line of the log once.
  std::set<storage::ProcessId> over_;
  /// Processes that were late in the last round: each is a line of the log once.
  std::map<storage::ProcessId, std::string> late_;
  /// In how many looks, one after the other, a robot was in nobody's list; by RURI.
  std::map<std::string, int> unlisted_;
  bool failing_ = false;
  bool shut_out_ = false;
  std::atomic<std::uint16_t> port_{0};
  std::atomic<bool> adopts_{true};
  std::atomic<bool> renews_now_{false};
  std::mutex mutex_;
  /// Those that were asked for, at most kVerdictsMax; under the mutex.
  std::map<storage::ProcessId, std::optional<LeaseJudge::Verdict>> verdicts_;
  loop::Rounds rounds_;
};

}  // namespace uplink::store
