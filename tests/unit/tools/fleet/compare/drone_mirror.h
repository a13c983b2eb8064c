#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/uncrew/live_samples.h"
#include "tools/uplink-fleet/compare/stored.h"
#include "tools/uplink-fleet/drone/script.h"

namespace uplink::synthetic {

inline constexpr std::int64_t kDroneStartUs = 1'763'683'200'000'000;

/// A drone that lives for some minutes, and what the server's own rules make of its calls: what a
/// server that does everything right shows and answers. Confined to one test.
class DroneMirror {
 public:
  /// One second after the other; each call is answered at once.
  explicit DroneMirror(const DroneOptions& options, int seconds = 120);

  DroneScript drone;
  std::string look;
  StoredDrone stored;
  std::vector<AvatarCall> calls;

 private:
  struct Applier;
  void Take(const AvatarCall& call);
  void Reject(const AvatarCall& call, const model::Rejection& rejection);
  void Show();

  std::int64_t now_us_ = kDroneStartUs;
  uncrew::LiveSamples live_;
  /// By type: the stored sample before, and all that were stored, as requests.
  std::vector<std::string> last_;
  std::vector<std::vector<std::string>> known_;
};

}  // namespace uplink::synthetic
