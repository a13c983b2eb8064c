#include "server/robot/reject_memory.h"

#include <algorithm>
#include <map>

#include "server/robot/limits.h"

namespace uplink::robot {

void RejectMemory::Remember(RejectedSeq rejected) {
  // It was counted when it first came, and would be dropped again at once.
  if (rejected.seq <= left_through_) return;
  const auto at = std::ranges::lower_bound(remembered_, rejected.seq, {}, &RejectedSeq::seq);
  if (at != remembered_.end() && at->seq == rejected.seq) return;
  remembered_.insert(at, std::move(rejected));
  ++unconfirmed_;
  if (remembered_.size() <= kRejectsRememberedMax) return;
  left_through_ = remembered_.front().seq;
  remembered_.pop_front();
}

void RejectMemory::RememberLive(RejectedSeq limited) {
  live_limited_.push_back(std::move(limited));
  if (live_limited_.size() > kRejectsRememberedMax) live_limited_.pop_front();
}

void RejectMemory::AddUntold(RejectedSeq rejected) {
  Remember(rejected);
  untold_.push_back(std::move(rejected));
}

std::vector<RejectedSeq> RejectMemory::RepeatForWelcome(model::Seq settled_seq,
                                                        std::vector<RejectedSeq> stored) {
  told_through_.reset();
  pages_through_ = 0;
  settled_ = settled_seq;
  std::map<model::Seq, RejectedSeq> known;
  const auto add = [&](const RejectedSeq& rejected) {
    if (rejected.seq > settled_seq) known.try_emplace(rejected.seq, rejected);
  };
  for (const RejectedSeq& rejected : remembered_) add(rejected);
  for (const RejectedSeq& rejected : TakeUntold()) add(rejected);
  for (RejectedSeq& rejected : stored) {
    add(rejected);
    Remember(std::move(rejected));
  }
  unconfirmed_ = known.size();
  for (const RejectedSeq& limited : live_limited_) add(limited);
  std::vector<RejectedSeq> again;
  again.reserve(known.size());
  for (auto& [seq, rejected] : known) again.push_back(std::move(rejected));
  return again;
}

bool RejectMemory::AwaitLate(model::Seq settled_seq, model::Seq judged_seq, model::Seq committed) {
  const bool unknown = !complete_ && judged_seq > settled_seq;
  const bool may_lack = left_through_ > settled_seq || committed > settled_seq;
  if (!may_lack && !unknown) return false;
  told_through_ = settled_seq;
  return true;
}

void RejectMemory::AddLate(std::vector<RejectedSeq> stored) {
  if (!told_through_ || pages_through_ > 0) return;
  told_through_.reset();
  complete_ = true;
  const std::size_t before = untold_.size();
  AddUnlessRemembered(std::move(stored));
  unconfirmed_ += untold_.size() - before;
}

void RejectMemory::AddUnlessRemembered(std::vector<RejectedSeq> stored) {
  for (RejectedSeq& rejected : stored) {
    if (std::ranges::binary_search(remembered_, rejected.seq, {}, &RejectedSeq::seq)) continue;
    untold_.push_back(std::move(rejected));
  }
}

void RejectMemory::BeginPages(UnreadRejects unread, std::size_t more) {
  const model::Seq after = std::max(unread.after, settled_);
  if (more == 0 && left_through_ <= after) return;
  told_through_ = after;
  counted_through_ = unread.through;
  // Memory does not keep pages: the next Welcome needs the store as well.
  if (more > 0) left_through_ = std::max(left_through_, unread.through);
  pages_through_ = std::max(left_through_, unread.through);
  // Rejects in memory are in the store too, and were counted.
  const auto in_both = std::ranges::count_if(remembered_, [&](const RejectedSeq& rejected) {
    return rejected.seq > unread.after && rejected.seq <= unread.through;
  });
  unconfirmed_ += more - std::min(more, static_cast<std::size_t>(in_both));
}

std::optional<UnreadRejects> RejectMemory::unread(model::Seq committed) const {
  if (!has_unread()) return std::nullopt;
  if (pages_through_ > counted_through_ && pages_through_ > committed) return std::nullopt;
  return UnreadRejects{.after = *told_through_, .through = pages_through_};
}

std::optional<model::Seq> RejectMemory::judged_through(model::Seq known_judged) const {
  if (!has_unread() || pages_through_ <= known_judged) return std::nullopt;
  return std::max(*told_through_, known_judged);
}

void RejectMemory::AddPage(std::vector<RejectedSeq> page, model::Seq through) {
  if (!has_unread()) return;
  const std::size_t before = untold_.size();
  AddUnlessRemembered(std::move(page));
  unconfirmed_ += static_cast<std::size_t>(std::count_if(
      untold_.begin() + static_cast<std::ptrdiff_t>(before), untold_.end(),
      [this](const RejectedSeq& rejected) { return rejected.seq > counted_through_; }));
  told_through_ = through;
  if (through < pages_through_) return;
  told_through_.reset();
  pages_through_ = 0;
}

}  // namespace uplink::robot
