#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <unordered_map>

#include "metrics/ledger.h"
#include "schema/base/clock.h"
#include "schema/model/record.h"
#include "schema/model/rejection.h"
#include "server/limits/recent_times.h"
#include "server/limits/token_bucket.h"

namespace uplink::robot {

/// Messages of one robot per second, by variant; no rate means unlimited. A value.
using RateTable = std::array<limits::BucketSize, model::kVariants>;

/// Limited ids of shapes, and of objects, at a time. Past it every upsert of the kind is limited,
/// so that order is kept.
inline constexpr std::size_t kLimitedIdsMax = 4'096;

/// The rejection of a message over this rate.
[[nodiscard]] model::Rejection RateLimited(const limits::BucketSize& size);

/// How many messages one robot may send, by variant (validation rules: rates).
///
/// A limited shape or object also limits later upserts of its id until it may come again; otherwise
/// an older one that is sent again could replace a newer one. A deletion takes a token and is never
/// limited, since a lost deletion would leave a ghost.
///
/// All kinds of telemetry share one bucket; past it a message is superseded, not rejected.
///
/// Allocates nothing while nothing is limited. Bounds: kLimitedIdsMax.
/// Thread: Limit, WouldLimit, BeginStream and the functions of telemetry by the robot's stream; it
///         has one at a time. The rest by any.
class Rates final {
 public:
  /// Takes the message's token and returns empty; or returns how long until it may come again.
  [[nodiscard]] std::optional<milliseconds> Limit(const model::Body& body, const RateTable& table,
                                                  SteadyTime now);
  /// Whether Limit would limit it now. Takes nothing and counts nothing.
  [[nodiscard]] bool WouldLimit(const model::Body& body, const RateTable& table, SteadyTime now) {
    return LimitedNow(body, table, now).has_value();
  }
  /// When a telemetry message (metrics::IsTelemetry) may be decoded; at or before `now` if it may
  /// be now.
  [[nodiscard]] SteadyTime TelemetryPassesAt(const limits::BucketSize& size, SteadyTime now) const {
    return telemetry_.PassesAt(1, size, now);
  }
  /// Takes a token for one that is decoded, whatever TelemetryPassesAt returned.
  void TakeTelemetry(const limits::BucketSize& size, SteadyTime now) {
    telemetry_.Take(1, size, now);
  }
  /// Counts one of this kind that is superseded for the rate.
  void CountOverRate(std::size_t kind) { limited_[kind].fetch_add(1, std::memory_order_relaxed); }
  /// Resets the counts.
  void BeginStream();

  /// Messages that were limited since the stream began.
  [[nodiscard]] std::uint64_t limited(model::Variant variant) const {
    return limited(static_cast<std::size_t>(variant));
  }
  /// The same by a kind of the ledger (metrics::kKinds).
  [[nodiscard]] std::uint64_t limited(std::size_t kind) const {
    return limited_[kind].load(std::memory_order_relaxed);
  }

 private:
  /// Until when each id is limited, by its hash; ids with the same hash are limited together.
  class LimitedIds final {
   public:
    /// Until when the id is limited; empty if it is not.
    [[nodiscard]] std::optional<SteadyTime> Until(std::size_t id, SteadyTime now);
    void Add(std::size_t id, SteadyTime until);
    [[nodiscard]] std::size_t size() const { return until_.size(); }

   private:
    std::unordered_map<std::size_t, SteadyTime> until_;
    /// The latest of them.
    SteadyTime last_{};
    /// Paces the removal of ids that are no longer limited.
    limits::RecentTimes<1> looks_;
  };

  /// A message that is limited. A value.
  struct Limited {
    SteadyTime until;
    /// For an upsert whose id was not limited before: it is from now on.
    std::optional<std::size_t> new_id{};
  };
  /// Whether the message is limited by its id or by the bucket. Takes nothing and counts nothing.
  [[nodiscard]] std::optional<Limited> LimitedNow(const model::Body& body, const RateTable& table,
                                                  SteadyTime now);

  std::array<limits::TokenBucket, model::kVariants> buckets_;
  limits::TokenBucket telemetry_;
  /// By variant, for shapes and objects; made when the first id is limited.
  using IdsByVariant = std::unordered_map<std::size_t, LimitedIds>;
  std::unique_ptr<IdsByVariant> ids_;
  std::array<std::atomic<std::uint64_t>, metrics::kKinds> limited_{};
};

}  // namespace uplink::robot
