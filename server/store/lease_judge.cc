#include "server/store/lease_judge.h"

#include <algorithm>

#include "schema/model/ids.h"

namespace uplink::store {

std::string_view ToText(Over over) {
  switch (over) {
    case Over::kNo:
      return "no";
    case Over::kReleased:
      return "released";
    case Over::kGone:
      return "gone";
    case Over::kSilent:
      return "silent";
  }
  return "";
}

storage::HolderEnd EndOf(Over over) {
  switch (over) {
    case Over::kReleased:
    case Over::kGone:
      return storage::HolderEnd::kEnded;
    case Over::kNo:
    case Over::kSilent:
      break;
  }
  return storage::HolderEnd::kSilent;
}

void LeaseJudge::NoteFailure(SteadyTime now) {
  looked_.reset();
  blind_ = {.from = blind_ ? blind_->from : now, .to = now};
}

void LeaseJudge::NoteReplaced() {
  looked_.reset();
  for (auto& [process, known] : known_) known.written_before.reset();
}

bool LeaseJudge::blind() const { return blind_ && blind_->to - blind_->from <= rules_.cut_off_max; }

void LeaseJudge::NoteLook(SteadyTime now, std::span<const storage::Lease> leases) {
  const bool unbroken = looked_ && now - *looked_ <= kLookGapMax;
  news_since_ = unbroken ? now : now_;
  looked_ = now_ = now;
  blind_.reset();
  for (auto& [process, known] : known_) {
    if (!unbroken) known.same_since = now;
    const bool there = std::ranges::find(leases, process, &storage::Lease::process) != leases.end();
    if (!there) known.lease.reset();
  }
  came_alone_ =
      first_look_ && std::ranges::none_of(leases, [this](const storage::Lease& lease) {
        return lease.process != rules_.self && !lease.released && !rules_.is_gone(lease.card.life);
      });
  for (const storage::Lease& lease : leases) {
    if (lease.process == rules_.self) continue;
    Update(known_.try_emplace(lease.process, Known{.same_since = now}).first->second, lease);
  }
  for (auto& [process, known] : known_) {
    if (unbroken && now - known.same_since >= kSilentMax) known.was_silent = true;
  }
  first_look_ = false;
}

void LeaseJudge::NoteSign(const storage::ProcessId& process) {
  const auto known = known_.find(process);
  if (known == known_.end()) return;
  known->second.same_since = known->second.told_by = now_;
  known->second.told_at = std::max(known->second.told_at, news_since_);
  known->second.was_silent = false;
}

void LeaseJudge::NoteWritten(const storage::ProcessId& process, SystemTime at) {
  const auto known = known_.find(process);
  if (known == known_.end()) return;
  const std::optional<SystemTime>& before = known->second.written_before;
  if (before && at > *before) NoteSign(process);
  known->second.written = std::max(at, known->second.written.value_or(at));
}

void LeaseJudge::EndList() {
  std::erase_if(known_,
                [](const auto& entry) { return !entry.second.lease && !entry.second.asked; });
  for (auto& [process, known] : known_) {
    known.asked = false;
    known.written_before = known.written;
  }
}

void LeaseJudge::Update(Known& known, const storage::Lease& lease) const {
  const bool grew = known.lease && known.lease->counter != lease.counter;
  if (grew || !known.lease) {
    known.same_since = now_;
    known.told_at = known.told_by = now_ - lease.renewed_ago;
    known.was_silent = false;
    // A process whose counter grows has not gone.
    if (grew && !lease.released) known.left_at.reset();
  }
  known.lease = lease;
  if (!lease.released && !rules_.is_gone(lease.card.life)) {
    known.left_at.reset();
  } else if (!known.left_at) {
    known.left_at = now_;
    known.left_before = came_alone_;
  }
}

LeaseJudge::Verdict LeaseJudge::Of(const storage::ProcessId& process) {
  Known& known = known_.try_emplace(process, Known{.same_since = now_}).first->second;
  known.asked = true;
  return {.over = Judge(known),
          .counter = known.lease ? known.lease->counter : 0,
          .name = NameOf(process, known)};
}

std::string LeaseJudge::NameOf(const storage::ProcessId& process, const Known& known) {
  const bool named = known.lease && !known.lease->card.name.empty();
  return named ? known.lease->card.name : model::SessionId(process).ToHex();
}

Over LeaseJudge::Judge(const Known& known) const {
  if (known.left_at && (known.left_before || now_ - *known.left_at >= rules_.time_to_move)) {
    return known.lease && known.lease->released ? Over::kReleased : Over::kGone;
  }
  if (now_ - known.same_since < kSilentMax) return Over::kNo;
  return Over::kSilent;
}

bool LeaseJudge::IsLate(const Known& known) const {
  if (!known.lease || known.left_at) return false;
  return now_ - known.told_at >= kLateAfter && now_ - known.told_by <= rules_.cut_off_max;
}

std::map<storage::ProcessId, std::string> LeaseJudge::Late() const {
  std::map<storage::ProcessId, std::string> late;
  for (const auto& [process, known] : known_) {
    if (IsLate(known)) late.emplace(process, NameOf(process, known));
  }
  return late;
}

std::size_t LeaseJudge::others() {
  return static_cast<std::size_t>(std::ranges::count_if(known_, [this](const auto& entry) {
    return entry.second.lease && !entry.second.left_at && !entry.second.was_silent &&
           Judge(entry.second) == Over::kNo;
  }));
}

}  // namespace uplink::store
