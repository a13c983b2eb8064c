#include "server/robot/pacing.h"

#include <chrono>
#include <cstddef>

#include "server/robot/limits.h"

namespace uplink::robot {
namespace {

constexpr std::chrono::seconds kPace{1};

/// "joints[3].effort" becomes "joints[].effort".
std::string WithoutIndexes(const std::string& field) {
  std::string path;
  bool in_index = false;
  for (const char c : field) {
    if (c == ']') in_index = false;
    if (!in_index) path += c;
    if (c == '[') in_index = true;
  }
  return path;
}

}  // namespace

bool Pacing::KeepPayload(model::RejectReason reason, SteadyTime now) {
  return payload_kept_[static_cast<std::size_t>(reason)].Take(now, kPace);
}

bool Pacing::MayNotice(const std::string& field, SteadyTime now) {
  std::string path = WithoutIndexes(field);
  // Past the bound all further fields share one slot, so that a robot cannot grow the map.
  if (noticed_.size() >= kNoticeFieldsMax && !noticed_.contains(path)) path.clear();
  return noticed_[path].Take(now, kPace);
}

}  // namespace uplink::robot
