#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/simulation/drones_process.h"
#include "tests/support/manual_clock.h"

namespace uplink::simulation {

struct DronesOptions {
  std::uint64_t seed = 1;
  std::uint32_t steps = 400;
  /// Is given everything that drones and servers do; null: nothing is traced.
  Trace* trace = nullptr;
};

struct DronesResult {
  /// Empty if every promise was kept; else the step and what was broken.
  std::string violation;
  std::uint32_t steps = 0;
  /// Answers that drones were given, and ends without one, by outcome or code.
  std::map<std::string, std::uint64_t> ends;
  std::uint64_t lost_answers = 0;
  std::uint64_t late_calls = 0;
  std::uint64_t moves = 0;
  std::uint64_t kills = 0;
  std::uint64_t stops = 0;
  std::uint64_t breaks = 0;
  std::uint64_t claims = 0;
  std::uint64_t fenced = 0;
  /// Samples that the store knew by itself.
  std::uint64_t duplicates = 0;
};

/// Everything in the result, one figure a line: two runs are the same run if it is equal.
[[nodiscard]] std::string ToText(const DronesResult& result);

/// Drones that call one or two servers on one store: one seeded schedule of calls and of troubles
/// (lost answers, late calls, a store that is away or fails, kills, stops, drones that alternate,
/// clocks that jump), then a time in which everything must settle.
///
/// An answer that says that a sample is stored is true; each sample is stored once, with all that
/// it is; changes form a chain; sets and modes in the store are those that were answered last; live
/// state is the latest sample by the rules; the conservation law holds after each step.
///
/// Thread: confined to its caller; nothing in it waits or reads a real clock.
class DronesWorld final {
 public:
  DronesWorld(DronesBackend& backend, const DronesOptions& options);
  DronesResult Run();

 private:
  /// Where one life of a server follows the other.
  struct Place {
    std::unique_ptr<DronesProcess> process;
    std::uint8_t lives = 0;
    std::optional<SteadyTime> starts_at;
    /// It stops in order, at the latest then.
    std::optional<SteadyTime> stops_at;
    /// The store is away from it until then.
    SteadyTime away_until;
  };
  struct Drone {
    std::unique_ptr<SimDrone> aboard;
    std::size_t place = 0;
    /// It goes to another server with each call.
    bool alternates = false;
    SteadyTime repeats_at;
    /// Live samples that were unavailable, one after the other.
    int unavailable = 0;
    /// Types for which it knows, at the end, that its last word was heard.
    std::set<SampleType> said;
  };
  /// One call, from the drone to the answer.
  struct Call {
    enum class At : std::uint8_t { kOnItsWay, kServed, kAnswered };
    std::size_t drone = 0;
    std::size_t place = 0;
    std::uint8_t life = 0;
    DroneSampleRef sample;
    At at = At::kOnItsWay;
    /// The drone waits for it.
    bool awaited = true;
    SteadyTime served_since;
    CallEnd end;
  };
  using Calls = std::map<std::uint64_t, Call>;

  // --- Steps ---
  void AddDrones();
  void Step();
  void DroneStep(Drone& drone);
  void CallStep(std::uint64_t id);
  void Pass(milliseconds time);
  /// What servers have answered meanwhile.
  void Reap();

  void Send(Drone& drone, const DroneSampleRef& sample);
  void Deliver(std::uint64_t id, Call& call);
  void Receive(std::uint64_t id);
  /// The drone waits for no call to that place any more, and comes again.
  void BreakConnection(Drone& drone, std::size_t place);
  void Lose(Calls::iterator call);
  [[nodiscard]] bool IsOnItsWay(std::size_t drone, SampleType type) const;
  [[nodiscard]] DronesProcess* ProcessOf(const Call& call);
  [[nodiscard]] Place& AnyPlace() { return places_[random_.Below(places_.size())]; }
  [[nodiscard]] std::size_t IndexOf(const Drone& drone) const {
    return static_cast<std::size_t>(&drone - drones_.data());
  }
  [[nodiscard]] const std::string& NameOf(const Call& call) const {
    return drones_[call.drone].aboard->ruri();
  }

  // --- Troubles ---
  void Trouble();
  void Start(Place& place);
  void Kill(Place& place);
  void Stop(Place& place);
  void End(Place& place);
  /// Calls to a life of a place that is over.
  void LoseCallsOf(const Place& place);

  // --- Promises ---
  void Check();
  /// What the server held of the part before a live sample came.
  struct Held {
    storage::SampleDigest digest{};
    std::uint64_t boot_us = 0;
  };
  [[nodiscard]] static std::optional<Held> HeldOf(const DronesProcess& process,
                                                  const std::string& ruri,
                                                  const DroneSample& sample);
  void CheckLive(const Call& call, const std::optional<Held>& held);
  void CheckEndOf(const Call& call);
  void CheckStored(const Call& call);
  /// The last word of its type that the drone was given an answer to is what the store has.
  void CheckLastWord(const Call& call);
  void Settle();
  void SettleRound();
  /// What it says while all settles: what has no answer, and its last word then.
  void Speak(Drone& drone, bool last_word);
  [[nodiscard]] bool Settled(bool last_word) const;
  void CheckEnd();
  void CheckShown(const Drone& drone);
  void Violate(const std::string& what);
  void Tell(const std::string& line);

  DronesBackend& backend_;
  const DronesOptions options_;
  Random random_;
  testing::ManualClock clock_;
  DronesResult result_;
  DronesBook book_;
  DronesLimits limits_;
  std::vector<Place> places_;
  std::vector<Drone> drones_;
  Calls calls_;
  std::uint64_t last_call_ = 0;
  /// Names of lives that are seen to be over.
  std::set<std::string, std::less<>> gone_;
};

}  // namespace uplink::simulation
