#pragma once

#include <cstddef>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "tools/link/dial.h"
#include "tools/uplink-fleet/robot/account.h"
#include "tools/uplink-fleet/robot/histogram.h"
#include "tools/uplink-fleet/robot/shared.h"
#include "tools/uplink-fleet/scenario/scenario.h"

namespace uplink::synthetic {

struct SwarmOptions {
  std::string target;
  std::string pki_directory;
  std::string fleet = "default";
  std::string ruri_prefix;
  std::size_t threads = 1;
  /// Gateways through which the robots speak, in equal parts; 0: each by itself.
  std::size_t gateways = 0;
  /// What makes the robots' connections; empty: link::GrpcConnection. Without gateways.
  link::Dial dial;
  Scenario scenario;
  /// When those join that the scenario lets come late.
  milliseconds late_after{0};
  /// Each robot says at its end that it is parked for so long; 0: it does not.
  milliseconds parked_for{0};
};

/// All robots of a run, with the threads that drive them. Their certificates are made in memory
/// from the authority in `pki_directory`; nothing is written there.
///
/// Thread: confined to the thread that made it; `shared` is how it talks to the robots' threads.
class Swarm final {
 public:
  /// Errors: those of the pki folder, and of looking the target up.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<Swarm>> Create(const SwarmOptions& options,
                                                                     const Clock& clock,
                                                                     Shared& shared);
  ~Swarm();
  Swarm(const Swarm&) = delete;
  Swarm& operator=(const Swarm&) = delete;

  /// Starts the threads; robots connect over the next moments.
  void Start();
  /// Waits for every robot to be done (Stage::kClose or abandon) and gives what they learned.
  [[nodiscard]] std::vector<RobotOutcome> Finish();
  /// Of all robots; after Finish.
  [[nodiscard]] Latencies TakeLatencies();
  /// The robots whose shapes and objects were forwarded to others; after Finish.
  [[nodiscard]] std::set<std::string> Origins() const;

 private:
  struct Inside;
  explicit Swarm(std::unique_ptr<Inside> inside);

  std::unique_ptr<Inside> inside_;
};

/// RURI of the robot with this index, counted from 0.
[[nodiscard]] std::string RuriOf(const SwarmOptions& options, std::size_t index);

}  // namespace uplink::synthetic
