#include "server/fleet/candidates.h"

#include <algorithm>

namespace uplink::fleet {

void Candidates::Note(const Claim& claim, SystemTime now) {
  const std::lock_guard lock(mutex_);
  const auto [found, is_new] = by_ruri_.try_emplace(claim.robot.ruri);
  Entry& entry = found->second;
  if (is_new) {
    entry.candidate.first_at = now;
  } else {
    by_note_.erase(entry.note);
  }
  entry.candidate.robot = claim.robot;
  entry.candidate.gateway = claim.gateway;
  entry.candidate.last_at = now;
  ++entry.candidate.refused;
  entry.note = ++notes_;
  by_note_.emplace(entry.note, claim.robot.ruri);
  if (by_ruri_.size() <= kCandidatesMax) return;
  Evict();
}

void Candidates::Evict() {
  std::map<std::string_view, std::size_t> held;
  for (const auto& [ruri, entry] : by_ruri_) ++held[entry.candidate.robot.fleet];
  const auto most =
      std::ranges::max_element(held, {}, [](const auto& fleet) { return fleet.second; });
  const auto oldest = std::ranges::find_if(by_note_, [this, &most](const auto& note) {
    return by_ruri_.find(note.second)->second.candidate.robot.fleet == most->first;
  });
  by_ruri_.erase(oldest->second);
  by_note_.erase(oldest);
}

void Candidates::Remove(std::string_view ruri) {
  const std::lock_guard lock(mutex_);
  const auto found = by_ruri_.find(ruri);
  if (found == by_ruri_.end()) return;
  by_note_.erase(found->second.note);
  by_ruri_.erase(found);
}

std::vector<Candidate> Candidates::All() const {
  const std::lock_guard lock(mutex_);
  std::vector<Candidate> all;
  all.reserve(by_ruri_.size());
  for (auto note = by_note_.rbegin(); note != by_note_.rend(); ++note) {
    all.push_back(by_ruri_.find(note->second)->second.candidate);
  }
  return all;
}

}  // namespace uplink::fleet
