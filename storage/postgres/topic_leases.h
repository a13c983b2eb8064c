#pragma once

#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "storage/postgres/store.h"
#include "storage/topic_leases.h"

namespace uplink::storage::postgres {

/// Leases on topics in a PostgreSQL database, over a connection of their own.
///
/// Errors:  as in TopicLeases; kUnavailable while the server is away, and every call tries again.
/// Thread:  as in TopicLeases.
class PostgresTopicLeases final : public TopicLeases {
 public:
  /// Does not connect. Of the options: the URL, the password, the timeouts, the process. `clock`
  /// must outlive this.
  ///
  /// Errors: kInvalidArgument for the URL.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<PostgresTopicLeases>> Make(
      const StoreOptions& options, const Clock& clock);
  ~PostgresTopicLeases() override;
  PostgresTopicLeases(const PostgresTopicLeases&) = delete;
  PostgresTopicLeases& operator=(const PostgresTopicLeases&) = delete;

  [[nodiscard]] absl::StatusOr<std::optional<Epoch>> Take(const TakeRequest& request) override;
  [[nodiscard]] absl::Status Release(std::string_view client_id) override;
  [[nodiscard]] absl::StatusOr<std::vector<TopicLease>> Read() override;
  [[nodiscard]] absl::StatusOr<DeliveryMemory> MemoryOf(std::string_view client_id) override;
  [[nodiscard]] std::uint64_t connections() const override;

 private:
  struct Impl;
  explicit PostgresTopicLeases(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace uplink::storage::postgres
