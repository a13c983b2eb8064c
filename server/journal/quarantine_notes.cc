#include "server/journal/quarantine_notes.h"

namespace uplink::journal {

void QuarantineNotes::Note(const std::string& ruri) {
  auto robot = rows_.find(ruri);
  const bool is_new = robot == rows_.end();
  if (is_new) {
    if (rows_.size() >= robots_max_) rows_.clear();
    robot = rows_.emplace(ruri, 0).first;
  }
  ++robot->second;
  if (!is_new && robot->second < kQuarantineRowsPerLook) return;
  // Without room it waits for further rows.
  if (due_.size() >= robots_max_ && !due_.contains(ruri)) return;
  robot->second = 0;
  due_.insert(ruri);
}

std::vector<std::string> QuarantineNotes::First(std::size_t robots) const {
  std::vector<std::string> first;
  for (auto ruri = due_.begin(); ruri != due_.end() && first.size() < robots; ++ruri) {
    first.push_back(*ruri);
  }
  return first;
}

}  // namespace uplink::journal
