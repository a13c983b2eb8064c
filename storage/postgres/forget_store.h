#pragma once

#include <memory>

#include "storage/forget_store.h"
#include "storage/postgres/forget_requests.h"
#include "storage/postgres/robot_removal.h"
#include "storage/postgres/store.h"

namespace uplink::storage::postgres {

/// What it takes to forget a robot in a PostgreSQL database: one connection for both.
class PostgresForgetStore final : public ForgetStore {
 public:
  /// As OwnConnection::Make.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<PostgresForgetStore>> Make(
      const StoreOptions& options, const Clock& clock);
  ~PostgresForgetStore() override;
  PostgresForgetStore(const PostgresForgetStore&) = delete;
  PostgresForgetStore& operator=(const PostgresForgetStore&) = delete;

  [[nodiscard]] RobotRemoval& removal() override { return removal_; }
  [[nodiscard]] ForgetRequests& requests() override { return requests_; }

 private:
  explicit PostgresForgetStore(std::unique_ptr<OwnConnection> connection);

  const std::unique_ptr<OwnConnection> connection_;
  PostgresRobotRemoval removal_;
  PostgresForgetRequests requests_;
};

}  // namespace uplink::storage::postgres
