#include "server/robot/open_answer.h"

#include <algorithm>
#include <utility>

namespace uplink::robot {

std::vector<RejectedSeq> RejectedOf(std::vector<storage::StoredReject> stored) {
  std::vector<RejectedSeq> rejects;
  rejects.reserve(stored.size());
  for (storage::StoredReject& reject : stored) {
    rejects.push_back(FromStore(reject.seq, std::move(reject.rejection)));
  }
  return rejects;
}

StoredSession StoredOf(std::optional<storage::OpenResult> answer) {
  StoredSession stored;
  if (!answer) return stored;
  stored.through = answer->cursor;
  stored.more = std::max(answer->rejects_total, answer->rejects.size()) - answer->rejects.size();
  stored.rejects = RejectedOf(std::move(answer->rejects));
  stored.unread = {stored.more > 0 ? stored.rejects.back().seq : stored.through, stored.through};
  return stored;
}

std::uint64_t OpenAnswer::Ask() {
  answer_.reset();
  wanted_ = true;
  late_ = false;
  return ++open_id_;
}

bool OpenAnswer::Answer(std::uint64_t open_id, const storage::OpenResult& result) {
  if (open_id != open_id_) return false;
  if (wanted_) answer_ = result;
  return true;
}

bool OpenAnswer::answered(std::uint64_t open_id) const {
  return open_id == open_id_ && answer_.has_value();
}

std::optional<storage::OpenResult> OpenAnswer::Take(std::uint64_t open_id) {
  wanted_ = late_ = false;
  if (open_id != open_id_) return std::nullopt;
  return std::exchange(answer_, std::nullopt);
}

}  // namespace uplink::robot
