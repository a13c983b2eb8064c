#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tests/simulation/holders_process.h"
#include "tests/support/manual_clock.h"

namespace uplink::simulation {

struct HoldersOptions {
  std::uint64_t seed = 1;
  /// What happens before everything must settle.
  enum class Trouble : std::uint8_t {
    /// Robots move and fall silent; each true change is one row.
    kNone,
    /// Processes stop in order and are followed by others; no presence changes.
    kUpdates,
    /// Kills, standstills, processes that are cut off from the store, lost answers, and the above.
    kAll,
    /// Deleted rows of robots, and all the above.
    kRows,
    /// Suspends of the machine on which all processes run, and everything but deleted rows.
    kSuspends,
    /// The store becomes a standby that lacks the last commits, and everything but deleted rows. In
    /// one of three worlds sessions with the store end every few seconds, to the last.
    kFailovers,
  };
  Trouble trouble = Trouble::kAll;
  HoldersFault fault = HoldersFault::kNone;
};

struct HoldersResult {
  /// Empty if every promise was kept; else what was broken.
  std::string violation;
  /// What happened, for people.
  std::vector<std::string> lines;
  std::uint64_t rows = 0;
  std::uint64_t adoptions = 0;
  std::uint64_t moves = 0;
  /// Streams that came to a process that is known as cut off.
  std::uint64_t moves_to_cut = 0;
  /// Streams whose robots left while the network told neither side.
  std::uint64_t half_open = 0;
  std::uint64_t kills = 0;
  std::uint64_t standstills = 0;
  /// Of these, those in which connections broke.
  std::uint64_t long_standstills = 0;
  std::uint64_t cuts = 0;
  std::uint64_t stops = 0;
  /// Rows of robots that another hand deleted.
  std::uint64_t deletions = 0;
  std::uint64_t suspends = 0;
  std::uint64_t failovers = 0;
  /// How often all sessions with the store ended by themselves.
  std::uint64_t session_ends = 0;
};

/// Two or three places for server processes on one store, and robots that stream to them: one
/// seeded schedule of troubles, then a time in which everything must settle.
///
/// Each robot has one stream at most. It connects to a process that reaches the store, as one that
/// does not is not ready; while none reaches it, to any; and at times to one that is known as cut
/// off, past whatever asks for readiness.
///
/// Thread: confined to its caller; nothing in it waits or reads a real clock.
class HoldersWorld final {
 public:
  explicit HoldersWorld(const HoldersOptions& options);
  HoldersResult Run();

 private:
  /// Where one life of a process follows the other.
  struct Place {
    std::unique_ptr<HoldersProcess> process;
    std::uint8_t lives = 0;
    /// Processes elsewhere see that one that ran here is gone.
    bool seen = false;
    std::optional<SteadyTime> starts_at;
    /// It stands still until then; what was sent to it is unread until then.
    SteadyTime still_until;
    SteadyTime unread_until;
    /// It cannot reach the store until then.
    SteadyTime cut_since;
    SteadyTime cut_until;
    /// So many of a hundred calls of the store are lost.
    std::uint32_t lost_percent = 0;
    /// It stops in order: the streams have ended, and the rest does then.
    std::optional<SteadyTime> stops_at;
    /// Streams that ended, and that it has not read so.
    struct UnreadEnd {
      std::string ruri;
      std::uint64_t stream = 0;
      bool spoke = false;
    };
    std::vector<UnreadEnd> unread_ends;
    /// Streams whose robot is gone, which the process takes for open until its keepalive ends them.
    struct HalfOpen {
      std::string ruri;
      std::uint64_t stream = 0;
      SteadyTime ends_at;
    };
    std::vector<HalfOpen> half_open;
  };
  struct Link {
    std::size_t place = 0;
    std::uint8_t life = 0;
    std::uint64_t stream = 0;
  };
  struct Robot {
    storage::RobotRef id;
    std::optional<Link> link;
    /// Times from which it connects, and says something next.
    SteadyTime connects_at;
    SteadyTime speaks_at;
    /// It said something that its process has not read.
    bool unread = false;
    /// Of what was not read first.
    SteadyTime unread_since;
    std::optional<SteadyTime> heard_at;
    /// Its connection to this life of a place broke in a standstill, and it is about to come back.
    std::optional<Link> broke;
    /// It is silent for long enough to be offline, or was not heard yet.
    bool silent = true;
    /// True changes of its presence.
    std::uint64_t changes = 0;
    /// It said Goodbye, and was silent since.
    std::optional<SystemTime> parked_until;
  };

