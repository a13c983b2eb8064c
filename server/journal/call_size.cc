#include "server/journal/call_size.h"

#include <algorithm>

namespace uplink::journal {

bool CallSize::Failed(std::size_t held) {
  in_a_row_ = std::max(in_a_row_, 0) + 1;
  if (in_a_row_ < rule_.failures_to_halve || held < rule_.halved_from) return false;
  in_a_row_ = 0;
  now_ = std::max<std::size_t>(held / 2, 1);
  return true;
}

void CallSize::Succeeded() {
  if (now_ == rule_.most) {
    in_a_row_ = 0;
    return;
  }
  in_a_row_ = std::min(in_a_row_, 0) - 1;
  if (in_a_row_ > -rule_.successes_to_double) return;
  in_a_row_ = 0;
  now_ = std::min(rule_.most, 2 * now_);
}

}  // namespace uplink::journal
