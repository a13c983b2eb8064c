#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "tools/uplink-fleet/compare/compare_forwards.h"
#include "tools/uplink-fleet/robot/forward_board.h"
#include "tools/uplink-fleet/run/run_context.h"
#include "uplink/v1/fleet.pb.h"

/// What main does in each stage of a run (robot/shared.h), one after the other. A first signal ends
/// the sending; a second one the settling, and a server that does not answer is then waited for
/// kSecondSignalGrace longer.
///
/// Thread: main's.
namespace uplink::synthetic {

/// Whether to send at all.
enum class Readiness : std::uint8_t { kReady, kToldToStop };

/// What the fleet shares as the server shows it, and what the receivers held at about that time. A
/// value.
struct ForwardsLook {
  SharedItems shared;
  std::vector<ReceiverTable> tables;
};

/// The robots as the server showed them while they still moved.
struct LastLook {
  std::map<std::string, v1::Robot> live;
  /// The server's clock then.
  std::int64_t at_ms = 0;
  ForwardsLook forwards;
};

/// Waits until every thread has made its robots: those that were offline first live through that
/// time before any of them connects. Told to stop, it has the robots give up.
[[nodiscard]] Readiness AwaitRobots(const RunContext& run);
/// Waits until that many robots have been counted; false if that takes longer than the options let
/// it, or a signal comes.
[[nodiscard]] bool WaitFor(const RunContext& run, const std::atomic<std::size_t>& counted,
                           std::size_t robots);
/// Lets the robots live for as long as the options say; false if the server never welcomed one.
[[nodiscard]] bool Send(const RunContext& run);
/// Settles everything, and looks at the live state while the robots are still there.
[[nodiscard]] LastLook Settle(const RunContext& run);
/// Waits for every stream to end; if that takes too long, or no robot was `reached`, they give up.
void Close(const RunContext& run, bool reached);
/// Waits until the robots have an ack for each of their durable messages, without asking the
/// server.
void SettleAcks(const RunContext& run);

}  // namespace uplink::synthetic
