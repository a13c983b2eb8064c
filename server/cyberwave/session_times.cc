#include "server/cyberwave/session_times.h"

#include <algorithm>
#include <functional>

namespace uplink::cyberwave {

SessionNumber SessionNumberOf(std::string_view session_id) {
  return std::hash<std::string_view>()(session_id);
}

bool SessionTimes::Take(SessionNumber session, std::int64_t timestamp_us) {
  if (timestamp_us == 0) return true;
  auto* const end = last_.data() + size_;
  auto* found = std::find_if(last_.data(), end,
                             [session](const Last& last) { return last.session == session; });
  if (found != end && timestamp_us < found->timestamp_us) return false;
  if (found == end) {
    if (size_ < last_.size()) {
      ++size_;
    } else {
      --found;  // the one heard least recently
    }
  }
  std::move_backward(last_.data(), found, found + 1);
  last_.front() = {.session = session, .timestamp_us = timestamp_us};
  return true;
}

}  // namespace uplink::cyberwave
