#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "server/http/guard.h"
#include "server/http/known_hosts.h"
#include "server/http/message.h"
#include "server/http/peer.h"
#include "server/http/site.h"

namespace uplink::http {

/// What a request meets before the site:
/// - on listen.metrics only the paths of probes and scrapes exist (others: 404), under any host;
/// - one of HTTP/1.1 must name its host, or it gets 400. The host of a target in absolute-form
///   replaces the header's (RFC 9112, 3.2.2);
/// - data are shown under known hosts alone (421), scrapes too if that is set, probes under any;
/// - data are shown to no page of another site (403): not if the browser says that one asks
///   (Sec-Fetch-Site), nor if its Origin is foreign;
/// - a command of a page of another port is refused too (403);
/// - a token in the address gets 400;
/// - on a connection that is kept for probes and scrapes, others get 503;
/// - the guard says who asks, and whether it may (401, 403, 429);
/// - while the server starts there is no site: /livez says that the process lives, /readyz that it
///   is `starting`, a wrong request to either, or a wrong method, is refused as later, and
///   everything else is 503.
///
/// Thread: thread-safe. The site outlives it.
class Entrance final {
 public:
  /// What is shown under known hosts alone.
  enum class Covered : std::uint8_t { kData, kDataAndScrapes };

  /// Null: every caller is identity::LocalCaller. The guard outlives it.
  explicit Entrance(KnownHosts hosts = KnownHosts(), Covered covered = Covered::kData,
                    Guard* guard = nullptr)
      : hosts_(std::make_shared<const KnownHosts>(std::move(hosts))),
        covered_(covered),
        guard_(guard) {}
  Entrance(const Entrance&) = delete;
  Entrance& operator=(const Entrance&) = delete;

  /// The server has started: the site answers from now on.
  void Open(const Site& site) { site_.store(&site); }

  /// The names count from the next request on.
  void SetHosts(KnownHosts hosts) {
    auto next = std::make_shared<const KnownHosts>(std::move(hosts));
    const std::lock_guard lock(mutex_);
    hosts_ = std::move(next);
  }

  /// A connection was not served, for a reason that shows before its first request.
  void NoteDenied(Denied why, const Peer& peer) const {
    if (guard_ != nullptr) guard_->NoteDenied(why, peer.source, peer.text);
  }

  /// As Site::Resolve.
  [[nodiscard]] Resolved Resolve(Request request) const;

 private:
  /// The answer for what is not shown, if it is not.
  [[nodiscard]] std::optional<Response> Refusal(const Request& request, RouteId route) const;

  [[nodiscard]] std::shared_ptr<const KnownHosts> hosts() const {
    const std::lock_guard lock(mutex_);
    return hosts_;
  }

  mutable std::mutex mutex_;
  std::shared_ptr<const KnownHosts> hosts_;
  const Covered covered_;
  Guard* const guard_;
  std::atomic<const Site*> site_{nullptr};
};

}  // namespace uplink::http
