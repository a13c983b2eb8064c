#include "server/forward/shares.h"

namespace uplink::forward {

bool Shares::Resize(const std::string& ruri, std::size_t before, std::size_t after) {
  const auto place = robots_.try_emplace(ruri, 0).first;
  const std::size_t robot = place->second - before + after;
  const std::size_t all = bytes_.load() - before + after;
  const bool grows = after > before;
  const bool fits = !grows || (robot <= limits_.robot_bytes_max && all <= limits_.bytes_max);
  if (fits) {
    place->second = robot;
    bytes_ = all;
  }
  if (place->second == 0) robots_.erase(place);
  return fits;
}

}  // namespace uplink::forward
