#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "storage/leases.h"
#include "storage/postgres/store.h"

namespace uplink::storage::postgres {

/// Leases in a PostgreSQL database, over a connection of their own: a commit that takes long keeps
/// no lease waiting.
///
/// Errors:  as in Leases; kUnavailable while the server is away, and every call tries again.
/// Thread:  as in Leases.
class PostgresLeases final : public Leases {
 public:
  /// Does not connect. Of the options: the URL, the password, the process, the timeouts. `clock`
  /// must outlive this.
  ///
  /// Errors: kInvalidArgument for the URL.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<PostgresLeases>> Make(
      const StoreOptions& options, const Clock& clock);
  ~PostgresLeases() override;
  PostgresLeases(const PostgresLeases&) = delete;
  PostgresLeases& operator=(const PostgresLeases&) = delete;

  [[nodiscard]] std::string ServerRun() const override;
  [[nodiscard]] absl::Status Renew(const ProcessCard& card) override;
  [[nodiscard]] absl::Status Release() override;
  [[nodiscard]] absl::StatusOr<std::vector<Lease>> Read() override;
  [[nodiscard]] absl::StatusOr<std::vector<ForeignRobot>> RobotsOfOthers(
      std::string_view after) override;

 private:
  struct Impl;
  explicit PostgresLeases(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace uplink::storage::postgres
