#include "server/forward/fleet_items.h"

#include <utility>

namespace uplink::forward {

// --- The shared set ---

FleetItems::FannedOut FleetItems::Put(const ItemKey& key, Item item) {
  const std::lock_guard lock(mutex_);
  auto place = items_.find(key);
  const Change change = place == items_.end() ? Change::kComes : Change::kChanges;
  if (change == Change::kComes) {
    place = items_.emplace(std::make_shared<const ItemKey>(key), Item{}).first;
  }
  place->second.frame = std::move(item.frame);
  SetExpiryOf(place->first, place->second, item.expires_ms);
  return FanOut(place->first, place->second.frame, change);
}

void FleetItems::SetExpiry(const ItemKey& key, std::int64_t expires_ms) {
  const std::lock_guard lock(mutex_);
  const auto place = items_.find(key);
  if (place != items_.end()) SetExpiryOf(place->first, place->second, expires_ms);
}

void FleetItems::SetExpiryOf(const KeyRef& key, Item& item, std::int64_t expires_ms) {
  if (item.expires_ms == expires_ms) return;
  expiries_.erase({item.expires_ms, key});
  item.expires_ms = expires_ms;
  if (expires_ms != 0) expiries_.emplace(expires_ms, key);
}

FleetItems::FannedOut FleetItems::Remove(const ItemKey& key, const EncodedFrame& deletion) {
  const std::lock_guard lock(mutex_);
  const auto place = items_.find(key);
  if (place == items_.end()) return {};
  const KeyRef gone = place->first;
  SetExpiryOf(gone, place->second, 0);
  items_.erase(place);
  return FanOut(gone, deletion, Change::kGoes);
}

std::vector<loop::StreamRef> FleetItems::SetWhole() {
  const std::lock_guard lock(mutex_);
  std::vector<loop::StreamRef> wake;
  if (std::exchange(whole_, true)) return wake;
  for (Receiver* receiver : receivers_) wake.push_back(receiver->stream);
  return wake;
}

EncodedFrame FleetItems::FrameOf(const ItemKey& key) const {
  const std::lock_guard lock(mutex_);
  const auto place = items_.find(key);
  return place == items_.end() ? nullptr : place->second.frame;
}

std::vector<ItemKey> FleetItems::Expired(std::int64_t now_ms, std::size_t most) const {
  const std::lock_guard lock(mutex_);
  std::vector<ItemKey> expired;
  for (const auto& [at, key] : expiries_) {
    if (at > now_ms || expired.size() >= most) break;
    expired.push_back(*key);
  }
  return expired;
}

// --- The fan-out ---

FleetItems::FannedOut FleetItems::FanOut(const KeyRef& key, const EncodedFrame& frame,
                                         Change change) {
  FannedOut out;
  for (Receiver* receiver : receivers_) {
    if (receiver->ruri == key->ruri) continue;
    ++counts_.due;
    if (Offer(*receiver, key, frame, change)) ++out.receivers;
    if (receiver->waiting.size() == 0 || std::exchange(receiver->woken, true)) continue;
    out.to_wake.push_back(receiver->stream);
  }
  return out;
}

bool FleetItems::Offer(Receiver& receiver, const KeyRef& key, const EncodedFrame& frame,
                       Change change) {
  const bool passed = receiver.state == Receiver::State::kFollows ||
                      (receiver.state == Receiver::State::kWalks && receiver.walked != nullptr &&
                       !KeyOrder()(receiver.walked, key));
  if (!passed || receiver.again) {
    ++counts_.replaced;
    return false;
  }
  switch (receiver.waiting.Add(key, frame, change)) {
    case WaitingChanges::Added::kNew:
      return true;
    case WaitingChanges::Added::kCoalesced:
      ++counts_.coalesced;
      return false;
    case WaitingChanges::Added::kCancelled:
      // This change, and the one that waited.
      counts_.coalesced += 2;
      return false;
    case WaitingChanges::Added::kFull:
      Overflow(receiver);
      return false;
  }
  return false;
}

void FleetItems::Overflow(Receiver& receiver) {
  counts_.replaced += receiver.waiting.size() + 1;
  ++counts_.overflows;
  if (overflowed_.size() < kOverflowsToldMax) {
    overflowed_.try_emplace(receiver.ruri, receiver.waiting.MostFrom());
  }
  receiver.waiting.Clear();
  if (receiver.state == Receiver::State::kFollows) {
    receiver.state = Receiver::State::kBegins;
  } else {
    receiver.again = true;
  }
}

std::map<std::string, std::string> FleetItems::TakeOverflowed() {
  const std::lock_guard lock(mutex_);
  return std::exchange(overflowed_, {});
}

// --- Receivers ---

std::unique_ptr<FleetItems::Receiver> FleetItems::Join(std::string ruri, loop::StreamRef stream) {
  auto receiver = std::make_unique<Receiver>(limits_.waiting_max);
  receiver->ruri = std::move(ruri);
  receiver->stream = stream;
  const std::lock_guard lock(mutex_);
  receiver->place = receivers_.size();
  receivers_.push_back(receiver.get());
  return receiver;
}

void FleetItems::Leave(Receiver& receiver) {
  const std::lock_guard lock(mutex_);
  counts_.dropped += receiver.waiting.size();
  receiver.waiting.Clear();
  receivers_[receiver.place] = receivers_.back();
  receivers_[receiver.place]->place = receiver.place;
  receivers_.pop_back();
}

void FleetItems::Take(Receiver& receiver, std::vector<EncodedFrame>& into) {
  const std::lock_guard lock(mutex_);
  receiver.woken = false;
  if (!whole_) return;
  Room room{limits_.taken_max, limits_.taken_bytes_max};
  if (receiver.state == Receiver::State::kBegins) {
    receiver.state = Receiver::State::kWalks;
    receiver.walked = nullptr;
    ++counts_.snapshots;
    into.push_back(marks_.begin);
  }
  if (receiver.state == Receiver::State::kWalks) {
    // The walk has the other half, so that it ends.
    Room half = room.Split();
    GiveWaiting(receiver, WaitingChanges::Which::kUpserts, half, into);
    room.Join(half);
    Walk(receiver, room, into);
  }
  if (receiver.state == Receiver::State::kFollows) {
    GiveWaiting(receiver, WaitingChanges::Which::kAll, room, into);
  }
}

void FleetItems::GiveWaiting(Receiver& receiver, WaitingChanges::Which which, Room& room,
                             std::vector<EncodedFrame>& into) {
  for (EncodedFrame frame = receiver.waiting.First(which); frame != nullptr && room.Give(frame);
       frame = receiver.waiting.First(which)) {
    into.push_back(std::move(frame));
    receiver.waiting.Pop(which);
    ++counts_.written;
  }
}

void FleetItems::Walk(Receiver& receiver, Room& room, std::vector<EncodedFrame>& into) {
  auto next = receiver.walked == nullptr ? items_.begin() : items_.upper_bound(receiver.walked);
  for (; next != items_.end(); ++next) {
    if (next->first->ruri == receiver.ruri) continue;
    if (!room.Give(next->second.frame)) return;
    receiver.walked = next->first;
    into.push_back(next->second.frame);
    ++counts_.snapshot_items;
  }
  into.push_back(marks_.end);
  receiver.walked = nullptr;
  const bool again = std::exchange(receiver.again, false);
  receiver.state = again ? Receiver::State::kBegins : Receiver::State::kFollows;
}

FleetItems::Sum FleetItems::sum() const {
  const std::lock_guard lock(mutex_);
  Sum sum{.counts = counts_, .items = items_.size(), .receivers = receivers_.size()};
  for (const Receiver* receiver : receivers_) {
    sum.waiting += receiver->waiting.size();
    if (receiver->state != Receiver::State::kFollows) ++sum.snapshots_open;
  }
  return sum;
}

}  // namespace uplink::forward
