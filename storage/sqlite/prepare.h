#pragma once

#include <memory>
#include <string_view>
#include <utility>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "storage/sqlite/database.h"
#include "storage/sqlite/statement.h"

namespace uplink::storage::sqlite {

/// Prepares many statements and remembers the first failure.
class Preparer final {
 public:
  explicit Preparer(Database& database) : database_(database) {}

  void Into(std::unique_ptr<Statement>& statement, std::string_view sql) {
    if (!status_.ok()) return;
    absl::StatusOr<std::unique_ptr<Statement>> prepared = database_.Prepare(sql);
    if (prepared.ok()) {
      statement = *std::move(prepared);
    } else {
      status_ = prepared.status();
    }
  }
  [[nodiscard]] const absl::Status& status() const { return status_; }

 private:
  Database& database_;
  absl::Status status_;
};

}  // namespace uplink::storage::sqlite
