#include "server/forward/waiting.h"

#include <utility>

namespace uplink::forward {

Waiting::Added Waiting::Add(const KeyRef& key, const EncodedFrame& frame, Change change) {
  if (const auto place = places_.find(key); place != places_.end()) {
    const auto entry = place->second;
    if (change == Change::kGoes && !entry->told) {
      places_.erase(place);
      entries_.erase(entry);
      return Added::kCancelled;
    }
    entry->frame = frame;
    return Added::kCoalesced;
  }
  if (entries_.size() >= items_max_) return Added::kFull;
  const bool told = change != Change::kComes;
  places_.emplace(key, entries_.insert(entries_.end(), {key, frame, told}));
  return Added::kNew;
}

EncodedFrame Waiting::Take() {
  EncodedFrame frame = std::move(entries_.front().frame);
  places_.erase(entries_.front().key);
  entries_.pop_front();
  return frame;
}

void Waiting::Clear() {
  places_.clear();
  entries_.clear();
}

}  // namespace uplink::forward
