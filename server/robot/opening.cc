#include "server/robot/opening.h"

#include <utility>

namespace uplink::robot {

std::uint64_t Opening::Ask() {
  answer_.reset();
  wanted_ = true;
  return ++open_id_;
}

bool Opening::Answer(std::uint64_t open_id, const storage::OpenResult& result) {
  if (open_id != open_id_) return false;
  if (wanted_) answer_ = result;
  return true;
}

bool Opening::answered(std::uint64_t open_id) const {
  return open_id == open_id_ && answer_.has_value();
}

std::optional<storage::OpenResult> Opening::Take(std::uint64_t open_id) {
  wanted_ = false;
  if (open_id != open_id_) return std::nullopt;
  return std::exchange(answer_, std::nullopt);
}

}  // namespace uplink::robot
