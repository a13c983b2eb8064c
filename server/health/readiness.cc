#include "server/health/readiness.h"

namespace uplink::health {

std::vector<std::string> Readiness::all() const {
  std::vector<std::string> words = refuses;
  words.insert(words.end(), degraded.begin(), degraded.end());
  return words;
}

Readiness StartingReadiness() {
  Readiness readiness;
  readiness.refuses.emplace_back("starting");
  return readiness;
}

Readiness ReadinessOf(const ReadinessFacts& facts) {
  Readiness readiness;
  if (facts.draining) readiness.refuses.emplace_back("draining");
  const bool expired = facts.certificate_expiry <= facts.now;
  if (expired) readiness.refuses.emplace_back("certificate_expired");

  if (facts.store_failing) readiness.degraded.emplace_back("store");
  if (facts.store_unsafe) readiness.degraded.emplace_back("store_unsafe");
  if (facts.store_old_snapshot) readiness.degraded.emplace_back("store_old_snapshot");
  if (facts.clock_not_vouched) readiness.degraded.emplace_back("clock");
  if (facts.lease_failing) readiness.degraded.emplace_back("lease");
  if (facts.journal_bytes.above(kBacklogPercent) || facts.journal_records.above(kBacklogPercent) ||
      facts.journal_oldest > kBacklogAge) {
    readiness.degraded.emplace_back("journal_backlog");
  }
  if (facts.relay_behind) readiness.degraded.emplace_back("relay_behind");
  if (facts.robots.reaches(kRobotsPercent)) readiness.degraded.emplace_back("robots_max");
  if (!expired && facts.certificate_expiry - facts.now < kCertificateNotice) {
    readiness.degraded.emplace_back("certificate_expiring");
  }
  if (!facts.certificate_fits) readiness.degraded.emplace_back("certificate_mismatch");
  if (facts.descriptors.above(kDescriptorsPercent)) readiness.degraded.emplace_back("descriptors");
  return readiness;
}

}  // namespace uplink::health
