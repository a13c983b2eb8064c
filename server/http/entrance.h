#pragma once

#include <atomic>
#include <utility>

#include "server/http/known_hosts.h"
#include "server/http/message.h"
#include "server/http/site.h"

namespace uplink::http {

/// What a request meets before the site:
/// - one of HTTP/1.1 names its host; 400 else. That of a target in absolute-form takes the place of
///   the header's (RFC 9112, 3.2.2);
/// - data are shown under known hosts alone (421), probes and scrapes under any;
/// - on a connection that is kept for probes and scrapes, others get 503;
/// - while the server starts there is no site: /livez says that the process lives, /readyz that it
///   is `starting`, a wrong request to either, or a wrong method, is refused as later, and
///   everything else is 503.
///
/// Thread: thread-safe. The site outlives it.
class Entrance final {
 public:
  explicit Entrance(KnownHosts hosts = KnownHosts()) : hosts_(std::move(hosts)) {}
  Entrance(const Entrance&) = delete;
  Entrance& operator=(const Entrance&) = delete;

  /// The server has started: the site answers from now on.
  void Open(const Site& site) { site_.store(&site); }

  /// As Site::Resolve.
  [[nodiscard]] Resolved Resolve(Request request) const;

 private:
  const KnownHosts hosts_;
  std::atomic<const Site*> site_{nullptr};
};

}  // namespace uplink::http
