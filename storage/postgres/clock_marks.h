#pragma once

#include <memory>

#include "storage/clock_marks.h"
#include "storage/postgres/store.h"

namespace uplink::storage::postgres {

/// The mark in a PostgreSQL database, with the database's own clock.
///
/// Errors:  as in ClockMarks; kUnavailable while the server is away, and every call tries again.
/// Thread:  as in ClockMarks.
class PostgresClockMarks final : public ClockMarks {
 public:
  /// Does not connect. Of the options: the URL, the password, the timeouts. `clock` must outlive
  /// this.
  ///
  /// Errors: kInvalidArgument for the URL.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<PostgresClockMarks>> Make(
      const StoreOptions& options, const Clock& clock);
  ~PostgresClockMarks() override;
  PostgresClockMarks(const PostgresClockMarks&) = delete;
  PostgresClockMarks& operator=(const PostgresClockMarks&) = delete;

  [[nodiscard]] absl::StatusOr<ClockReading> Read() override;
  [[nodiscard]] absl::Status Set(SystemTime mark) override;
  [[nodiscard]] absl::Status SetIfEmpty(SystemTime mark) override;

 private:
  struct Impl;
  explicit PostgresClockMarks(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace uplink::storage::postgres
