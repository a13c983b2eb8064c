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
#include "server/robot/connection_reports.h"
#include "server/transport/end_cause.h"

namespace uplink::broker {

/// The metrics' faults that are active in the store, by robot: at most
/// storage::kActiveFaultsPerRobotMax of each robot of twins.
using FaultsByRobot = std::unordered_map<std::string, std::vector<std::string>>;

/// The streams of twins' robots. A stream opens when its robot speaks, or when this process takes
/// the robot over. A robot has one stream at a time.
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
    /// Told when something of a stream was settled.
    loop::WakeInbox& inbox;
    /// The fleet of the twins (cyberwave.fleet).
    std::string fleet_name;
    /// Evenly drawn numbers.
    std::function<std::uint64_t()> random;
    /// Where the twins' connections are reported; null: nowhere.
    robot::ConnectionReports* reports = nullptr;
  };
  explicit TwinStreams(Context context) : context_(std::move(context)) {}

  /// A robot as a topic names it. A value.
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
    /// stream was ended and is not gone yet or went just now.
    TwinStream* stream = nullptr;
    bool too_many = false;
    /// An operator blocked the robot, or did not add it: its messages are dropped.
    bool blocked = false;
  };
  /// As Find, but opens a stream if the robot has none.
  [[nodiscard]] Opened FindOrOpen(const Named& named);
  /// The stream for a message; empty if it is written nowhere, since it proves no robot.
  [[nodiscard]] std::optional<Opened> PlaceOf(const cyberwave::Judgement& judgement);
  /// The stand-in's stream for messages of no robot under that prefix.
  [[nodiscard]] Opened FindOrOpenStandIn(const std::string& prefix);

  enum class Which : std::uint8_t { kAll, kNotHeld };
  /// Opens streams for the known twins under these prefixes that have none: this process holds them
  /// from now on. kNotHeld: only those that it does not hold yet.
  void OpenKnown(const std::vector<std::string>& prefixes, Which which);
  /// Ends a stream without waiting messages. Its connections end for `cause`.
  void Close(TwinStream& stream, transport::EndCause cause = transport::EndCause::kSuperseded);
  /// An operator ended the stream to forget the robot, so its faults are forgotten too. The robot
  /// gets no new stream within kRestAfterDrop, even if it speaks.
  void Drop(TwinStream& stream);
  /// Another process has the robot. Its live data here is void, and only the store knows its stored
  /// faults.
  void Lose(TwinStream& stream);
  /// A message of a twin has come, and belongs to its stream.
  void Hear(TwinStream& stream, const TwinConnections::Heard& heard) {
    if (context_.reports == nullptr || stream.twin == nullptr) return;
    TwinConnections::Heard within = heard;
    within.parked_max = context_.fleet.presence_limits_of(*stream.robot).parked_max;
    stream.connections.Hear(*context_.reports, *stream.robot, within);
  }
  /// The broker is not heard at `now`: until then nothing says that a client is silent.
  void NoteUnheard(SteadyTime now) { heard_all_since_ = now; }
  /// CloseIdle ends the connections of silent clients, and closes streams that were silent for
  /// kStreamIdleMax and wait for nothing. ForgetLeft forgets twins whose robots left memory.
  void CloseIdle();
  void ForgetLeft();
  /// Ends all streams: at once, or when nothing of them waits. Their connections end for `cause`.
  void EndAll(transport::EndCause cause = transport::EndCause::kSuperseded);

  /// The store may have lost commits, and is being read. The caller passes no metrics until
  /// SetFaults.
  void BeginReread() { rereading_ = true; }
  /// Takes the faults that the store has, for robots that are not in memory, were lost since the
  /// last call, or had no stream at BeginReread. For the others, this process knows better.
  void SetFaults(FaultsByRobot faults);

  [[nodiscard]] std::size_t size() const { return by_id_.size(); }

 private:
  [[nodiscard]] TwinStream* Open(fleet::RobotPtr robot, cyberwave::TwinPtr twin);
  /// Keeps a twin's ending stream open; false if there are too many twins by now.
  [[nodiscard]] bool Revive(TwinStream& stream);
  [[nodiscard]] model::SessionId DrawSession() const;
  [[nodiscard]] std::shared_ptr<cyberwave::TwinRates> RatesOf(const Named& named);
  void EndConnections(TwinStream& stream, transport::EndCause cause) {
    if (context_.reports == nullptr) return;
    stream.connections.EndAll(*context_.reports, *stream.robot, context_.clock.System(), cause);
  }
  void RestoreFaults(cyberwave::Twin& twin);
  /// The twin leaves memory; its faults are active in the store.
  void Forget(const cyberwave::Twin& twin);

  const Context context_;
  std::uint64_t last_id_ = 0;
  SteadyTime heard_all_since_;
  std::unordered_map<std::string, std::unique_ptr<TwinStream>> streams_;
  std::unordered_map<std::uint64_t, TwinStream*> by_id_;
  /// By prefix and twin, while a stream of it is open.
  std::unordered_map<std::string, std::weak_ptr<cyberwave::TwinRates>> rates_;
  /// Faults of robots that were not heard yet.
  FaultsByRobot faults_;
  /// Robots with a stream whose faults only the store knows, until SetFaults: they were lost and
  /// spoke since, or their stream was opened after BeginReread.
  std::unordered_set<std::string> unsure_;
  bool rereading_ = false;
  /// When robots whose stream an operator ended may have one again.
  std::unordered_map<std::string, SteadyTime> rests_;
  /// For stand-ins: changes no presence.
  const robot::PresenceChanged untold_;
};

}  // namespace uplink::broker
