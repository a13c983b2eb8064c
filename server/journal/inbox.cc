#include "server/journal/inbox.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "server/robot/limits.h"

namespace uplink::journal {
namespace {

Origin OriginOf(robot::CommitClient& client, const AppendedBy& by, SteadyTime arrived,
                std::size_t bytes) {
  return {.client = &client,
          .generation = by.generation,
          .arrived = arrived,
          .bytes = bytes,
          .place = GatewayPlace(by.gateway, bytes)};
}

}  // namespace

void Inbox::Open(OpenEntry entry) {
  {
    const std::lock_guard lock(mutex_);
    if (!opens_.Push(std::move(entry))) return;
  }
  work_.notify_one();
}

void Inbox::Claim(ClaimEntry entry) {
  {
    const std::lock_guard lock(mutex_);
    if (!claims_.Push(std::move(entry))) return;
  }
  work_.notify_one();
}

GatewayRef Inbox::GatewayOf(const std::string& name) {
  if (name.empty()) return nullptr;
  const std::lock_guard lock(mutex_);
  std::erase_if(gateways_, [](const auto& known) { return known.second.expired(); });
  std::weak_ptr<GatewayUse>& known = gateways_[name];
  GatewayRef gateway = known.lock();
  if (gateway == nullptr) known = gateway = std::make_shared<GatewayUse>();
  return gateway;
}

void Inbox::AppendMessage(robot::CommitClient& client, const AppendedBy& by,
                          std::vector<storage::CommitRecord> records, SteadyTime arrived) {
  // Measured before the lock: a body may be large.
  std::vector<Entry> entries;
  entries.reserve(records.size());
  for (storage::CommitRecord& record : records) {
    const std::size_t bytes = CostOf(record);
    Origin origin = OriginOf(client, by, arrived, bytes);
    origin.continues = entries.size() + 1 < records.size();
    origin.is_sample = record.sample != nullptr;
    entries.push_back({.origin = std::move(origin), .item = std::move(record)});
  }
  Push(std::move(entries));
}

void Inbox::AppendGap(robot::CommitClient& client, const AppendedBy& by, storage::GapItem gap) {
  std::vector<Entry> entries;
  entries.push_back({.origin = OriginOf(client, by, clock_.Steady(), robot::kRecordOverheadBytes),
                     .item = std::move(gap)});
  Push(std::move(entries));
}

void Inbox::Push(std::vector<Entry> entries) {
  {
    const std::lock_guard lock(mutex_);
    for (Entry& entry : entries) {
      records_.fetch_add(1);
      bytes_.fetch_add(entry.origin.bytes);
      queue_.Push(std::move(entry));
    }
  }
  work_.notify_one();
}

void Inbox::Remember(storage::Deliveries deliveries) {
  {
    const std::lock_guard lock(mutex_);
    // One lease at a time: deliveries under an older one are fenced.
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

void Inbox::WhenCommitted(loop::StreamRef stream) {
  {
    const std::lock_guard lock(mutex_);
    if (std::ranges::find(waiting_for_commit_, stream) != waiting_for_commit_.end()) return;
    waiting_for_commit_.push_back(stream);
  }
  work_.notify_one();
}

void Inbox::NotePresence(const storage::RobotRef& robot, model::Presence presence, SystemTime at,
                         std::optional<model::ConnectionEnd> why,
                         std::optional<SystemTime> parked_until) {
  {
    const std::lock_guard lock(mutex_);
    presence_.Note(robot, presence, at, why, parked_until);
  }
  work_.notify_one();
}

bool Inbox::NoteConnection(storage::ConnectionItem item) {
  item = storage::Bounded(std::move(item));
  {
    const std::lock_guard lock(mutex_);
    if (!connections_.Note(std::move(item))) return false;
  }
  work_.notify_one();
  return true;
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

bool Inbox::IsWithin(const GatewayUse* gateway, std::size_t shares, std::size_t bytes) const {
  if (gateway == nullptr) return true;
  // No less than one of its robots may have.
  const std::size_t part = std::min(limits_.robot_share, limits_.gateway_share);
  const std::size_t records_max = std::max<std::size_t>(limits_.records_max / part, 1);
  return gateway->records() < shares * records_max &&
         gateway->bytes() + bytes <= shares * (limits_.bytes_max / part);
}

Room Inbox::RoomFor(const robot::JournalUse& robot, std::size_t bytes,
                    const GatewayUse* gateway) const {
  const std::size_t records_max =
      std::max<std::size_t>(limits_.records_max / limits_.robot_share, 1);
  const bool over = robot.records >= records_max ||
                    robot.bytes + bytes > limits_.bytes_max / limits_.robot_share ||
                    !IsWithin(gateway, 1, bytes);
  if (robot.records > 0 && over) return Room::kShareFull;
  return HasRoomFor(gateway) ? Room::kFree : Room::kFull;
}

void Inbox::WhenRoom(loop::StreamRef stream, GatewayRef gateway) {
  {
    const std::lock_guard lock(mutex_);
    if (!HasRoomFor(gateway.get())) {
      if (std::ranges::find(waiting_for_room_, stream, &Waiter::stream) ==
          waiting_for_room_.end()) {
        waiting_for_room_.push_back({stream, std::move(gateway)});
      }
      return;
    }
  }
  stream.Wake();
}

milliseconds Inbox::oldest(SteadyTime now) const {
  const std::lock_guard lock(mutex_);
  // Entries left by earlier batches may be older than those of the last one.
  std::optional<SteadyTime> oldest = queue_.oldest();
  if (batch_oldest_ && (!oldest || *batch_oldest_ < *oldest)) oldest = batch_oldest_;
  return oldest ? std::chrono::duration_cast<milliseconds>(now - *oldest) : milliseconds(0);
}

}  // namespace uplink::journal
