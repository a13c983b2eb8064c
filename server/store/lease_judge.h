#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "schema/base/clock.h"
#include "storage/adopt.h"
#include "storage/identity.h"
#include "storage/leases.h"

namespace uplink::store {

/// How often a process raises the counter of its lease, and looks at those of others.
inline constexpr std::chrono::seconds kRenewEvery{5};
inline constexpr milliseconds kLookEvery{2'500};
/// A lease that showed the same counter for so long is over: six renewals did not come.
inline constexpr std::chrono::seconds kSilentMax{30};
/// Looks that lie further apart prove nothing of the time between: it was we who did not look.
inline constexpr std::chrono::seconds kLookGapMax{6};
/// A process that told nothing for so long is late: a renewal of its lease did not come.
inline constexpr std::chrono::seconds kLateAfter{7};

/// Whether a process still judges the robots that it holds, and why not.
enum class Over : std::uint8_t {
  kNo,
  /// It gave its robots up when it stopped.
  kReleased,
  /// It ran on this machine and is not there any more.
  kGone,
  /// It did not renew its lease, or never had one. It may live, and be cut off from the store
  /// alone.
  kSilent,
};
[[nodiscard]] std::string_view ToText(Over over);
/// What that means for those who adopt its robots. Of a process that is over.
[[nodiscard]] storage::HolderEnd EndOf(Over over);

/// Judges the leases of the other processes by what repeated looks at the store show, on this
/// process's own steady clock: no clock of another machine is compared.
///
/// Limits: one entry per process that is named (storage::kLeasesMax, and holders of robots without
///         a lease).
/// Thread: confined to one thread; no clock of its own.
class LeaseJudge final {
 public:
  struct Rules {
    /// This process.
    storage::ProcessId self{};
    /// How long the robots of a process that was seen to stop may take to come by themselves
    /// (presence.timeout: until then they count as heard).
    milliseconds time_to_move{0};
    /// Whether a process that ran there is not there any more (process_life.h).
    std::function<bool(std::string_view life)> is_gone;
    /// How long a process that tells nothing may live, and be cut off from the store alone
    /// (presence.adopted_grace).
    milliseconds cut_off_max{0};
  };
  explicit LeaseJudge(Rules rules) : rules_(std::move(rules)) {}

  /// A look at `now` failed: silence is counted anew from the next one.
  void NoteFailure(SteadyTime now);
  /// The next look is at a store that may lack renewals of the former: silence is counted anew.
  void NoteReplaced() { looked_.reset(); }
  /// A look at `now` showed these leases.
  void NoteLook(SteadyTime now, std::span<const storage::Lease> leases);
  /// The process wrote to the store since the last look, or opened a stream: it lives, though its
  /// lease may not show it.
  void NoteSign(const storage::ProcessId& process);
  /// A robot of the process was written at this time: a sign, if that is later than all of it that
  /// lists showed before. The first list of it shows none, however long ago it was written.
  void NoteWritten(const storage::ProcessId& process, SystemTime at);
  /// A list of all robots that others hold ends. Forgets processes without a lease that were not
  /// asked for since the last call: they hold no robot.
  void EndList();

  struct Verdict {
    Over over = Over::kNo;
    /// Of the lease as it was seen last; 0 if there is none.
    std::uint64_t counter = 0;
    /// For people: the card's name, or the process's number.
    std::string name;
  };
  /// Of a process that holds a robot, as of the last look.
  [[nodiscard]] Verdict Of(const storage::ProcessId& process);
  /// Other processes that are not over, as far as that can be told: one that was silent counts
  /// again only after a sign of it.
  [[nodiscard]] std::size_t others();
  /// Other processes that may live and hear robots of which they cannot tell, since they are late,
  /// as of the last look. For people: the card's name by process.
  [[nodiscard]] std::map<storage::ProcessId, std::string> Late() const;
  /// Looks have failed since, for at most Rules::cut_off_max: any other process may hear robots,
  /// one that came meanwhile too.
  [[nodiscard]] bool blind() const;

 private:
  struct Known {
    std::optional<storage::Lease> lease;
    /// The first look of an unbroken row that showed this counter.
    SteadyTime same_since;
    /// When it told the store last that it lives: not before, and not after.
    SteadyTime told_at;
    SteadyTime told_by;
    /// When it was first seen released or gone; nothing if it is neither.
    std::optional<SteadyTime> left_at;
    /// It had left when this process came, and its robots had nobody else to go to.
    bool left_before = false;
    /// It was silent for its time, and nothing came since.
    bool was_silent = false;
    /// The latest write of its robots in lists that have ended, and in all.
    std::optional<SystemTime> written_before;
    std::optional<SystemTime> written;
    /// It was asked for since EndList.
    bool asked = false;
  };
  void Update(Known& known, const storage::Lease& lease) const;
  [[nodiscard]] Over Judge(const Known& known) const;
  [[nodiscard]] bool IsLate(const Known& known) const;
  [[nodiscard]] static std::string NameOf(const storage::ProcessId& process, const Known& known);

  const Rules rules_;
  std::optional<SteadyTime> looked_;
  SteadyTime now_;
  /// What a look shows as new came no earlier: the look itself, or after a gap the one before.
  SteadyTime news_since_;
  bool first_look_ = true;
  /// The first and the last of the looks that failed since one did not.
  struct Blind {
    SteadyTime from;
    SteadyTime to;
  };
  std::optional<Blind> blind_;
  /// This is the first look, and no other process is there.
  bool came_alone_ = false;
  std::map<storage::ProcessId, Known> known_;
};

}  // namespace uplink::store
