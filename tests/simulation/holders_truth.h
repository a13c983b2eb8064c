#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "schema/base/clock.h"
#include "storage/epoch.h"
#include "storage/identity.h"
#include "storage/presence.h"
#include "tests/support/fake_database.h"

namespace uplink::simulation {

/// What really happened to robots and processes, and the promises that every write of a process is
/// held against. Nothing that the product believes goes into it.
///
/// A sign of life counts for a robot if the process that took it is the robot's holder in the
/// store, or the one from which the present holder adopted the robot: a process that is cut off
/// from the store goes on to hear, and its robots are not offline. It also counts if that process
/// has been cut off for long enough and had a lease before, even if another holds the robot. These
/// do not count, since no holder can know them: what another process hears of a robot before the
/// store has opened its stream, or after another process opened one; what it reads of a stream that
/// has ended; what is heard by one whose adopter was adopted from in turn.
///
/// The time of a row is that of the judgement, however late it is written, so an OFFLINE row is
/// held against the last sign before that time, with no tolerance: each step of the simulation has
/// a time of its own.
class HoldersTruth final {
 public:
  HoldersTruth(const Clock& clock, const testing::FakeDatabase& database, milliseconds timeout)
      : clock_(clock), database_(database), timeout_(timeout) {}

  struct Hold {
    storage::ProcessId holder{};
    storage::Epoch since = 0;
  };
  /// Who holds each robot in the store.
  [[nodiscard]] std::map<std::string, Hold> Holds() const;

  // --- What happens ---

  void NoteRenewed(const storage::ProcessId& process) { renewed_[process] = clock_.Steady(); }
  /// It stopped and released its lease, or was killed.
  enum class End : std::uint8_t { kReleased, kKilled };
  /// A lease that was renewed so lately is not silent before its end is seen.
  static constexpr std::chrono::seconds kFresh{15};
  void NoteEnded(const storage::ProcessId& process, End end);
  /// A process took a sign of life of a robot that, by what it knows, it holds since then.
  void NoteSign(const std::string& ruri, const storage::ProcessId& process,
                storage::Epoch held_since);
  /// A process took one that has been cut off from the store for so long that the others know; if
  /// they ever knew of it.
  void NoteSignAtCut(const std::string& ruri, const storage::ProcessId& process);
  /// How long ago the process renewed its lease; zero if it never did.
  [[nodiscard]] milliseconds RenewedAgo(const storage::ProcessId& process) const;

  // --- What a process did to the store ---

  using HasStream = std::function<bool(const std::string& ruri)>;
  /// A stream of the robot was opened; `before` is as it was then.
  void OnOpened(const storage::ProcessId& process, const std::string& ruri,
                const std::map<std::string, Hold>& before, const HasStream& has_stream);
  void OnAdopted(const storage::ProcessId& process, const std::map<std::string, Hold>& before);
  /// A change of presence was written.
  void OnWritten(const storage::ProcessId& process, const storage::PresenceItem& item);

  // --- What is known of a robot ---

  struct Row {
    model::Presence presence = model::Presence::kUnknown;
    SystemTime at;
  };
  /// The changes of a robot, in the order of writing.
  [[nodiscard]] const std::vector<Row>& RowsOf(const std::string& ruri) {
    return robots_[ruri].rows;
  }
  /// How the present hold of a robot began.
  struct Began {
    bool adopted = false;
    /// A stream was opened under it since.
    bool opened = false;
    SteadyTime at;
    SystemTime system_at;
    /// Of an adopted one: how its former holder had ended by then, if it had, while its lease was
    /// fresh.
    storage::ProcessId from{};
    std::optional<End> ended_fresh;
    /// All who held it since its last stream, and whether there were several.
    std::set<storage::ProcessId> formers;
    bool chained = false;
  };
  [[nodiscard]] const Began& BeganOf(const std::string& ruri) { return robots_[ruri].began; }
  /// The holder adopted the robot from another process that lives, and may have heard it since.
  [[nodiscard]] bool MayBeHeardAtFormer(const std::string& ruri, const storage::ProcessId& holder);
  [[nodiscard]] std::uint64_t adoptions() const { return adoptions_; }

  // --- The store goes back ---

  /// What the store has of each robot is put aside with a copy of it.
  void KeepCopy() { copy_ = robots_; }
  /// The store is that copy again; `before` is as it was until then. Who held a robot by a hold
  /// that is lost goes on to hear it until another process opens its stream.
  void GoBack(const std::map<std::string, Hold>& before);
  /// The process has compared what it was told with the store: it knows which holds are lost.
  void NoteCompared(const storage::ProcessId& process);
  /// The store has lost this hold, whether or not another one had ended it before, and the process
  /// could not know it yet.
  [[nodiscard]] bool IsLost(const std::string& ruri, const storage::ProcessId& process,
                            storage::Epoch since) {
    return robots_[ruri].unknowing.contains({process, since});
  }

  /// Something was not kept; only the first such thing is told.
  void Fail(std::string what);
  [[nodiscard]] const std::string& violation() const { return violation_; }
  /// What happened, for people.
  void Tell(std::string line);
  [[nodiscard]] const std::vector<std::string>& lines() const { return lines_; }

 private:
  struct Robot {
    /// Of signs that count, ascending.
    std::vector<SystemTime> signs;
    std::vector<Row> rows;
    /// The hold under which a stream was opened last.
    storage::Epoch opened_since = 0;
    Began began;
    using Holds = std::set<std::pair<storage::ProcessId, storage::Epoch>>;
    /// All that ever began, as the store has it.
    Holds begun;
    /// Those by which robots were held until the store lost them; until another stream is opened.
    Holds lost;
    /// Those that the store has lost, until their process has compared what it was told.
    Holds unknowing;
  };
  void CheckOver(const std::string& ruri, const storage::ProcessId& holder);
  void CheckSilence(const Robot& robot, const storage::PresenceItem& item);

  const Clock& clock_;
  const testing::FakeDatabase& database_;
  const milliseconds timeout_;
  std::map<std::string, Robot> robots_;
  std::map<std::string, Robot> copy_;
  std::map<storage::ProcessId, SteadyTime> renewed_;
  struct Ended {
    End how = End::kKilled;
    SteadyTime at;
  };
  std::map<storage::ProcessId, Ended> ended_;
  std::uint64_t adoptions_ = 0;
  std::string violation_;
  std::vector<std::string> lines_;
};

}  // namespace uplink::simulation
