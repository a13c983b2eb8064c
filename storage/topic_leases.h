#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/deliveries.h"
#include "storage/epoch.h"
#include "storage/identity.h"
#include "storage/origin.h"

namespace uplink::storage {

/// Prefixes of one lease (cyberwave.topic_prefixes).
inline constexpr std::size_t kLeasePrefixesMax = 8;
/// Client ids that a store remembers. Past it those go, with their memory, whose lease was released
/// or ended, the ones that were taken longest ago first; none that somebody holds.
inline constexpr std::size_t kTopicClientsMax = 64;

/// Who subscribes to topics under which prefixes: one client id, in one process. A value.
struct TopicLease {
  std::string client_id;
  /// Ascending; none if it was released or ended.
  std::vector<std::string> prefixes;
  Epoch epoch = 0;
  ProcessId holder{};
  /// Its holder gave it up, or another took one of its prefixes.
  bool released = false;
  /// By the taker's civil clock.
  SystemTime taken_at;

  friend bool operator==(const TopicLease&, const TopicLease&) = default;
};

/// A process that the caller judged to be over (leases.h): its lease did not grow for so long that
/// it counts as silent, or it was released, or is not there.
struct OverHolder {
  ProcessId process{};
  /// The counter of its lease then; 0 if it had none.
  std::uint64_t lease_counter = 0;
};

struct TakeRequest {
  /// 1 to kClientIdBytesMax bytes.
  std::string client_id;
  /// 1 to kLeasePrefixesMax, each once, of at most kTopicPrefixBytesMax bytes.
  std::vector<std::string> prefixes;
  std::vector<OverHolder> over;
  SystemTime at;
  /// The window for which deliveries of the client id are remembered (DeliveriesKept): 1 to
  /// kUnackedMaxMax. It may be larger than the one that the broker was asked for.
  std::uint32_t unacked_max = kUnackedMaxMax;
};

/// kInvalidArgument, naming field and limit, for a request that breaks a bound above.
[[nodiscard]] absl::Status CheckRequest(const TakeRequest& request);

/// Whether the lease, unless it was released, has something that the request asks for: the client
/// id or one of the prefixes.
[[nodiscard]] bool Overlaps(const TopicLease& lease, const TakeRequest& request);
/// Whether this lease keeps `self` from what the request asks for. `renewed_since` says whether the
/// process's lease grew since it stood at that counter.
[[nodiscard]] bool IsInTheWay(
    const TopicLease& lease, const TakeRequest& request, const ProcessId& self,
    const std::function<bool(const ProcessId& process, std::uint64_t counter)>& renewed_since);
/// Whether the lease has to end when the request is granted: of another client id, with a prefix
/// that both want.
[[nodiscard]] bool IsEndedBy(const TopicLease& lease, const TakeRequest& request);

/// Which process subscribes to which topics at a broker, among those that share a store. A lease is
/// not renewed: it stands as long as its holder's own lease does (leases.h). Every commit that came
/// under a lease locks its row, so renewals there would make those commits wait.
///
/// Errors: as in Store: a status means that nothing of the call is known. Calling again is right.
/// Thread: confined to one thread.
class TopicLeases {
 public:
  virtual ~TopicLeases() = default;

  /// Takes the lease of all the prefixes for the client id, or nothing of it: nothing if another
  /// process holds the client id, or one of the prefixes, and is not over. Of several processes
  /// that try, one succeeds. Draws an epoch, above all that were given, and numbers the client id's
  /// deliveries anew (NumberedAnew). If this process holds the client id already, returns its epoch
  /// instead, and replaces its prefixes. A lease that had one of the prefixes ends with all of its
  /// prefixes, and its epoch with it.
  ///
  /// Errors: kInvalidArgument for a request that CheckRequest refuses.
  [[nodiscard]] virtual absl::StatusOr<std::optional<Epoch>> Take(const TakeRequest& request) = 0;
  /// Gives the client id's lease up, if this process holds it. Its memory stays, and so does its
  /// epoch: what is on its way still commits, until another takes the lease.
  [[nodiscard]] virtual absl::Status Release(std::string_view client_id) = 0;
  /// All, by client id; at most kTopicClientsMax and what is held beyond.
  [[nodiscard]] virtual absl::StatusOr<std::vector<TopicLease>> Read() = 0;
  /// What is known of the client id's deliveries; the process that took its lease begins with it.
  [[nodiscard]] virtual absl::StatusOr<DeliveryMemory> MemoryOf(std::string_view client_id) = 0;
  /// How often the store was connected to. After a new connection it may be another store, which
  /// lacks the last commits. Always 0 for a file.
  [[nodiscard]] virtual std::uint64_t connections() const { return 0; }
};

}  // namespace uplink::storage
