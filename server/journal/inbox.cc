#include "server/journal/inbox.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "server/robot/limits.h"

namespace uplink::journal {

void Inbox::Open(OpenEntry entry) {
  {
    const std::lock_guard lock(mutex_);
    if (!opens_.Push(std::move(entry))) return;
  }
  work_.notify_one();
}

void Inbox::Append(robot::CommitClient& client, std::uint64_t generation,
                   storage::CommitRecord record, SteadyTime arrived) {
  const std::size_t bytes = CostOf(record);
  Push({.origin = {.client = &client, .generation = generation, .arrived = arrived, .bytes = bytes},
        .item = std::move(record)});
}

void Inbox::AppendMessage(robot::CommitClient& client, std::uint64_t generation,
                          std::vector<storage::CommitRecord> records, SteadyTime arrived) {
  {
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 0; i < records.size(); ++i) {
      const std::size_t bytes = CostOf(records[i]);
      records_.fetch_add(1);
      bytes_.fetch_add(bytes);
      queue_.Push({.origin = {.client = &client,
                              .generation = generation,
                              .arrived = arrived,
                              .bytes = bytes,
                              .continues = i + 1 < records.size()},
                   .item = std::move(records[i])});
    }
  }
  work_.notify_one();
}

void Inbox::AppendGap(robot::CommitClient& client, std::uint64_t generation, storage::GapItem gap) {
  Push({.origin = {.client = &client,
                   .generation = generation,
                   .arrived = clock_.Steady(),
                   .bytes = robot::kRecordOverheadBytes},
        .item = std::move(gap)});
}

void Inbox::Push(Entry entry) {
  {
    const std::lock_guard lock(mutex_);
    records_.fetch_add(1);
    bytes_.fetch_add(entry.origin.bytes);
    queue_.Push(std::move(entry));
  }
  work_.notify_one();
}

void Inbox::Remember(storage::Deliveries deliveries) {
  {
    const std::lock_guard lock(mutex_);
    // One lease at a time: what came under an older one is fenced.
    std::erase_if(deliveries_, [&](const auto& each) { return each.hold != deliveries.hold; });
    if (deliveries_.empty()) {
      deliveries_.push_back(std::move(deliveries));
    } else {
      std::vector<storage::Delivery>& rows = deliveries_.front().rows;
      rows.insert(rows.end(), deliveries.rows.begin(), deliveries.rows.end());
      if (std::ssize(rows) > kDeliveriesWaitingMax) {
        rows.erase(rows.begin(), rows.end() - kDeliveriesWaitingMax);
      }
    }
  }
  work_.notify_one();
}

void Inbox::WhenCommitted(robot::StreamRef stream) {
  {
    const std::lock_guard lock(mutex_);
    if (std::ranges::find(waiting_for_commit_, stream) != waiting_for_commit_.end()) return;
    waiting_for_commit_.push_back(stream);
  }
  work_.notify_one();
}

void Inbox::NotePresence(const storage::RobotRef& robot, model::Presence presence, SystemTime at) {
  {
    const std::lock_guard lock(mutex_);
    presence_.Note(robot, presence, at);
  }
  work_.notify_one();
}

void Inbox::Adopt(AdoptEntry entry) {
  {
    const std::lock_guard lock(mutex_);
    if (!adopts_.Push(std::move(entry))) return;
  }
  work_.notify_one();
}

void Inbox::Lose(LossEntry entry) {
  {
    const std::lock_guard lock(mutex_);
    if (!adopts_.Push(std::move(entry))) return;
  }
  work_.notify_one();
}

void Inbox::Leave(LeaveEntry entry) {
  {
    const std::lock_guard lock(mutex_);
    if (!adopts_.Push(std::move(entry))) return;
  }
  work_.notify_one();
}

void Inbox::RequestCheckpoint() {
  {
    const std::lock_guard lock(mutex_);
    checkpoint_open_.store(true);
    checkpoint_asked_.store(true);
  }
  work_.notify_one();
}

Room Inbox::RoomFor(const robot::JournalUse& robot, std::size_t bytes) const {
  const std::size_t records_max =
      std::max<std::size_t>(limits_.records_max / limits_.robot_share, 1);
  const bool over =
      robot.records >= records_max || robot.bytes + bytes > limits_.bytes_max / limits_.robot_share;
  if (robot.records > 0 && over) return Room::kShareFull;
  return HasRoom() ? Room::kFree : Room::kFull;
}

void Inbox::WhenRoom(robot::StreamRef stream) {
  {
    const std::lock_guard lock(mutex_);
    if (!HasRoom()) {
      if (std::ranges::find(waiting_for_room_, stream) == waiting_for_room_.end()) {
        waiting_for_room_.push_back(stream);
      }
      return;
    }
  }
  stream.Wake();
}

milliseconds Inbox::oldest(SteadyTime now) const {
  const std::lock_guard lock(mutex_);
  // What lags may be older than what was taken.
  std::optional<SteadyTime> oldest = queue_.oldest();
  if (batch_oldest_ && (!oldest || *batch_oldest_ < *oldest)) oldest = batch_oldest_;
  return oldest ? std::chrono::duration_cast<milliseconds>(now - *oldest) : milliseconds(0);
}

}  // namespace uplink::journal
