#include "server/forward/waiting.h"

#include <utility>

namespace uplink::forward {

Waiting::Added Waiting::Add(const KeyRef& key, const EncodedFrame& frame, Change change) {
  const bool ends = change == Change::kGoes;
  if (const auto known = places_.find(key); known != places_.end()) {
    Place& place = known->second;
    Entries& from = Of(place.ends);
    const auto entry = from.find(place.number);
    if (ends && !entry->second.told) {
      from.erase(entry);
      places_.erase(known);
      return Added::kCancelled;
    }
    entry->second.frame = frame;
    if (place.ends != ends) Of(ends).insert(from.extract(entry));
    place.ends = ends;
    return Added::kCoalesced;
  }
  if (places_.size() >= items_max_) return Added::kFull;
  const std::uint64_t number = next_++;
  Entries& into = Of(ends);
  const bool told = change != Change::kComes;
  into.emplace_hint(into.end(), number, Entry{key, frame, told});
  places_.emplace(key, Place{number, ends});
  return Added::kNew;
}

const Waiting::Entries& Waiting::FirstOf(Which which) const {
  if (which == Which::kUpserts || ends_.empty()) return upserts_;
  if (upserts_.empty()) return ends_;
  return upserts_.begin()->first < ends_.begin()->first ? upserts_ : ends_;
}

EncodedFrame Waiting::First(Which which) const {
  const Entries& entries = FirstOf(which);
  return entries.empty() ? nullptr : entries.begin()->second.frame;
}

void Waiting::Pop(Which which) {
  Entries& entries = Of(&FirstOf(which) == &ends_);
  const auto first = entries.begin();
  places_.erase(first->second.key);
  entries.erase(first);
}

void Waiting::Clear() {
  places_.clear();
  upserts_.clear();
  ends_.clear();
}

}  // namespace uplink::forward
