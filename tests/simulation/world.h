#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "storage/reader.h"
#include "tests/simulation/payloads.h"
#include "tests/simulation/random.h"
#include "tests/simulation/recorder.h"
#include "tests/simulation/sim_agent.h"
#include "tests/simulation/sim_items.h"
#include "tests/simulation/sim_server.h"
#include "tests/simulation/trace.h"
#include "tests/simulation/traced_store.h"

namespace uplink::simulation {

/// How long quarantine is kept by a store that deletes it for its age.
inline constexpr std::chrono::days kQuarantineKept{14};

/// The durable thing under test: opened anew by each life of the process on the same data.
class Backend {
 public:
  virtual ~Backend() = default;
  /// A store for a new process; the one before is gone as after a kill.
  virtual storage::Store& Reopen(const storage::ProcessId& process) = 0;
  /// Compares what lies in the store with the book; a sentence for the first difference.
  virtual std::optional<std::string> Compare(const Recorder& recorder) = 0;
  /// Reads what lies in the store that was opened last; until the next Reopen.
  virtual storage::Reader& Rows() = 0;
  /// The shapes and objects of that store that robots share; until the next Reopen.
  virtual storage::SharedItems& Items() = 0;
  /// Another hand deletes the robot's row in `robots`; all else of it stays.
  virtual void DeleteRobotRow(const std::string& ruri) = 0;
  /// The same, with all its shapes and objects.
  virtual void RemoveRobot(const std::string& ruri) = 0;
  /// Quarantine was deleted for its age.
  virtual void AfterRetain() {}
  /// Whether another store can take over from it.
  [[nodiscard]] virtual bool CanGoBack() const { return false; }
  /// Copies what lies in the store, for GoBack. Only of one that can go back, as that.
  virtual void KeepCopy() {}
  /// Another program gives the names of the store's files to a copy of them: what is written from
  /// now on until the next Reopen is lost with it. False if the store has no files.
  virtual bool ReplaceFiles() { return false; }
  /// The store becomes the last copy, as a standby that takes over without the last commits; false
  /// if there is none.
  virtual bool GoBack() { return false; }
};

/// Troubles; each one tests one more promise. A value.
struct Troubles {
  /// Shapes and objects have a rate, and the network loses answers.
  bool rates = true;
  /// Quarantine is deleted for its age.
  bool retention = true;
  /// Who was offline stays so over a restart.
  bool restarts = true;
  /// The store becomes a standby that lacks the last commits.
  bool failovers = true;
};

struct RunOptions {
  std::uint64_t seed = 1;
  std::uint32_t steps = 400;
  /// Is given everything that the server does; null: nothing is traced.
  Trace* trace = nullptr;
  ForwardFault forward_fault = ForwardFault::kNone;
  Troubles troubles;
};

struct RunResult {
  /// Empty if every promise was kept; else the step and what was broken.
  std::string violation;
  std::uint32_t steps = 0;
  /// Over all lives of the process.
  metrics::MessageCounts uplinks;
  forward::Counts forwards;
  std::uint64_t kills = 0;
  std::uint64_t breaks = 0;
  /// Rows of robots that were deleted.
  std::uint64_t deletions = 0;
  /// How often the store went back, and how often others took the names of its files.
  std::uint64_t failovers = 0;
  std::uint64_t replacements = 0;
  /// Floods of shapes and objects whose answers were all lost.
  std::uint64_t floods = 0;
  /// Steps after which a robot's stream was held back; for its share, or for its flow.
  std::uint64_t held_back = 0;
  std::uint64_t held_back_by_share = 0;
  std::uint64_t held_back_by_flow = 0;
  /// Streams that the server ended, by status.
  std::map<absl::StatusCode, std::uint64_t> ends;
};

/// Everything in the result, one figure a line: two runs are the same run if it is equal.
[[nodiscard]] std::string ToText(const RunResult& result);

/// Runs one seeded schedule of agents, network, process and store, checks every promise after every
/// step, then lets faults stop and checks that everything settles.
///
/// Thread: confined to its caller; nothing in it waits or reads a real clock.
class World final {
 public:
  World(const Payloads& payloads, Backend& backend, const RunOptions& options);
  RunResult Run();

 private:
  struct Robot {
    explicit Robot(SimAgent given) : agent(std::move(given)) {}

    SimAgent agent;
    std::optional<std::uint64_t> stream;
    std::uint64_t batches_acked = 0;
  };

  void Step();
  void NetworkStep(SimStream& stream, Robot* owner);
  void AgentStep(Robot& robot);
  /// A thread of its own reads the shared set: others work between two of its calls.
  void BetweenReads();
  void FaultStep();
  void StoreTrouble();
  void GoBack();
  /// More Rejects for a rate than a session's memory holds, and the network loses them all.
  void Flood(Robot& robot);
  void DeleteRow(const std::string& ruri);
  void Kill();
  void StartServer();
  void AddRobots();
  /// What this life of the process counted.
  void AddCounts();
  void Connect(Robot& robot);
  static void Receive(Robot& robot, const ToAgent& received);
  void Check();
  void CheckLaw();
  void CheckForwardLaw();
  /// Bytes of a frame that is not whole keep its robot online, and for no longer than a minute.
  void CheckSlowFrame();
  void CheckShare(const std::string& ruri, const robot::RobotSessions& sessions);
  /// Who was offline before the process began stays so until it is heard.
  void CheckRestored();
  void CheckEnds();
  /// Shapes and objects at most twice a second.
  void AddRates();
  /// One greedy robot among five, each with an eighth of the journal.
  void AddGreed();
  [[nodiscard]] bool MayEnd(std::uint64_t id, const SimStream& stream, absl::StatusCode code);
  [[nodiscard]] Robot* OwnerOf(std::uint64_t stream);
  void Reap();

  void Heal();
  void HealRound();
  [[nodiscard]] bool Settled();
  void CheckEnd();
  void CheckPresence();
  /// Each receiver has been told all that there is to tell.
  [[nodiscard]] bool ForwardsSettled();
  void CheckTables();
  /// What is left at the end, and the result.
  void TraceEnd();

  const Payloads& payloads_;
  Backend& backend_;
  const RunOptions options_;
  Random random_;
  testing::ManualClock clock_;
  RunResult result_;
  Recorder recorder_;
  std::optional<TracedStore> traced_;
  ServerLimits limits_;
  forward::ReceiverLimits receiver_limits_;
  std::unique_ptr<SimItems> items_;
  std::unique_ptr<SimServer> server_;
  std::vector<std::unique_ptr<Robot>> robots_;
  /// The first robot is.
  bool greedy_ = false;
  /// Shapes and objects have a rate.
  bool limited_ = false;
  /// The store goes back now and then; it did so in this life of the process.
  bool goes_back_ = false;
  bool went_back_ = false;
  /// The names of the store's files lead to others.
  bool replaced_ = false;
  /// Robots that were offline when this life of the process began, and did not come since.
  std::set<std::string> offline_;
  bool away_ = false;
  /// The last round of the end read all that was committed before.
  bool all_read_ = false;
  /// Deletions of a robot's row that have ended no stream of it yet: each may end one.
  std::map<std::string, std::uint64_t> deletions_;
};

}  // namespace uplink::simulation