  // --- Time ---
  void Pass(milliseconds time);
  void Tick();
  void StepOf(Place& place);
  [[nodiscard]] bool Stands(const Place& place) const {
    return clock_.Steady() < place.still_until;
  }
  /// It reads what robots send.
  [[nodiscard]] bool Hears(const Place& place) const;
  [[nodiscard]] bool Reaches(const Place& place) const {
    return clock_.Steady() >= place.cut_until;
  }
  /// It has not reached the store for so long that the others know that its lease is late.
  [[nodiscard]] bool IsKnownAsCut(const Place& place) const;

  // --- Robots ---
  void StepOf(Robot& robot);
  void Speak(Robot& robot, Place& place);
  void Connect(Robot& robot);
  void Leave(Robot& robot, milliseconds pause);
  /// Null if the life of the process to which it streamed has ended.
  [[nodiscard]] Place* PlaceOf(const Robot& robot);
  /// Places to which a robot may connect.
  [[nodiscard]] std::vector<std::size_t> Ready() const;
  /// It takes streams.
  [[nodiscard]] bool Serves(const Place& place) const;
  void ReadEnds(Place& place);
  /// Ends half-open streams of the place: those that are due, or were superseded, or of this robot.
  void EndHalfOpen(Place& place, std::string_view ruri = {});
  /// A robot that is on its way back is there.
  void NoteOnItsWay(const Robot& robot);

  // --- Troubles ---
  void Trouble();
  void AnyTrouble();
  void Update();
  [[nodiscard]] bool AnyMayCome() const {
    return options_.trouble >= HoldersOptions::Trouble::kAll;
  }
  /// It was heard just now, and is again soon.
  [[nodiscard]] bool IsHeard(const Robot& robot) const;
  void TroubleOf(Robot& robot);
  void FallSilent(Robot& robot, milliseconds time);
  void Start(Place& place);
  void End(Place& place);
  void Kill(Place& place);
  void BeginStop(Place& place);
  void StandStill(Place& place);
  void BreakConnections(Place& place);
  /// All processes stand still, and the monotonic clock with them; connections break.
  void Suspend();
  void KeepCopy();
  void GoBack();
  void EndSessions();
  void Cut(Place& place, milliseconds time);
  void DeleteRow(const Robot& robot);

  // --- Promises ---
  void CheckHolds();
  void CheckAdopted(const std::string& ruri, const HoldersTruth::Hold& hold);
  void Settle();
  /// The robot says to its holder that it leaves. False if it does not stream to it.
  bool SayGoodbye(Robot& robot);
  void CheckEnd();
  void CheckEndOf(const Robot& robot, HoldersProcess& holder, storage::Epoch since);
  void CheckElsewhere(const Robot& robot, const HoldersProcess& holder);
  [[nodiscard]] bool MayBeUnknown(const Robot& robot);
  /// The lease of a process that has ended still looks like that of one that is cut off.
  [[nodiscard]] bool AnyLooksCut() const;

  [[nodiscard]] milliseconds Between(milliseconds least, milliseconds most);

  const HoldersOptions options_;
  Random random_;
  testing::ManualClock clock_;
  testing::ManualBootClock boot_{clock_};
  testing::FakeDatabase database_;
  /// A standby that lacks the last commits; set while it is about to take over.
  testing::FakeDatabase copy_;
  std::optional<SteadyTime> goes_back_at_;
  /// When sessions end next, in a world in which they do.
  std::optional<SteadyTime> sessions_end_at_;
  HoldersTruth truth_;
  HoldersResult result_;
  std::vector<Place> places_;
  std::vector<Robot> robots_;
  std::set<std::string, std::less<>> gone_;
  /// Troubles are over: robots do what they did last.
  bool settling_ = false;
};

}  // namespace uplink::simulation
