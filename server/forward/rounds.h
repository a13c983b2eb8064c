#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include <absl/status/status.h>

#include "schema/base/clock.h"
#include "server/forward/forwards.h"
#include "server/forward/limits.h"
#include "server/forward/once_per_robot_log.h"
#include "server/forward/paces.h"
#include "server/forward/probe.h"
#include "server/forward/unreadable_items.h"
#include "server/limits/recent_times.h"
#include "server/log/logger.h"
#include "server/loop/rounds.h"
#include "storage/clock_trust.h"
#include "storage/shared_items.h"

namespace uplink::forward {

/// How long changes wait after a look that woke so many streams.
[[nodiscard]] SteadyTime::duration LookAgainAfter(std::size_t woken);

/// Keeps the shared set as the store has it: reads all of it once, then every change that any
/// server commits, by the store's own numbering, and removes items that expire. It looks for
/// changes of this server at once, unless the last look is too recent (LookAgainAfter), and for
/// another server's within kLookEvery.
///
/// Only what the store holds is forwarded, nothing from a session or the journal. So a kill loses
/// no forward, and a fenced or refused record makes none.
///
/// Thread: Wake from any; Round by one thread at a time: Start gives it one of its own.
class Rounds final {
 public:
  /// The references outlive it.
  struct Context {
    const Clock& clock;
    const log::Logger& logger;
    storage::SharedItems& items;
    Forwards& forwards;
    ForwardProbe& probe;
    const storage::ClockTrust& clock_trust;
    Paces::Limits paces = {.fan_out = kFanOut, .waiting_max = kPacedItemsMax};
    /// How often the store is asked without a wake-up.
    SteadyTime::duration look_every = kLookEvery;
  };
  explicit Rounds(const Context& context);
  Rounds(const Rounds&) = delete;
  Rounds& operator=(const Rounds&) = delete;

  void Start() { rounds_.Start(); }
  void Stop() { rounds_.Stop(); }
  /// Something that may be shared was committed.
  void Wake() { rounds_.Wake(); }
  /// One look. Returns what the store answered.
  absl::Status Round();

 private:
  absl::Status Look();
  /// Reads all shared items, and removes those that are gone.
  absl::Status ReadAll();
  /// Reads again the items of robots with left-out items, if there may be room for them.
  absl::Status LookAtLeftOut();
  absl::Status ReadRobot(const std::string& ruri);
  /// What a walk through the pages does with each item, until it returns false, and between pages.
  struct Walk {
    std::function<bool(const storage::SharedItem&)> take;
    std::function<absl::Status()> between;
  };
  absl::Status WalkPages(std::optional<storage::ItemKey> after, const Walk& walk);
  /// Does what must not wait for long: expiries, changes, and changes that waited for their pace.
  absl::Status Step();
  void Expire();
  absl::Status FollowChanges();
  absl::Status Apply(std::span<const storage::ItemKey> keys, Paces::Turn turn);
  /// Puts the item unless its robot is over its pace: then it waits.
  void PutPaced(const storage::SharedItem& item, Paces::Turn turn);
  void Put(const storage::SharedItem& item);
  void WakeReceivers();
  void Remove(const storage::ItemKey& key);
  /// When the next look comes after the one that began at `began` and has ended now.
  [[nodiscard]] loop::Next NextLook(SteadyTime began, SteadyTime now);
  void TellRobots();
  [[nodiscard]] bool Expired(std::int64_t expires_ms) const;
  void Tell(const absl::Status& status);

  const Context context_;
  /// Empty: everything must be read.
  std::optional<storage::ChangePositions> positions_;
  limits::RecentTimes<1> left_out_looks_;
  bool failing_ = false;
  UnreadableItems unreadable_;
  Paces paces_;
  OncePerRobotLog left_out_;
  OncePerRobotLog paced_;
  /// Receivers of the last look only: one that falls behind again is named again.
  OncePerRobotLog behind_;
  /// The thread's.
  std::stop_token stop_;
  /// Streams that the last look woke.
  std::size_t woken_streams_ = 0;
  loop::Rounds rounds_;
};

}  // namespace uplink::forward
