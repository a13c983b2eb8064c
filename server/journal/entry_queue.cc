#include "server/journal/entry_queue.h"

#include <iterator>
#include <utility>

namespace uplink::journal {

/// A batch while it is being filled.
struct EntryQueue::Filling {
  GatheredBatch& batch;
  const BatchBounds& bounds;
  const HeldRobots& held;
  BatchShares shares{bounds.robot};
  std::size_t bytes = 0;
  std::size_t passed = 0;
  std::optional<SteadyTime> oldest{};

  [[nodiscard]] bool full() const {
    return batch.entries() >= bounds.records_max || bytes >= bounds.bytes_max ||
           passed >= kPassedMax;
  }
  /// The first message of `from`, of which the first entry was admitted: all of it counts as its
  /// robot's share.
  void AddMessage(std::deque<Entry>& from) {
    bool continues = true;
    for (bool first = true; continues; first = false) {
      Entry& entry = from.front();
      if (!first) (void)shares.Admit(entry.origin);
      continues = entry.origin.continues;
      bytes += entry.origin.bytes;
      if (!oldest || entry.origin.arrived < *oldest) oldest = entry.origin.arrived;
      batch.Add(std::move(entry));
      from.pop_front();
    }
  }
};

std::optional<SteadyTime> EntryQueue::MoveTo(GatheredBatch& batch, const BatchBounds& bounds,
                                             const HeldRobots& held) {
  Filling filling{.batch = batch, .bounds = bounds, .held = held};
  // A batch of one is alternately a line's and another's.
  lines_first_ = !lines_first_;
  TakeLagging(filling, (bounds.records_max + (lines_first_ ? 1 : 0)) / 2, bounds.bytes_max / 2);
  while (!queue_.empty() && !filling.full() && held.MayCommit(queue_.front().origin)) {
    TakeNext(filling);
  }
  TakeLagging(filling, bounds.records_max, bounds.bytes_max);
  return filling.oldest;
}

void EntryQueue::TakeLagging(Filling& filling, std::size_t records_max, std::size_t bytes_max) {
  const auto full = [&] {
    return filling.batch.entries() >= records_max || filling.bytes >= bytes_max;
  };
  for (std::size_t turns = lagging_.size(); turns > 0 && !full(); --turns) {
    Line& line = lagging_.front();
    const auto* const robot = line.front().origin.client.get();
    while (!line.empty() && !full() && filling.held.MayCommit(line.front().origin) &&
           filling.shares.Admit(line.front().origin)) {
      filling.AddMessage(line);
    }
    if (line.empty()) {
      lagging_.pop_front();
      lines_.erase(robot);
    } else {
      lagging_.splice(lagging_.end(), lagging_, lagging_.begin());
    }
  }
}

void EntryQueue::TakeNext(Filling& filling) {
  const Entry& next = queue_.front();
  if (Line* const line = LineOf(next)) {
    filling.passed += MoveMessage(queue_, *line);
  } else if (filling.shares.Admit(next.origin)) {
    filling.AddMessage(queue_);
  } else {
    const auto* const robot = next.origin.client.get();
    filling.passed += MoveMessage(queue_, lagging_.emplace_back());
    lines_.emplace(robot, std::prev(lagging_.end()));
  }
}

std::size_t EntryQueue::MoveMessage(Line& from, Line& line) {
  std::size_t moved = 0;
  bool continues = true;
  for (; continues; ++moved) {
    continues = from.front().origin.continues;
    line.push_back(std::move(from.front()));
    from.pop_front();
  }
  return moved;
}

EntryQueue::Line* EntryQueue::LineOf(const Entry& entry) {
  if (lines_.empty()) return nullptr;
  const auto found = lines_.find(entry.origin.client.get());
  return found == lines_.end() ? nullptr : &*found->second;
}

void EntryQueue::PutBack(std::vector<Entry> entries) {
  for (; !entries.empty(); entries.pop_back()) {
    Line* const line = LineOf(entries.back());
    (line != nullptr ? *line : queue_).push_front(std::move(entries.back()));
  }
}

std::optional<SteadyTime> EntryQueue::oldest() const {
  std::optional<SteadyTime> oldest;
  const auto consider = [&oldest](const Line& line) {
    if (line.empty()) return;
    const SteadyTime arrived = line.front().origin.arrived;
    if (!oldest || arrived < *oldest) oldest = arrived;
  };
  consider(queue_);
  for (const Line& line : lagging_) consider(line);
  return oldest;
}

}  // namespace uplink::journal
