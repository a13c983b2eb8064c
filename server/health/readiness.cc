#include "server/health/readiness.h"

#include <array>

namespace uplink::health {
namespace {

using Facts = ReadinessFacts;

bool Expired(const Facts& facts) { return facts.certificate_expiry <= facts.now; }

bool HasBacklog(const Facts& facts) {
  return facts.journal_bytes.above(kBacklogPercent) ||
         facts.journal_records.above(kBacklogPercent) || facts.journal_oldest > kBacklogAge;
}

bool Expires(const Facts& facts) {
  const auto& http = facts.http.certificate_expiry;
  return (!Expired(facts) && facts.certificate_expiry - facts.now < kCertificateNotice) ||
         (http && *http - facts.now < kCertificateNotice);
}

constexpr auto kDegradedWords = std::to_array<DegradedWord>({
    {"store", [](const Facts& facts) { return facts.store_failing; }},
    {"store_unsafe", [](const Facts& facts) { return facts.store_unsafe; }},
    {"store_space", [](const Facts& facts) { return facts.store_space_scarce; }},
    {"store_went_back", [](const Facts& facts) { return facts.store_went_back; }},
    {"store_old_snapshot", [](const Facts& facts) { return facts.store_old_snapshot; }},
    {"clock", [](const Facts& facts) { return facts.clock_not_vouched; }},
    {"lease", [](const Facts& facts) { return facts.lease_failing; }},
    {"journal_backlog", HasBacklog},
    {"relay_behind", [](const Facts& facts) { return facts.relay_behind; }},
    {"forward", [](const Facts& facts) { return facts.forward_incomplete; }},
    {"mqtt_away", [](const Facts& facts) { return facts.broker.away; }},
    {"mqtt_filters", [](const Facts& facts) { return facts.broker.filters; }},
    {"mqtt_session_lost", [](const Facts& facts) { return facts.broker.session_lost; }},
    {"mqtt_id_taken", [](const Facts& facts) { return facts.broker.id_taken; }},
    {"mqtt_unread", [](const Facts& facts) { return facts.broker.unread; }},
    {"robots_max", [](const Facts& facts) { return facts.robots.reaches(kRobotsPercent); }},
    {"twins_max",
     [](const Facts& facts) {
       return facts.broker.twins.limit > 0 && facts.broker.twins.reaches(kRobotsPercent);
     }},
    {"live_bytes_max", [](const Facts& facts) { return facts.live_state_over; }},
    {"series_max", [](const Facts& facts) { return facts.series_left_out; }},
    {"certificate_expiring", Expires},
    {"certificate_mismatch",
     [](const Facts& facts) { return !facts.certificate_fits || !facts.http.certificate_fits; }},
    {"tokens_unread", [](const Facts& facts) { return facts.http.tokens_unread; }},
    {"crl_unread", [](const Facts& facts) { return facts.http.crl_unread; }},
    {"identity", [](const Facts& facts) { return facts.identity_unread; }},
    {"descriptors",
     [](const Facts& facts) { return facts.descriptors.above(kDescriptorsPercent); }},
});

}  // namespace

std::span<const DegradedWord> DegradedWords() { return kDegradedWords; }

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
  if (Expired(facts)) readiness.refuses.emplace_back("certificate_expired");

  for (const DegradedWord& degraded : kDegradedWords) {
    if (degraded.holds(facts)) readiness.degraded.emplace_back(degraded.word);
  }
  return readiness;
}

}  // namespace uplink::health
