#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/postgres/link/connection.h"

namespace uplink::storage::postgres {

/// What holds back cleaning in our database: row versions that were deleted by the transaction
/// `oldest` or a later one stay. Transactions have the server's numbers, which wrap.
struct Horizon {
  /// The number that the next transaction gets, or a smaller one that is not done yet.
  std::uint32_t next = 0;
  /// The oldest that a transaction, a snapshot, a replication slot or a prepared transaction needs;
  /// nothing if there is none.
  std::optional<std::uint32_t> oldest;
};

/// Asks for it. Any role may: the times of others' transactions it may not see.
///
/// Errors: of Connection::Run.
[[nodiscard]] absl::StatusOr<Horizon> ReadHorizon(Connection& connection);

/// How long dead rows have been kept, from horizons that were read one after the other: since
/// the first of them whose next transaction was newer than what is the oldest now. Confined to one
/// thread at a time.
class HorizonAge final {
 public:
  /// Horizons that are remembered; beyond that every second one is forgotten, so an age is too
  /// young by at most 1/64 of the longest that there was.
  static constexpr std::size_t kSeenMax = 256;

  /// The age as of `now`, in steps of how often this is called; zero if nothing is kept that
  /// was not there at the first call.
  milliseconds Note(const Horizon& horizon, SteadyTime now);

 private:
  struct Seen {
    SteadyTime at;
    std::uint32_t next = 0;
  };
  [[nodiscard]] bool IsDue(const Horizon& horizon, SteadyTime now) const;
  /// Forgets every second one, and has later ones come as rarely.
  void Thin();

  /// Oldest first, each with a greater number.
  std::deque<Seen> seen_;
  SteadyTime::duration spacing_{};
};

}  // namespace uplink::storage::postgres
