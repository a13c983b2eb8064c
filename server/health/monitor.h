#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>

#include "schema/base/clock.h"
#include "server/fleet/fleet.h"
#include "server/fleet/liveness.h"
#include "server/health/readiness.h"
#include "server/journal/shards.h"
#include "server/session/probe.h"
#include "storage/clock_trust.h"
#include "storage/store_facts.h"

namespace uplink::health {

/// Whether the process lives and may get traffic, from the components themselves. Never waits.
/// Thread-safe.
class Monitor final {
 public:
  struct Sources {
    const Clock& clock;
    const fleet::Fleet& fleet;
    const journal::Shards& journals;
    const journal::JournalProbe& journal_probe;
    const session::SessionProbe& sessions;
    /// Of all journals together.
    journal::JournalLimits journal_limits;
    /// At the start; NoteCertificate replaces it after a rotation.
    SystemTime certificate_expiry;
    /// As they are now.
    std::function<storage::StoreFacts()> store_facts = [] { return storage::StoreFacts(); };
    std::function<bool()> lease_failing = [] { return false; };
    /// Whether the store's robots could not be read yet.
    std::function<bool()> robots_unread = [] { return false; };
    /// Whether something vouches for the civil clock; null: something does.
    const storage::ClockTrust* clock_trust = nullptr;
    std::function<bool()> store_space_scarce = [] { return false; };
    std::function<bool()> forward_incomplete = [] { return false; };
    std::function<bool()> live_state_over = [] { return false; };
    std::function<BrokerFacts()> broker = [] { return BrokerFacts(); };
    std::function<bool()> series_left_out = [] { return false; };
    std::function<HttpFacts()> http = [] { return HttpFacts(); };
  };
  explicit Monitor(const Sources& sources);

  [[nodiscard]] fleet::Liveness& liveness() { return liveness_; }
  [[nodiscard]] Readiness readiness() const;
  [[nodiscard]] SystemTime certificate_expiry() const {
    return FromUnixMs(certificate_expiry_ms_.load());
  }
  /// Of listen.http; nothing: it speaks no TLS.
  [[nodiscard]] std::optional<SystemTime> http_certificate_expiry() const {
    return sources_.http().certificate_expiry;
  }
  /// The expiry of the certificate that is served, and whether that is from the files on disk.
  /// Returns whether the second has changed. One thread.
  bool NoteCertificate(SystemTime expiry, bool files_fit) {
    certificate_expiry_ms_.store(UnixMs(expiry));
    return certificate_fits_.exchange(files_fit) != files_fit;
  }
  /// New streams are refused from now on.
  void BeginDrain() { draining_.store(true); }
  [[nodiscard]] bool draining() const { return draining_.load(); }

 private:
  const Sources sources_;
  fleet::Liveness liveness_;
  std::atomic<std::int64_t> certificate_expiry_ms_;
  std::atomic<bool> certificate_fits_{true};
  std::atomic<bool> draining_{false};
};

}  // namespace uplink::health
