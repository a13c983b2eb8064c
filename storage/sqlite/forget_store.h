#pragma once

#include <memory>
#include <string>

#include "storage/forget_store.h"
#include "storage/sqlite/forget_requests.h"
#include "storage/sqlite/open_beside.h"
#include "storage/sqlite/robot_removal.h"

namespace uplink::storage::sqlite {

/// What it takes to forget a robot in an SQLite file, over a connection beside the store's writer.
class SqliteForgetStore final : public ForgetStore {
 public:
  /// As OpenBeside.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<SqliteForgetStore>> Open(
      const std::string& path, DamagePtr damage = nullptr);
  SqliteForgetStore(const SqliteForgetStore&) = delete;
  SqliteForgetStore& operator=(const SqliteForgetStore&) = delete;

  [[nodiscard]] RobotRemoval& removal() override { return *removal_; }
  [[nodiscard]] ForgetRequests& requests() override { return *requests_; }

 private:
  SqliteForgetStore() = default;

  Beside beside_;
  std::unique_ptr<SqliteRobotRemoval> removal_;
  std::unique_ptr<SqliteForgetRequests> requests_;
};

}  // namespace uplink::storage::sqlite
