// What follows a call of the store: what is told, the room that it makes, what is tried again.
#include <algorithm>
#include <utility>

#include "server/journal/journal.h"

namespace uplink::journal {

void Journal::TellOutcomes() {
  // In order of first appearance, so that a run repeats exactly.
  std::vector<std::pair<robot::CommitClient*, std::vector<robot::Settled>>> by_client;
  std::unordered_map<robot::CommitClient*, std::size_t> index;
  std::vector<robot::CommitClient*> fenced;
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < owners_.size(); ++i) {
    const Owner& owner = owners_[i];
    bytes += owner.bytes;
    if (owner.generation != owner.client->generation()) continue;
    storage::Outcome outcome = OutcomeOf(owner, std::move((*outcomes_)[i]));
    if (outcome.kind == storage::OutcomeKind::kFenced) {
      if (std::ranges::find(fenced, owner.client) == fenced.end()) fenced.push_back(owner.client);
      continue;
    }
    const auto [at, first] = index.try_emplace(owner.client, by_client.size());
    if (first) by_client.emplace_back(owner.client, std::vector<robot::Settled>{});
    const storage::CommitRecord& record = batch_.records[i];
    const auto* quarantined = std::get_if<storage::QuarantineItem>(&record.content);
    by_client[at->second].second.push_back(
        {.session = record.session,
         .seq = record.seq,
         .outcome = std::move(outcome),
         .rejected_for =
             quarantined != nullptr ? std::optional(quarantined->rejection.reason) : std::nullopt,
         .arrived = owner.arrived});
  }
  std::vector<robot::StreamRef> wake;
  wake.reserve(by_client.size() + fenced.size());
  for (const auto& [client, settled] : by_client) {
    wake.push_back(client->OnSettled(settled, ledger_));
  }
  for (robot::CommitClient* client : fenced) {
    held_since_.erase(client);
    wake.push_back(client->OnFenced(ledger_));
  }
  for (const Owner& owner : gap_owners_) {
    bytes += owner.bytes;
    wake.push_back(owner.client->OnGapsWritten(1));
  }
  const std::size_t records = owners_.size() + gap_owners_.size();
  outcomes_.reset();
  batch_.records.clear();
  batch_.gaps.clear();
  owners_.clear();
  gap_owners_.clear();
  Release(records, bytes);
  for (const robot::StreamRef stream : wake) stream.Wake();
}

void Journal::Release(std::size_t records, std::size_t bytes) {
  std::vector<robot::StreamRef> wake;
  {
    const std::lock_guard lock(mutex_);
    records_.fetch_sub(records);
    bytes_.fetch_sub(bytes);
    if (owners_.empty() && gap_owners_.empty()) batch_oldest_.reset();
    if (HasRoom()) wake.swap(waiting_for_room_);
  }
  for (const robot::StreamRef stream : wake) stream.Wake();
}

void Journal::NotePresence(const storage::RobotRef& robot, model::Presence presence,
                           SystemTime at) {
  {
    const std::lock_guard lock(mutex_);
    const std::size_t before = presence_.size();
    presence_.Note(robot, presence, at);
    presence_waiting_.fetch_add(presence_.size() - before);
  }
  work_.notify_one();
}

void Journal::BeginPresence(const storage::RobotRef& robot, model::Presence stored,
                            SystemTime now) {
  {
    const std::lock_guard lock(mutex_);
    // It was heard by now, and that is newer.
    if (presence_.Knows(robot->ruri)) return;
    const std::size_t before = presence_.size();
    presence_.SetStored(robot->ruri, stored);
    presence_.Note(robot, model::Presence::kUnknown, now);
    presence_waiting_.fetch_add(presence_.size() - before);
  }
  work_.notify_one();
}

void Journal::CountPresence() {
  for (const storage::PresenceItem& item : batch_.presence) {
    probe_.presence_changes[static_cast<std::size_t>(item.presence)].Add();
  }
  presence_waiting_.fetch_sub(batch_.presence.size());
  batch_.presence.clear();
}

