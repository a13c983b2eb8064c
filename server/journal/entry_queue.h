#pragma once

#include <cstddef>
#include <deque>
#include <list>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "schema/base/clock.h"
#include "server/journal/batch_shares.h"
#include "server/journal/entry.h"
#include "server/journal/gathered_batch.h"
#include "server/journal/held_robots.h"
#include "server/journal/limits.h"

namespace uplink::journal {

/// What a batch may hold.
struct BatchBounds {
  std::size_t records_max = 0;
  /// A batch ends with the record that reaches this.
  std::size_t bytes_max = 0;
  BatchShare robot;
};

/// Records and gaps that wait for the writer, each robot's in their order. A robot with more than
/// its share of a batch lags: its entries wait in a line of their own, and others pass them. Half
/// of a batch is the lines', one after the other, and half the others'; what one half leaves is the
/// other's. What comes of one message (Origin::continues) stays together.
///
/// Limits: the journal's, kept by those who append; kPassedMax entries change lines per batch, and
///         the rest of a message.
/// Thread: confined to its owner's lock.
class EntryQueue final {
 public:
  void Push(Entry entry) { queue_.push_back(std::move(entry)); }
  /// They wait again, ahead of all else of their robots.
  void PutBack(std::vector<Entry> entries);
  /// Moves what goes first into `batch`, up to the first that may not be committed yet. Returns
  /// when the oldest of it arrived; nothing if there is none.
  std::optional<SteadyTime> MoveTo(GatheredBatch& batch, const BatchBounds& bounds,
                                   const HeldRobots& held);

  [[nodiscard]] bool empty() const { return queue_.empty() && lagging_.empty(); }
  /// When the oldest of them arrived; nothing if none waits.
  [[nodiscard]] std::optional<SteadyTime> oldest() const;

 private:
  struct Filling;
  /// The entries of one robot; never empty, and all older than those of the robot in queue_.
  using Line = std::deque<Entry>;
  using Lines = std::list<Line>;

  /// Until the batch holds so much.
  void TakeLagging(Filling& filling, std::size_t records_max, std::size_t bytes_max);
  void TakeNext(Filling& filling);
  /// Moves the first message of `from` to the end of `line`. Returns how many entries that were.
  static std::size_t MoveMessage(Line& from, Line& line);
  [[nodiscard]] Line* LineOf(const Entry& entry);

  std::deque<Entry> queue_;
  /// Whose turn is next goes first.
  Lines lagging_;
  bool lines_first_ = false;
  std::unordered_map<const robot::CommitClient*, Lines::iterator> lines_;
};

}  // namespace uplink::journal
