#include "server/robot/reject_memory.h"

#include <algorithm>
#include <map>

#include "server/robot/limits.h"

namespace uplink::robot {

void RejectMemory::Remember(RejectedSeq rejected) {
  if (rejected.rejection.reason == model::RejectReason::kRateLimited) {
    return RememberLimited(std::move(rejected));
  }
  // It was counted when it came first, and would leave at once again.
  if (rejected.seq <= left_through_) return;
  const auto at = std::ranges::lower_bound(remembered_, rejected.seq, {}, &RejectedSeq::seq);
  if (at != remembered_.end() && at->seq == rejected.seq) return;
  remembered_.insert(at, std::move(rejected));
  ++unconfirmed_;
  if (remembered_.size() <= kRejectsRememberedMax) return;
  left_through_ = remembered_.front().seq;
  remembered_.pop_front();
}

void RejectMemory::RememberLimited(RejectedSeq limited) {
  limited_.push_back(std::move(limited));
  if (limited_.size() > kRejectsRememberedMax) limited_.pop_front();
}

void RejectMemory::AddUntold(RejectedSeq rejected) {
  Remember(rejected);
  untold_.push_back(std::move(rejected));
}

std::vector<RejectedSeq> RejectMemory::TellAgain(model::Seq settled_seq,
                                                 std::vector<RejectedSeq> stored) {
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
  for (const RejectedSeq& limited : limited_) add(limited);
  std::vector<RejectedSeq> again;
  again.reserve(known.size());
  for (auto& [seq, rejected] : known) again.push_back(std::move(rejected));
  return again;
}

}  // namespace uplink::robot