void Journal::NoteSuccess(int& failures, std::size_t& now, std::size_t most) {
  if (now == most) {
    failures = 0;
    return;
  }
  failures = std::min(failures, 0) - 1;
  if (failures > -kSuccessesToDouble) return;
  failures = 0;
  now = std::min(most, 2 * now);
}

storage::Outcome Journal::OutcomeOf(const Owner& owner, storage::Outcome told) {
  // Numbers are taken once, so what the store has already is what an earlier try of ours wrote: it
  // was stored, once, and is counted so.
  if (owner.tried && told.kind == storage::OutcomeKind::kDuplicate) {
    told.kind = storage::OutcomeKind::kStored;
  }
  return told;
}

void Journal::NoteCommitFailure() {
  for (Owner& owner : owners_) owner.tried = true;
  commit_failures_ = std::max(commit_failures_, 0) + 1;
  if (commit_failures_ < kFailuresToHalve) return;
  commit_failures_ = 0;
  HalveBatch();
}

void Journal::HalveBatch() {
  const std::lock_guard lock(mutex_);
  const auto leave = [this](auto& items, std::vector<Owner>& owners, std::size_t keep) {
    while (owners.size() > keep) {
      const Owner& owner = owners.back();
      queue_.push_front({.client = owner.client,
                         .generation = owner.generation,
                         .arrived = owner.arrived,
                         .bytes = owner.bytes,
                         .item = std::move(items.back()),
                         .tried = owner.tried});
      items.pop_back();
      owners.pop_back();
    }
  };
  const std::size_t most = std::max({owners_.size(), gap_owners_.size(), batch_.presence.size()});
  batch_max_now_ = std::max<std::size_t>(most / 2, 1);
  leave(batch_.gaps, gap_owners_, batch_max_now_);
  leave(batch_.records, owners_, batch_max_now_);
  // The numbers of presence stand in order: what is left goes before what was left earlier.
  if (batch_.presence.size() <= batch_max_now_) return;
  const auto kept = batch_.presence.begin() + static_cast<std::ptrdiff_t>(batch_max_now_);
  presence_left_.insert(presence_left_.begin(), kept, batch_.presence.end());
  batch_.presence.erase(kept, batch_.presence.end());
}

void Journal::NoteOpenFailure() {
  open_failures_ = std::max(open_failures_, 0) + 1;
  if (open_failures_ < kFailuresToHalve || opening_.size() < 2) return;
  open_failures_ = 0;
  opens_max_now_ = opening_.size() / 2;
  const std::lock_guard lock(mutex_);
  while (opening_.size() > opens_max_now_) {
    // A newer request of the same robot stands for this one.
    const auto newer = std::ranges::find(opens_, opening_.back().client, &OpenEntry::client);
    if (newer == opens_.end()) {
      opens_.push_front(std::move(opening_.back()));
    } else {
      opens_waiting_.fetch_sub(1);
    }
    opening_.pop_back();
  }
}

void Journal::NoteResult(const absl::Status& status) {
  if (!status.ok()) probe_.store_errors.Add();
  const std::lock_guard lock(mutex_);
  NoteErrors(status, status.ok() ? absl::OkStatus() : duty_error_);
}

void Journal::NoteDuty(const absl::Status& status) {
  if (!status.ok()) probe_.store_errors.Add();
  const std::lock_guard lock(mutex_);
  NoteErrors(last_error_, status);
}

void Journal::NoteErrors(absl::Status call, absl::Status duty) {
  const bool worked = last_error_.ok() && duty_error_.ok();
  last_error_ = std::move(call);
  duty_error_ = std::move(duty);
  const bool works = last_error_.ok() && duty_error_.ok();
  if (works != worked) probe_.store_failing.Add(works ? -1 : 1);
}

}  // namespace uplink::journal
