#pragma once

#include <memory>

#include <absl/status/statusor.h>

#include "storage/change_signal.h"
#include "storage/postgres/store.h"

namespace uplink::storage::postgres {

/// LISTEN and NOTIFY, over a connection of their own.
///
/// A NOTIFY is a transaction of its own and never part of a batch's: PostgreSQL lets those that
/// notify commit one after the other, in the whole cluster.
///
/// Errors:  as in ChangeSignal; kUnavailable while the server is away, and every call tries again:
///          the caller pauses (schema/base/backoff.h).
/// Limits:  a call to the server takes at most kSignalCallMax; connecting, that for each place.
/// Thread:  as in ChangeSignal.
class PostgresChangeSignal final : public ChangeSignal {
 public:
  /// Does not connect. Of the options: the URL, the password, the timeouts where they are shorter.
  /// `clock` must outlive this.
  ///
  /// Errors: kInvalidArgument for the URL; kResourceExhausted if there is no descriptor.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<PostgresChangeSignal>> Make(
      const StoreOptions& options, const Clock& clock);
  ~PostgresChangeSignal() override;
  PostgresChangeSignal(const PostgresChangeSignal&) = delete;
  PostgresChangeSignal& operator=(const PostgresChangeSignal&) = delete;

  void Tell() override;
  [[nodiscard]] absl::StatusOr<bool> Wait(milliseconds most) override;
  void End() override;

 private:
  struct Impl;
  explicit PostgresChangeSignal(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// A stop waits for a call that is under way, and nothing is lost by giving one up.
inline constexpr milliseconds kSignalCallMax{2'000};

}  // namespace uplink::storage::postgres
