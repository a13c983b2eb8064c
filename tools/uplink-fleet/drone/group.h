#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "tools/uplink-fleet/drone/script.h"
#include "tools/uplink-fleet/robot/histogram.h"
#include "tools/uplink-fleet/robot/shared.h"
#include "tools/uplink-fleet/scenario/scenario.h"

namespace uplink::synthetic {

/// What drones do: publish; wait until all that must be answered is; publish each type once more,
/// and from then on nothing that is new; leave.
enum class DroneStage : std::uint8_t { kSend, kSettle, kLast, kClose };

/// What the threads of drones and the run tell each other. Thread-safe.
struct DronesShared {
  std::atomic<DroneStage> stage{DroneStage::kSend};
  /// Give up what is not done.
  std::atomic<bool> abandon{false};
  // Groups that have come to the end of that stage. From the second on their accounts stay as they
  // are.
  std::atomic<std::size_t> settled_groups{0};
  std::atomic<std::size_t> quiet_groups{0};
  /// Calls that left, those of them that were the second time or later, and those that were
  /// answered, whether or not the drone took the answer.
  std::atomic<std::uint64_t> sent{0};
  std::atomic<std::uint64_t> again{0};
  std::atomic<std::uint64_t> answered{0};
  /// Calls whose answer was not taken on purpose, and links that were cut.
  std::atomic<std::uint64_t> lost{0};
  std::atomic<std::uint64_t> cut{0};
  FirstText first_error;
};

/// Where a drone calls, and what it shows there, in PEM. A value.
struct DroneDial {
  std::string target;
  std::string server_ca;
  std::string certificate;
  std::string key;
};

/// Some drones and their connections, one each, by the gRPC library.
///
/// Thread: made and asked by one thread; Run is another's until it returns.
class DroneGroup final {
 public:
  /// All must outlive this.
  DroneGroup(const Scenario& scenario, const Clock& clock, DronesShared& shared);
  ~DroneGroup();
  DroneGroup(const DroneGroup&) = delete;
  DroneGroup& operator=(const DroneGroup&) = delete;

  void Add(const DroneOptions& options, DroneDial dial);
  /// Lives through all stages; returns at the end of the last one, or when told to give up.
  void Run();

  void ForEach(const std::function<void(const DroneScript&)>& each) const;
  [[nodiscard]] const Latencies& latencies() const { return latencies_; }

 private:
  struct Drone;
  struct Attempt;
  struct Queue;

  void AwaitAnswers();
  void EnterStage(DroneStage stage);
  void Work(Drone& drone, SteadyTime now);
  void Send(Drone& drone, SteadyTime now);
  void Done(Attempt& attempt, SteadyTime now);
  void CutLink(Drone& drone);
  [[nodiscard]] const Phase& phase(SteadyTime now) const;
  [[nodiscard]] bool AllAnswered() const;
  [[nodiscard]] std::int64_t NowUs() const;

  const Scenario& scenario_;
  const Clock& clock_;
  DronesShared& shared_;
  const SteadyTime start_;
  std::unique_ptr<Queue> queue_;
  std::vector<std::unique_ptr<Drone>> drones_;
  Latencies latencies_;
  DroneStage stage_ = DroneStage::kSend;
  bool told_ = false;
};

}  // namespace uplink::synthetic
