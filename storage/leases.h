#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "schema/model/ids.h"
#include "storage/epoch.h"
#include "storage/identity.h"
#include "storage/live_row.h"
#include "storage/presence.h"

namespace uplink::storage {

/// Rows of one answer of Leases::RobotsOfOthers, and leases of one of Read.
inline constexpr std::uint32_t kForeignRobotsMax = 1'000;
inline constexpr std::uint32_t kLeasesMax = 1'000;
/// Characters of a card's texts that are read.
inline constexpr std::uint32_t kCardTextMax = 256;
/// A lease that was not renewed for so long goes, once its process holds no robot.
inline constexpr std::chrono::hours kLeaseKept{24};

/// How a process presents itself to the others. A value.
struct ProcessCard {
  /// For people: where robots reach it, host and port.
  std::string name;
  /// Where it runs, as processes beside it can check (server/store/process_life.h).
  std::string life;
};

/// The lease of a process: while its counter grows, it judges the robots that it holds.
struct Lease {
  ProcessId process{};
  ProcessCard card;
  std::uint64_t counter = 0;
  /// It stopped in order and judges no robot any more.
  bool released = false;
  /// How long ago the counter was raised, on the store's own clock.
  std::chrono::seconds renewed_ago{0};
};

/// A robot that another process holds, as that one wrote it.
struct ForeignRobot {
  model::RobotId robot;
  ProcessId holder{};
  Epoch held_since = 0;
  std::optional<StoredPresence> presence;
  /// Its session as its holder's last checkpoint has it; where none came since it holds the robot,
  /// the session that was used last, with its cursor.
  std::optional<SettledSession> last_session;
  /// When its presence or its live state was written last; nothing if neither was.
  std::optional<SystemTime> written_at;
};

/// What processes that share a store tell each other through it.
///
/// Errors: as in Store: a status means that nothing of the call is known.
/// Thread: confined to one thread.
class Leases {
 public:
  virtual ~Leases() = default;

  /// As Store::ServerRun.
  [[nodiscard]] virtual std::string ServerRun() const { return {}; }

  /// Raises the counter of this process's lease, which is made if it is not there. One that was
  /// released stays so: a renewal that comes late undoes nothing. kUnimplemented: this program
  /// can never use the store's schema (CheckApplied, CheckOldest).
  [[nodiscard]] virtual absl::Status Renew(const ProcessCard& card) = 0;
  /// Gives this process's robots up, for good.
  [[nodiscard]] virtual absl::Status Release() = 0;
  /// All leases, this process's own included, at most kLeasesMax: those renewed last.
  [[nodiscard]] virtual absl::StatusOr<std::vector<Lease>> Read() = 0;
  /// Robots that other processes hold, by RURI, from the first that comes after `after` on: at most
  /// kForeignRobotsMax; none after the last.
  [[nodiscard]] virtual absl::StatusOr<std::vector<ForeignRobot>> RobotsOfOthers(
      std::string_view after) = 0;
};

}  // namespace uplink::storage
