#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "schema/base/clock.h"
#include "server/fleet/claim.h"

namespace uplink::fleet {

/// Candidates that are remembered. At it the one that was refused longest ago is
/// forgotten, of the fleet that has most: no fleet crowds out those of another.
inline constexpr std::size_t kCandidatesMax = 1'000;

/// A robot that was refused because no operator has added it (identity.registration). A value.
struct Candidate {
  /// With the fleet that its certificate, or the broker's key, names.
  model::RobotId robot;
  /// The subject of the gateway's certificate by which it came last; empty: it came by itself.
  std::string gateway = {};
  SystemTime first_at;
  SystemTime last_at;
  /// How often it was refused.
  std::uint64_t refused = 0;
};

/// The candidates of this process since its start.
///
/// Limits: kCandidatesMax.
/// Thread: thread-safe. It calls nothing.
class Candidates final {
 public:
  void Note(const Claim& claim, SystemTime now);
  /// It was added, or came in.
  void Remove(std::string_view ruri);
  /// The one that was refused last comes first.
  [[nodiscard]] std::vector<Candidate> All() const;

 private:
  void Evict();

  mutable std::mutex mutex_;
  std::uint64_t notes_ = 0;
  struct Entry {
    Candidate candidate;
    /// The number of its last Note.
    std::uint64_t note = 0;
  };
  std::map<std::string, Entry, std::less<>> by_ruri_;
  /// RURIs by that number.
  std::map<std::uint64_t, std::string> by_note_;
};

}  // namespace uplink::fleet
