#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "schema/model/uncrew/types.h"
#include "server/identity/peer_identity.h"
#include "storage/samples.h"
#include "tests/simulation/random.h"
#include "tests/simulation/sim_call.h"

namespace uplink::simulation {

using model::uncrew::SampleType;

/// A sample as its drone made it, and what it should come to. A value.
struct DroneSample {
  /// Counts the drone's samples from 1: its text, and by its time the rows that it becomes.
  std::uint64_t number = 0;
  SampleType type{};
  /// Its request, and what identifies it.
  std::string bytes;
  storage::SampleDigest digest{};
  std::uint64_t boot_us = 0;
  /// The key of a type that has one.
  std::optional<std::int64_t> key{};
  /// Of a set: the ids in it.
  std::set<std::string> items{};
  /// Of a mode: its JSON as it stands in the event of a change.
  std::string mode{};
  /// Some rule rejects it.
  bool bad = false;
  /// No other call of its type was on its way when it was made: no other sample can come between.
  bool alone = false;

  [[nodiscard]] model::uncrew::SampleKind kind() const { return model::uncrew::RowOf(type).kind; }
  /// When it was taken, as rows have it.
  [[nodiscard]] std::int64_t unix_ms() const;
};
using DroneSampleRef = std::shared_ptr<const DroneSample>;

/// `statusText 17`: for traces and violations.
[[nodiscard]] std::string ToText(const DroneSample& sample);
/// Sets and modes, which a drone says each second.
inline constexpr auto kRepeatedTypes = std::to_array<SampleType>(
    {SampleType::kArmed, SampleType::kFlightMode, SampleType::kUncrewFlightMode,
     SampleType::kAlerts, SampleType::kOperatorRequests});
[[nodiscard]] constexpr bool IsSetType(SampleType type) {
  return type == SampleType::kAlerts || type == SampleType::kOperatorRequests;
}

/// The software aboard a drone, by the rules of docs/integrate/uncrew.md: of each durable type one
/// sample at a time, which is sent again until it is answered; live ones are sent and forgotten;
/// sets and modes each second.
///
/// Thread: confined to its caller.
class SimDrone final {
 public:
  /// What is on its way of it, by type.
  using OnItsWay = std::function<bool(SampleType)>;
  SimDrone(std::size_t index, bool by_gateway, OnItsWay on_its_way);

  [[nodiscard]] const std::string& ruri() const { return ruri_; }
  [[nodiscard]] const identity::PeerIdentity& peer() const { return peer_; }

  // --- What it makes; `now` is the monotonic clock of the world ---

  /// A live sample: most are new, some are sent again, some are bad.
  DroneSampleRef MakeLive(SteadyTime now, Random& random);
  /// One that is good, of its heading.
  DroneSampleRef MakeHeading(SteadyTime now);
  /// Something happens aboard: a text, an event, another mode, another set. Null while a sample of
  /// that type waits for its answer.
  DroneSampleRef Happen(SteadyTime now, Random& random);
  /// What it says each second of a set or a mode, whether or not it changed; null while it waits.
  DroneSampleRef Repeat(SampleType type, SteadyTime now);
  /// The clock that starts with the drone falls back by far.
  void Reboot() { boot_base_us_ -= kRebootUs; }

  // --- What it hears ---

  /// A durable sample was answered: it is sent no more.
  void OnAnswered(const DroneSample& sample);
  /// The sample waits for an answer.
  [[nodiscard]] bool Awaits(const DroneSample& sample) const;
  /// Samples that wait for an answer, in order of their types.
  [[nodiscard]] std::vector<DroneSampleRef> Pending() const;

  [[nodiscard]] const std::set<std::string>& alerts() const { return alerts_; }
  [[nodiscard]] const std::set<std::string>& requests() const { return requests_; }
  /// As it stands in the event of a change to it.
  [[nodiscard]] std::string ModeOf(SampleType type) const;
  /// Every sample that it made, in order.
  [[nodiscard]] const std::vector<DroneSampleRef>& made() const { return made_; }

 private:
  /// Far beyond the 60 seconds within which an older sample is of the same flight.
  static constexpr std::uint64_t kRebootUs = 1'000'000'000;

  [[nodiscard]] DroneSample Begin(SampleType type, SteadyTime now) const;
  template <typename Request>
  DroneSampleRef Make(DroneSample sample, Request request);
  /// It is sent until it is answered.
  DroneSampleRef Await(DroneSampleRef sample);
  /// Null while one of that type waits.
  DroneSampleRef MakeText(SampleType type, SteadyTime now, Random& random);
  DroneSampleRef MakeMode(SampleType type, SteadyTime now);
  DroneSampleRef MakeSet(SampleType type, SteadyTime now);

  const std::string uav_id_;
  const std::string ruri_;
  const identity::PeerIdentity peer_;
  /// It names itself in each request then.
  const bool by_gateway_;
  const OnItsWay on_its_way_;
  std::uint64_t boot_base_us_ = 100 * kRebootUs;
  std::vector<DroneSampleRef> made_;
  DroneSampleRef last_live_;
  std::map<SampleType, DroneSampleRef> pending_;
  std::set<std::string> alerts_;
  std::set<std::string> requests_;
  std::map<SampleType, std::size_t> modes_;
};

}  // namespace uplink::simulation
