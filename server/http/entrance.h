#pragma once

#include <atomic>

#include "server/http/message.h"
#include "server/http/site.h"

namespace uplink::http {

/// What a request meets before the site: while the server starts there is none, and then /livez
/// says that the process lives, /readyz that it is `starting`, and everything else is 503.
///
/// Thread: thread-safe. The site outlives it.
class Entrance final {
 public:
  Entrance() = default;
  Entrance(const Entrance&) = delete;
  Entrance& operator=(const Entrance&) = delete;

  /// The server has started: the site answers from now on.
  void Open(const Site& site) { site_.store(&site); }

  /// As Site::Resolve.
  [[nodiscard]] Resolved Resolve(const Request& request) const;

 private:
  std::atomic<const Site*> site_{nullptr};
};

}  // namespace uplink::http
