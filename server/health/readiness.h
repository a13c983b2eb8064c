#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "schema/base/clock.h"

namespace uplink::health {

/// The journal has a backlog above this share of either bound, or once its oldest record is older
/// than this.
inline constexpr std::size_t kBacklogPercent = 80;
inline constexpr std::chrono::seconds kBacklogAge{60};
/// A fleet is nearly full from this share of limits.robots_max on.
inline constexpr std::size_t kRobotsPercent = 90;
/// Descriptors count as short above this share of what the process may open.
inline constexpr std::size_t kDescriptorsPercent = 90;
/// For how long readiness shows that the store lost acked records, which robots no longer have.
inline constexpr std::chrono::hours kWentBackShown{1};
/// How long before its expiry a certificate is reported.
inline constexpr std::chrono::hours kCertificateNotice{24 * 7};

/// How full something bounded is. A value.
struct Fill {
  std::size_t used = 0;
  std::size_t limit = 0;

  [[nodiscard]] bool above(std::size_t percent) const { return used * 100 > limit * percent; }
  [[nodiscard]] bool reaches(std::size_t percent) const { return used * 100 >= limit * percent; }
};

/// What is wrong at a broker. Nothing is where no broker is read, or another server reads it. A
/// value.
struct BrokerFacts {
  /// This server should read it and is not subscribed, or cannot learn which server should.
  bool away = false;
  /// It refuses topics, or serves them at a lower QoS.
  bool filters = false;
  /// It lost our session a short while ago: what it held for us is gone.
  bool session_lost = false;
  /// Another client uses our id.
  bool id_taken = false;
  /// Its messages at QoS 1 are not read.
  bool unread = false;
  /// Robots that are twins, and how many there may be.
  Fill twins;
};

/// What is wrong with the files that say who comes in. A value.
struct HttpFacts {
  /// Of the certificate of listen.http that is served; nothing: it speaks no TLS.
  std::optional<SystemTime> certificate_expiry{};
  /// Its PEM files on disk are the ones served.
  bool certificate_fits = true;
  /// A file of tokens cannot be read; those that were good last count.
  bool tokens_unread = false;
  /// Authorities' lists (CRL) cannot be used, or are over; those that were good last count.
  bool crl_unread = false;
};

/// All that readiness depends on. A value.
struct ReadinessFacts {
  SystemTime now;
  bool draining = false;
  SystemTime certificate_expiry;
  /// The PEM files on disk are the ones served.
  bool certificate_fits = true;
  HttpFacts http;
  /// What the store decides about who may come in cannot be read, or new robots wait to be judged.
  bool identity_unread = false;
  Fill robots;
  bool store_failing = false;
  /// Acked records may be lost in a power failure, which the operator accepted.
  bool store_unsafe = false;
  /// The store's disk has less left than store.free_min.
  bool store_space_scarce = false;
  /// Within the last hour (kWentBackShown) the store had less than it had confirmed.
  bool store_went_back = false;
  /// Another program has long kept the store from cleaning up.
  bool store_old_snapshot = false;
  /// Nothing vouches for the civil clock, so nothing is deleted.
  bool clock_not_vouched = false;
  /// This process's lease cannot be renewed, or those of others cannot be read.
  bool lease_failing = false;
  /// Liveness::behind.
  bool relay_behind = false;
  /// Changes of shared shapes and objects cannot be read, or not all of them have room.
  bool forward_incomplete = false;
  /// Live state takes more than limits.live_bytes_max, or parts of it were dropped a while ago.
  bool live_state_over = false;
  BrokerFacts broker;
  /// The robots' series have no room in a scrape.
  bool series_left_out = false;
  /// Of the fullest shard of the journal.
  Fill journal_bytes;
  Fill journal_records;
  milliseconds journal_oldest{0};
  Fill descriptors;
};

/// What /readyz says. A value.
struct Readiness {
  /// Why a known robot's new stream would be refused: starting, draining, certificate_expired.
  std::vector<std::string> refuses;
  /// What does not work as it should although streams are taken: words of DegradedWords().
  std::vector<std::string> degraded;

  [[nodiscard]] bool ready() const { return refuses.empty(); }
  /// `refuses`, then `degraded`.
  [[nodiscard]] std::vector<std::string> all() const;
};

/// A word of Readiness::degraded, and whether the facts say it. Immutable.
struct DegradedWord {
  std::string_view word;
  bool (*holds)(const ReadinessFacts&);
};
/// All of them, in their order in `degraded`: the only list. Each is also a value of the label of
/// uplinkd_degraded.
[[nodiscard]] std::span<const DegradedWord> DegradedWords();

/// The readiness before the components exist. A pure function.
[[nodiscard]] Readiness StartingReadiness();
/// A pure function.
[[nodiscard]] Readiness ReadinessOf(const ReadinessFacts& facts);

}  // namespace uplink::health
