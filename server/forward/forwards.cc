#include "server/forward/forwards.h"

#include <utility>

#include "server/forward/frames.h"
#include "server/forward/limits.h"

namespace uplink::forward {
namespace {

/// Expired items that one look removes of a fleet under its lock.
constexpr std::size_t kExpiredAtOnce = 256;

std::size_t BytesOf(const ItemKey& key, const EncodedFrame& frame) {
  return frame->size() + key.ruri.size() + key.id.size() + kItemOverheadBytes;
}

}  // namespace

/// A stream's membership in its fleet.
class Forwards::Receiver final : public session::ForwardReceiver {
 public:
  Receiver(FleetRef fleet, std::string ruri, loop::StreamRef stream)
      : fleet_(std::move(fleet)), receiver_(fleet_->Join(std::move(ruri), stream)) {}
  ~Receiver() override { fleet_->Leave(*receiver_); }
  Receiver(const Receiver&) = delete;
  Receiver& operator=(const Receiver&) = delete;

  void Take(std::vector<EncodedFrame>& into) override { fleet_->Take(*receiver_, into); }

 private:
  const FleetRef fleet_;
  const std::unique_ptr<FleetItems::Receiver> receiver_;
};

Forwards::Forwards(const Shares::Limits& limits, std::function<std::uint64_t()> random,
                   const ReceiverLimits& receivers)
    : marks_{SnapshotBegin(), SnapshotEnd()},
      receiver_limits_(receivers),
      random_(std::move(random)),
      shares_(limits) {}

std::unique_ptr<session::ForwardReceiver> Forwards::Join(const model::RobotId& robot,
                                                         loop::StreamRef stream) {
  return std::make_unique<Receiver>(FleetOf(robot.fleet), robot.ruri, stream);
}

Forwards::FleetRef Forwards::FleetOf(const std::string& name) {
  const std::lock_guard lock(mutex_);
  FleetRef& fleet = fleets_[name];
  if (fleet == nullptr) {
    fleet = std::make_shared<FleetItems>(marks_, whole_, receiver_limits_);
  }
  return fleet;
}

std::vector<Forwards::FleetRef> Forwards::Fleets() const {
  std::vector<FleetRef> fleets;
  const std::lock_guard lock(mutex_);
  fleets.reserve(fleets_.size());
  for (const auto& [name, fleet] : fleets_) fleets.push_back(fleet);
  return fleets;
}

// --- The shared set ---

std::size_t Forwards::Put(const ItemKey& key, const Facts& facts, const Encode& encode) {
  const auto known = where_.find(key);
  if (known == where_.end()) return PutNew(key, facts, encode);
  Where& where = known->second;
  if (where.fleet_name != facts.fleet) {
    const std::size_t ends = Remove(key);
    return ends + PutNew(key, facts, encode);
  }
  const EncodedFrame same = encode(where.command);
  if (same == nullptr) return Remove(key);
  if (*same == *where.fleet->FrameOf(key)) {
    where.fleet->SetExpiry(key, facts.expires_ms);
    return 0;
  }
  where.command = NewCommand();
  EncodedFrame frame = encode(where.command);
  const std::size_t frame_bytes = frame->size();
  const std::size_t bytes = BytesOf(key, frame);
  const Shares::Holder holder{key.ruri, facts.fleet};
  if (!TakeRoom(holder, where.bytes, bytes)) {
    // Its forwarded content is no longer valid.
    const std::size_t ends = Remove(key);
    shares_.NoteLeftOut(holder);
    return ends;
  }
  where.bytes = bytes;
  return NoteFannedOut(
      where.fleet->Put(key, {.frame = std::move(frame), .expires_ms = facts.expires_ms}),
      frame_bytes);
}

std::size_t Forwards::PutNew(const ItemKey& key, const Facts& facts, const Encode& encode) {
  const Shares::Holder holder{key.ruri, facts.fleet};
  const auto leave_out = [&] {
    shares_.NoteLeftOut(holder);
    return std::size_t{0};
  };
  if (!shares_.MayFit(holder, facts.least_bytes + kItemOverheadBytes)) return leave_out();
  const nexus_command::CommandId command = NewCommand();
  EncodedFrame frame = encode(command);
  if (frame == nullptr) return 0;
  const std::size_t frame_bytes = frame->size();
  const std::size_t bytes = BytesOf(key, frame);
  if (!TakeRoom(holder, 0, bytes)) return leave_out();
  shares_.NoteChanged(key.ruri);
  const Where where{facts.fleet, FleetOf(facts.fleet), command, bytes};
  where_.emplace(key, where);
  return NoteFannedOut(
      where.fleet->Put(key, {.frame = std::move(frame), .expires_ms = facts.expires_ms}),
      frame_bytes);
}

bool Forwards::TakeRoom(const Shares::Holder& holder, std::size_t before, std::size_t after) {
  for (std::size_t gone = 0; !shares_.Resize(holder, before, after); ++gone) {
    const auto who = shares_.ChooseToGiveWay(holder, before, after);
    if (!who || gone == kGiveWayMax || !LeaveOutOne(*who)) return false;
  }
  return true;
}

bool Forwards::LeaveOutOne(const Shares::OwnedHolder& holder) {
  for (const storage::PresentKind kind : storage::kItemKinds) {
    const auto first = where_.lower_bound(ItemKey{kind, holder.ruri, ""});
    if (first == where_.end() || first->first.kind != kind || first->first.ruri != holder.ruri) {
      continue;
    }
    const ItemKey key = first->first;
    Remove(key);
    shares_.NoteLeftOut({holder.ruri, holder.fleet});
    return true;
  }
  return false;
}

std::size_t Forwards::Remove(const ItemKey& key) {
  const auto known = where_.find(key);
  if (known == where_.end()) {
    // The item may have been left out before.
    shares_.NoteChanged(key.ruri);
    return 0;
  }
  const Where where = std::move(known->second);
  const ItemKey gone = known->first;
  where_.erase(known);
  static_cast<void>(shares_.Resize({gone.ruri, where.fleet_name}, where.bytes, 0));
  const EncodedFrame deletion = DeleteFrame(gone, NewCommand());
  return NoteFannedOut(where.fleet->Remove(gone, deletion), deletion->size());
}

void Forwards::Postpone(const ItemKey& key, const std::string& fleet, std::int64_t expires_ms) {
  const auto known = where_.find(key);
  if (known == where_.end()) return;
  if (known->second.fleet_name == fleet) {
    known->second.fleet->SetExpiry(key, expires_ms);
  } else {
    Remove(key);
  }
}

std::size_t Forwards::NoteFannedOut(const FleetItems::FannedOut& out, std::size_t frame_bytes) {
  NoteToWake(out.to_wake);
  return out.receivers * (frame_bytes + kWireOverheadBytes);
}

std::map<std::string, std::string> Forwards::TakeOverflowed() {
  std::map<std::string, std::string> robots;
  for (const FleetRef& fleet : Fleets()) robots.merge(fleet->TakeOverflowed());
  return robots;
}

void Forwards::NoteToWake(const std::vector<loop::StreamRef>& streams) {
  to_wake_.insert(to_wake_.end(), streams.begin(), streams.end());
}

std::size_t Forwards::WakeReceivers() {
  for (const loop::StreamRef stream : to_wake_) stream.Wake();
  const std::size_t woken = to_wake_.size();
  to_wake_.clear();
  return woken;
}

void Forwards::SetWhole() {
  {
    const std::lock_guard lock(mutex_);
    whole_ = true;
  }
  for (const FleetRef& fleet : Fleets()) NoteToWake(fleet->SetWhole());
}

void Forwards::Expire(SystemTime now) {
  for (const FleetRef& fleet : Fleets()) {
    for (auto expired = fleet->Expired(UnixMs(now), kExpiredAtOnce); !expired.empty();
         expired = fleet->Expired(UnixMs(now), kExpiredAtOnce)) {
      for (const ItemKey& key : expired) Remove(key);
    }
  }
}

std::vector<ItemKey> Forwards::Keys() const {
  std::vector<ItemKey> keys;
  keys.reserve(where_.size());
  for (const auto& [key, where] : where_) keys.push_back(key);
  return keys;
}

nexus_command::CommandId Forwards::NewCommand() const {
  return nexus_command::RandomCommandId(random_);
}

Forwards::Sum Forwards::sum() const {
  Sum sum{.bytes = shares_.bytes(), .left_out = shares_.left_out()};
  {
    const std::lock_guard lock(mutex_);
    sum.whole = whole_;
  }
  for (const FleetRef& fleet : Fleets()) {
    const FleetItems::Sum of_fleet = fleet->sum();
    sum.counts += of_fleet.counts;
    sum.waiting += of_fleet.waiting;
    sum.items += of_fleet.items;
    sum.receivers += of_fleet.receivers;
    sum.snapshots_open += of_fleet.snapshots_open;
  }
  return sum;
}

}  // namespace uplink::forward
