#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <list>
#include <optional>
#include <string>
#include <utility>

#include "schema/base/clock.h"
#include "schema/model/cyberwave/reports.h"
#include "server/config/config.h"
#include "server/cyberwave/held.h"
#include "server/robot/connection_reports.h"
#include "server/robot/robot.h"
#include "server/transport/end_cause.h"
#include "storage/connection.h"

namespace uplink::broker {

/// Clients of one robot of a twin that are reported at once; a further one takes the place of the
/// one heard least recently.
inline constexpr std::size_t kTwinConnectionsMax = 4;
/// A client that we could hear, and that said nothing for so long, is gone.
inline constexpr std::chrono::minutes kTwinSilentMax{2};
/// A live message that comes so soon after its client's `disconnected` was on its way: marks and
/// live messages come by two connections of the broker.
inline constexpr std::chrono::seconds kTwinReturnsAfter{5};

/// The connections of one robot of a twin: the clients that say how it is, told apart by their
/// session ids. One begins with its client's `connected`, or with its first live message; a client
/// that sends none is a viewer. It ends with that client's `disconnected`, or when we hear it no
/// more. Confined to its owner's thread.
class TwinConnections final {
 public:
  /// A message of the twin that has come. A value.
  struct Heard {
    const std::string& session;
    /// It says how the robot is.
    bool live = false;
    /// Null unless it is a mark.
    const model::cyberwave::Mark* mark = nullptr;
    std::size_t bytes = 0;
    cyberwave::Arrival arrived{};
    /// How long the robot is parked once its client leaves (presence.parked_max).
    milliseconds parked_max = config::PresenceConfig().parked_max;
  };
  /// A `disconnected` of the client that sent the last live message parks the robot; that of any
  /// other, such as a viewer, says nothing of it.
  void Hear(robot::ConnectionReports& reports, robot::Robot& robot, const Heard& heard);
  /// Ends those that said nothing for kTwinSilentMax although we heard the broker all the while,
  /// since `heard_all_since`.
  void EndSilent(robot::ConnectionReports& reports, robot::Robot& robot, SteadyTime now,
                 SteadyTime heard_all_since);
  /// This server hears the robot no more.
  void EndAll(robot::ConnectionReports& reports, robot::Robot& robot, SystemTime now,
              transport::EndCause cause);

 private:
  struct One {
    std::string session;
    storage::ConnectionId id{};
    SystemTime began_at;
    cyberwave::Arrival heard;
    SteadyTime kept_at;
    std::uint64_t messages = 0;
    std::uint64_t bytes = 0;
  };
  using Ones = std::list<One>;
  /// A mark of a client. A value.
  struct Marked {
    std::string session;
    cyberwave::Arrival at;
  };
  using Marks = std::deque<Marked>;

  /// The client's connection, which counts as heard last; the end if it has none.
  [[nodiscard]] Ones::iterator Find(const std::string& session);
  [[nodiscard]] Ones::iterator Begin(robot::ConnectionReports& reports, robot::Robot& robot,
                                     const Heard& heard);
  void End(robot::ConnectionReports& reports, robot::Robot& robot, Ones::iterator one,
           SystemTime at, transport::EndCause cause);
  void TakeMark(robot::ConnectionReports& reports, robot::Robot& robot, const Heard& heard);

  /// The session of the last live message.
  std::optional<std::string> last_live_;
  /// The one heard least recently first.
  Ones ones_;
  /// Clients without a connection: those that said `connected`, and those that said `disconnected`.
  Marks came_;
  Marks left_;
};

}  // namespace uplink::broker
