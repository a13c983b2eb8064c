#pragma once

#include <cstdint>
#include <memory>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/access_store.h"
#include "storage/change_signal.h"
#include "storage/clock_marks.h"
#include "storage/forget_store.h"
#include "storage/leases.h"
#include "storage/postgres/store.h"
#include "storage/shared_items.h"
#include "storage/topic_leases.h"

// What a process does with a PostgreSQL database beside its writers and its reader, each over a
// connection of its own: a commit that takes long keeps none of these waiting, and none of these a
// commit. None connects before its first call. Of the options: the URL, the password, the process,
// the timeouts. `clock` must outlive what is made.
//
// Errors: kInvalidArgument for the URL. Of the calls, as of the interface; kUnavailable while the
//         server is away, and every call tries again.
// Thread: as of the interface.
namespace uplink::storage::postgres {

[[nodiscard]] absl::StatusOr<std::unique_ptr<Leases>> MakeLeases(const StoreOptions& options,
                                                                 const Clock& clock);

[[nodiscard]] absl::StatusOr<std::unique_ptr<TopicLeases>> MakeTopicLeases(
    const StoreOptions& options, const Clock& clock);

/// With the database's own clock.
[[nodiscard]] absl::StatusOr<std::unique_ptr<ClockMarks>> MakeClockMarks(
    const StoreOptions& options, const Clock& clock);

/// How long AccessStore::Version may take over a connection that stood before, and the sign of life
/// of one before a change.
inline constexpr milliseconds kAccessLookMax{500};
/// Of a server that follows decisions of operators: how long a page of rows may take, and
/// connecting to each place.
inline constexpr milliseconds kAccessReadMax{5'000};
inline constexpr milliseconds kAccessConnectMax{2'000};
/// The same options for a store that follows them, so that a network that passes nothing delays a
/// revocation little once it does.
[[nodiscard]] StoreOptions FollowingAccess(StoreOptions options);

/// A commit that changes a version wakes those who listen to Channel::kAccess.
[[nodiscard]] absl::StatusOr<std::unique_ptr<AccessStore>> MakeAccessStore(
    const StoreOptions& options, const Clock& clock);

/// Requests go by the time of the database.
[[nodiscard]] absl::StatusOr<std::unique_ptr<ForgetStore>> MakeForgetStore(
    const StoreOptions& options, const Clock& clock);

[[nodiscard]] absl::StatusOr<std::unique_ptr<SharedItems>> MakeSharedItems(
    const StoreOptions& options, const Clock& clock);

/// How long a call of a change signal to the server may take, and connecting to each place: a stop
/// waits for one that is under way, and nothing is lost by giving one up.
inline constexpr milliseconds kSignalCallMax{2'000};

/// What a change signal is of.
enum class Channel : std::uint8_t {
  /// Shared items.
  kItems,
  /// Versions of AccessStore. Its writes tell it themselves, also those of other programs.
  kAccess,
};

/// LISTEN and NOTIFY. A NOTIFY is a transaction of its own and never part of a batch's: PostgreSQL
/// lets those that notify commit one after the other, in the whole cluster.
///
/// Errors: kResourceExhausted as well, if there is no descriptor. Of a call: the caller pauses
///         (schema/base/backoff.h).
[[nodiscard]] absl::StatusOr<std::unique_ptr<ChangeSignal>> MakeChangeSignal(
    const StoreOptions& options, const Clock& clock, Channel channel = Channel::kItems);

}  // namespace uplink::storage::postgres
