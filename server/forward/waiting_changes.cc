#include "server/forward/waiting_changes.h"

#include <algorithm>

namespace uplink::forward {

const WaitingChanges::Entries& WaitingChanges::Origin::FirstOf(Which which) const {
  if (which == Which::kUpserts || ends.empty()) return upserts;
  if (upserts.empty()) return ends;
  return upserts.begin()->first < ends.begin()->first ? upserts : ends;
}

WaitingChanges::Added WaitingChanges::Add(const KeyRef& key, const EncodedFrame& frame,
                                          Change change) {
  const bool ends = change == Change::kGoes;
  if (const auto known = places_.find(key); known != places_.end()) {
    Place& place = known->second;
    Origin& origin = *place.origin;
    Entries& from = origin.Of(place.ends);
    const auto entry = from.find(place.number);
    if (ends && !entry->second.told) {
      from.erase(entry);
      places_.erase(known);
      Settle(key->ruri, origin);
      return Added::kCancelled;
    }
    entry->second.frame = frame;
    if (place.ends != ends) {
      origin.Of(ends).insert(from.extract(entry));
      place.ends = ends;
      Enlist(origin);
    }
    return Added::kCoalesced;
  }
  if (places_.size() >= items_max_) return Added::kFull;
  const std::uint64_t number = next_++;
  const auto [at, is_new] = origins_.try_emplace(key->ruri);
  Origin& origin = at->second;
  if (is_new) origin.turn = {now_, number};
  Entries& into = origin.Of(ends);
  const bool told = change != Change::kComes;
  into.emplace_hint(into.end(), number, Entry{key, frame, told});
  places_.emplace(key, Place{&origin, number, ends});
  if (into.size() == 1) Enlist(origin);
  return Added::kNew;
}

EncodedFrame WaitingChanges::First(Which which) const {
  const Turns& turns = TurnsOf(which);
  if (turns.empty()) return nullptr;
  return turns.begin()->second->FirstOf(which).begin()->second.frame;
}

void WaitingChanges::Pop(Which which) {
  Origin& origin = *TurnsOf(which).begin()->second;
  Entries& entries = origin.Of(&origin.FirstOf(which) == &origin.ends);
  const auto first = entries.begin();
  const KeyRef key = first->second.key;
  const std::size_t bytes = first->second.frame->size() + kWireOverheadBytes;
  now_ = std::max(now_, origin.turn.first);
  turns_.erase(origin.turn);
  upsert_turns_.erase(origin.turn);
  origin.turn = {origin.turn.first + bytes, next_++};
  places_.erase(key);
  entries.erase(first);
  Settle(key->ruri, origin);
}

void WaitingChanges::Enlist(Origin& origin) {
  turns_.try_emplace(origin.turn, &origin);
  if (origin.upserts.empty()) {
    upsert_turns_.erase(origin.turn);
  } else {
    upsert_turns_.try_emplace(origin.turn, &origin);
  }
}

void WaitingChanges::Settle(const std::string& ruri, Origin& origin) {
  if (origin.size() > 0) return Enlist(origin);
  turns_.erase(origin.turn);
  upsert_turns_.erase(origin.turn);
  origins_.erase(ruri);
}

void WaitingChanges::Clear() {
  places_.clear();
  turns_.clear();
  upsert_turns_.clear();
  origins_.clear();
}

std::string WaitingChanges::MostFrom() const {
  const auto most =
      std::ranges::max_element(origins_, {}, [](const auto& entry) { return entry.second.size(); });
  return most == origins_.end() ? std::string() : most->first;
}

}  // namespace uplink::forward
