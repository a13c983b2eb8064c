#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "schema/base/clock.h"
#include "schema/cyberwave/judge.h"
#include "schema/cyberwave/ruri.h"
#include "schema/model/cyberwave/uuid.h"
#include "server/broker/twin_stream.h"
#include "server/cyberwave/twins.h"
#include "server/fleet/fleet.h"
#include "server/journal/shards.h"
#include "server/loop/wake.h"

namespace uplink::broker {

/// The faults of metrics that are active in the store, by robot: at most
/// storage::kActiveFaultsPerRobotMax of each that the fleet of twins has.
using FaultsByRobot = std::unordered_map<std::string, std::vector<std::string>>;

/// The streams of twins' robots, each opened when its robot speaks, or when this process takes the
/// robot over. A robot has one stream at a time.
///
/// Limits:  as many as there may be twins, and a stand-in per prefix.
/// Thread:  confined to its owner's.
class TwinStreams final {
 public:
  /// The references outlive it, and so do the journals.
  struct Context {
    const Clock& clock;
    fleet::Fleet& fleet;
    const journal::Shards& journals;
    cyberwave::Twins& twins;
    /// Where streams learn that something of them was settled.
    loop::WakeInbox& inbox;
    /// Of which fleet twins are (cyberwave.fleet).
    std::string fleet_name;
    /// Evenly drawn numbers.
    std::function<std::uint64_t()> random;
  };
  explicit TwinStreams(Context context) : context_(std::move(context)) {}

  /// The topic names this robot. A value.
  struct Named {
    std::string ruri;
    std::string prefix;
    model::cyberwave::Uuid twin;
  };
  /// The robot's stream; null if it has none.
  [[nodiscard]] TwinStream* Find(const std::string& ruri);
  [[nodiscard]] TwinStream* FindById(std::uint64_t id);
  struct Opened {
    /// Null if there are too many robots, if all sessions of this one wait for the store, or if its
    /// stream was ended and is not gone yet, or went just now.
    TwinStream* stream = nullptr;
    bool too_many = false;
  };
  /// The same, opened if it has none.
  [[nodiscard]] Opened FindOrOpen(const Named& named);
  /// Where a message is written to; nothing if nowhere, since it proves no robot.
  [[nodiscard]] std::optional<Opened> PlaceOf(const cyberwave::Judgement& judgement);
  /// What stands for no robot under that prefix.
  [[nodiscard]] Opened FindOrOpenStandIn(const std::string& prefix);

  /// Opens streams of all twins under one of the prefixes that the fleet knows and that have none:
  /// this process holds them from now on.
  enum class Which : std::uint8_t { kAll, kNotHeld };
  void OpenKnown(const std::vector<std::string>& prefixes, Which which);
  /// The stream takes no more messages. It must have none that waits.
  void Close(TwinStream& stream);
  /// An operator ended it, who wants the robot forgotten: so is what it said. None is opened for
  /// the robot within kRestAfterDrop, whatever it says.
  void Drop(TwinStream& stream);
  /// Another process has the robot: what it said here counts no more, and what faults of it were
  /// stored the store alone knows.
  void Lose(TwinStream& stream);
  /// Streams that said nothing for kStreamIdleMax are closed, and twins forgotten whose robots left
  /// memory.
  void CloseIdle();
  void ForgetLeft();
  /// All end: at once, or when nothing of them waits.
  void EndAll();

  /// The store may lack what was committed, and is asked what it has. The caller passes no metrics
  /// until SetFaults.
  void BeginReread() { rereading_ = true; }
  /// What the store has. It counts for robots that are not in memory, that were lost since the last
  /// call, or that had no stream at BeginReread, so that nothing of them waits: of the others it is
  /// known better here.
  void SetFaults(FaultsByRobot faults);

  [[nodiscard]] std::size_t size() const { return by_id_.size(); }

 private:
  [[nodiscard]] TwinStream* Open(fleet::RobotPtr robot, cyberwave::TwinPtr twin);
  /// One of a twin that was to end goes on; false where there are too many twins by now.
  [[nodiscard]] bool Revive(TwinStream& stream);
  [[nodiscard]] model::SessionId DrawSession() const;
  [[nodiscard]] std::shared_ptr<cyberwave::TwinRates> RatesOf(const Named& named);
  void RestoreFaults(cyberwave::Twin& twin);
  /// The twin leaves memory; its faults are active in the store.
  void Forget(const cyberwave::Twin& twin);

  const Context context_;
  std::uint64_t last_id_ = 0;
  std::unordered_map<std::string, std::unique_ptr<TwinStream>> streams_;
  std::unordered_map<std::uint64_t, TwinStream*> by_id_;
  /// By prefix and twin, while a stream of it is open.
  std::unordered_map<std::string, std::weak_ptr<cyberwave::TwinRates>> rates_;
  /// Those of robots that were not heard yet.
  FaultsByRobot faults_;
  /// Robots that may have a stream although the store alone knows their faults, until SetFaults:
  /// they were lost and spoke since, or their stream was opened after BeginReread.
  std::unordered_set<std::string> unsure_;
  bool rereading_ = false;
  /// When streams may be opened again that an operator ended.
  std::unordered_map<std::string, SteadyTime> rests_;
  /// Stands for none, and changes no presence.
  const robot::PresenceChanged untold_;
};

}  // namespace uplink::broker
