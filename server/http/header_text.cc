#include "server/http/header_text.h"

#include <chrono>
#include <ctime>

#include <fmt/chrono.h>

namespace uplink::http {

std::string ImfFixdate(SystemTime time) {
  const auto seconds = std::chrono::floor<std::chrono::seconds>(time).time_since_epoch();
  return fmt::format("{:%a, %d %b %Y %H:%M:%S GMT}",
                     fmt::gmtime(static_cast<std::time_t>(seconds.count())));
}

}  // namespace uplink::http
