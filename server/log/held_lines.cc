#include "server/log/held_lines.h"

#include <utility>

namespace uplink::log {

void HeldLines::Begin() {
  const std::scoped_lock lock(mutex_);
  keeps_ = true;
}

bool HeldLines::Add(std::string& line) {
  const std::scoped_lock lock(mutex_);
  if (!keeps_ || lines_.size() >= kLinesMax) return false;
  lines_.push_back(std::move(line));
  return true;
}

std::vector<std::string> HeldLines::Take() {
  const std::scoped_lock lock(mutex_);
  keeps_ = false;
  return std::exchange(lines_, {});
}

}  // namespace uplink::log
