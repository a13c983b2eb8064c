#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "tools/uplink-fleet/drone/account.h"
#include "tools/uplink-fleet/drone/samples.h"
#include "tools/uplink-fleet/drone/sets.h"
#include "tools/uplink-fleet/drone/voice.h"
#include "tools/uplink-fleet/drone/wrongs.h"
#include "tools/uplink-fleet/scenario/scenario.h"

namespace uplink::synthetic {

/// All that one drone publishes, second by second, and the account of it. The same options, times
/// and lines that are busy give the same bytes. It knows no clock, connection or server.
///
/// Units:  `now_us` is Unix time; one that goes back counts as the last one.
/// Thread: confined to one thread at a time.
class DroneScript final {
 public:
  explicit DroneScript(const DroneOptions& options);
  DroneScript(const DroneScript&) = delete;
  DroneScript& operator=(const DroneScript&) = delete;

  /// The calls of a second; the first says both sets as they are. A line that is `busy` gets none
  /// that must be answered.
  [[nodiscard]] std::vector<AvatarCall> Second(std::int64_t now_us, const ScenarioOptions& options,
                                               const std::function<bool(std::size_t)>& busy);
  /// How it ends: a new sample of each line, and both sets, which stay as they are.
  [[nodiscard]] std::vector<AvatarCall> Last(std::int64_t now_us);
  /// A sign of life meanwhile, which changes nothing and is in no account.
  [[nodiscard]] AvatarCall Again() const { return samples_.Again(); }

  [[nodiscard]] DroneAccount& account() { return account_; }
  [[nodiscard]] const DroneAccount& account() const { return account_; }
  [[nodiscard]] const DroneOptions& options() const { return voice_.options(); }
  [[nodiscard]] std::size_t lines() const { return wrongs_.line() + 1; }

 private:
  DroneVoice voice_;
  DroneAccount account_;
  DroneSamples samples_;
  DroneSets sets_;
  DroneWrongs wrongs_;
  Seeded chance_;
};

}  // namespace uplink::synthetic
