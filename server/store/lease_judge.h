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

/// How often a process raises the counter of its lease, and reads the other leases.
inline constexpr std::chrono::seconds kRenewEvery{5};
inline constexpr milliseconds kLookEvery{2'500};
/// A lease that kept its counter for so long is over: it missed six renewals.
inline constexpr std::chrono::seconds kSilentMax{30};
/// Looks further apart than this prove nothing about the time between them.
inline constexpr std::chrono::seconds kLookGapMax{6};
/// A process that was silent for so long is late: it missed a renewal.
inline constexpr std::chrono::seconds kLateAfter{7};

/// Whether a process no longer judges the robots that it holds, and why.
enum class Over : std::uint8_t {
  kNo,
  /// It gave up its robots when it stopped.
  kReleased,
  /// It ran on this machine, and has ended.
  kGone,
  /// It did not renew its lease, or never had one. It may live, and only be cut off from the store.
  kSilent,
};
[[nodiscard]] std::string_view ToText(Over over);
/// What that means for the adopter of its robots. For processes that are over.
[[nodiscard]] storage::HolderEnd EndOf(Over over);

/// Judges the leases of the other processes by repeated looks at the store, on this process's
/// steady clock. It compares no clock of another machine.
///
/// Limits: one entry per named process (storage::kLeasesMax, and holders of robots without a
///         lease).
/// Thread: confined to one thread; no clock of its own.
class LeaseJudge final {
 public:
  struct Rules {
    /// This process.
    storage::ProcessId self{};
    /// How long robots may take to connect to this process after theirs stopped. This is
    /// presence.timeout, since until then they count as heard.
    milliseconds time_to_move{0};
    /// Whether the process with this life has ended (process_life.h).
    std::function<bool(std::string_view life)> is_gone;
    /// How long a silent process may live, cut off only from the store (presence.adopted_grace).
    milliseconds cut_off_max{0};
  };
  explicit LeaseJudge(Rules rules) : rules_(std::move(rules)) {}

  /// A look at `now` failed: silence counts from the next one.
  void NoteFailure(SteadyTime now);
  /// The next look is at a store that may have lost renewals: silence counts from then. Its robots
  /// may be those of earlier holders again, so its first list shows no signs either.
  void NoteReplaced();
  /// A look at `now` showed these leases.
  void NoteLook(SteadyTime now, std::span<const storage::Lease> leases);
  /// The process wrote to the store since the last look, or opened a stream: it lives, even if its
  /// lease does not show it.
  void NoteSign(const storage::ProcessId& process);
  /// A robot of the process was written at this time. That is a sign of life if it is later than
  /// all writes that earlier lists showed. The first list of a store shows none.
  void NoteWritten(const storage::ProcessId& process, SystemTime at);
  /// Ends a list of all robots that others hold. Forgets processes without a lease that were not
  /// asked for since the last call: they hold no robot.
  void EndList();

  struct Verdict {
    Over over = Over::kNo;
    /// The counter of its lease as last seen; 0 if it has none.
    std::uint64_t counter = 0;
    /// For people: the name in its lease, or the process's number.
    std::string name;
  };
  /// The verdict on a process that holds a robot, as of the last look.
  [[nodiscard]] Verdict Of(const storage::ProcessId& process);
  /// Other processes that are not known to be over: one that was silent counts again only after a
  /// sign of life.
  [[nodiscard]] std::size_t others();
  /// Late processes, as of the last look: they may live and hear robots, and cannot tell us. With
  /// the name for people.
  [[nodiscard]] std::map<storage::ProcessId, std::string> Late() const;
  /// Whether looks have been failing, for at most Rules::cut_off_max: any other process may hear
  /// robots meanwhile, even a new one.
  [[nodiscard]] bool blind() const;

 private:
  struct Known {
    std::optional<storage::Lease> lease;
    /// The first of the uninterrupted looks that showed this counter.
    SteadyTime same_since;
    /// When it last renewed: the earliest and the latest time.
    SteadyTime told_at;
    SteadyTime told_by;
    /// When it was first seen released or gone; empty if it is neither.
    std::optional<SteadyTime> left_at;
    /// It had left when this process came, and its robots had no other process to go to.
    bool left_before = false;
    /// It was silent for too long, and has shown no sign since.
    bool was_silent = false;
    /// The latest write of its robots in ended lists, and in all.
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
  /// News of a look is no older than this: the look itself, or after a gap the one before.
  SteadyTime news_since_;
  bool first_look_ = true;
  /// The first and the last of the failed looks since a successful one.
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
