#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include <boost/asio/steady_timer.hpp>

#include "schema/base/clock.h"
#include "tools/link/dial.h"
#include "tools/link/grpc_connection.h"
#include "tools/uplink-fleet/robot/agent.h"
#include "tools/uplink-fleet/robot/arrival.h"
#include "tools/uplink-fleet/robot/backoff.h"
#include "tools/uplink-fleet/robot/gateway.h"
#include "tools/uplink-fleet/robot/leftovers.h"
#include "tools/uplink-fleet/robot/network_chance.h"
#include "tools/uplink-fleet/scenario/scenario.h"

namespace uplink::synthetic {

struct RobotOptions {
  std::string ruri;
  std::size_t index = 0;
  link::LinkOptions link;
  std::uint64_t seed = 1;
  /// By another client than GrpcConnection, and with what; empty: by that. Without a gateway.
  link::Dial dial;
  link::DialOptions dialled;
  /// Through which it speaks; null: by itself. Outlives the robot.
  Gateway* gateway = nullptr;
  /// What the scenario does to its connection it does to the gateway's. Of the other robots of a
  /// gateway the streams alone suffer: its connection breaks as often as one robot's.
  bool leads = false;
  /// Before it the robot is not there, unless the fleet stops running sooner.
  SteadyTime joins_at{};
  /// As SwarmOptions::parked_for.
  milliseconds parked_for{0};
};

/// One robot's connection: a TLS connection and a stream of its own, or a stream of its gateway's
/// connection, opened again after each end, driven by a timer at each tick; and what the scenario
/// does to it.
///
/// Thread: Start from the thread that makes it, before the loop runs; everything else on the
/// loop's thread.
class Robot final : private link::StreamEvents {
 public:
  /// `scenario` outlives the robot, and `start` is when the run begins.
  Robot(RobotOptions options, Agent agent, const Scenario& scenario, SteadyTime start,
        link::Loop& loop, const Clock& clock, Shared& shared);
  ~Robot() override;
  Robot(const Robot&) = delete;
  Robot& operator=(const Robot&) = delete;

  /// Sets the first tick, `after` the start: a fleet does not connect in one instant.
  void Start(milliseconds after);
  [[nodiscard]] RobotOutcome TakeOutcome() { return agent_.TakeOutcome(options_.ruri); }

 private:
  enum class State : std::uint8_t { kIdle, kConnecting, kStreaming };

  void OnConnected() override;
  void OnMessage(std::string_view message) override;
  void OnSent() override { Pump(); }
  void OnEnded(const link::StreamEnd& end) override;

  void ArmTick();
  void OnTick();
  void LiveUpTo(SteadyTime now);
  void Enter(const Phase& phase);
  void Suffer(Mishap mishap, SteadyTime now);
  void ReadSlowly(SteadyTime now);
  /// The frame that a network loses with the connection: the agent cannot tell, and must send it
  /// again.
  [[nodiscard]] std::string LastFrame();
  void Break();
  void Cut();
  /// Ends the connection without a word, or the stream if the connection is not the robot's to end.
  void DropConnection();
  [[nodiscard]] bool own_connection() const {
    return options_.gateway == nullptr || options_.leads;
  }
  void LeaveBehind(bool frozen, SteadyTime now);
  void Connect();
  void OpenStream();
  void Pump();
  void Note(const link::StreamEnd& end);
  void StreamIsOver();
  void Done();

  RobotOptions options_;
  Agent agent_;
  const Scenario& scenario_;
  const SteadyTime start_;
  link::Loop& loop_;
  const Clock& clock_;
  Shared& shared_;
  NetworkChance network_;
  Backoff backoff_;
  Arrival arrival_;
  boost::asio::steady_timer timer_;

  const Phase* phase_;
  std::unique_ptr<link::StreamConnection> connection_;
  Leftovers leftovers_;
  State state_ = State::kIdle;
  SteadyTime next_open_{};
  SteadyTime opened_{};
  SteadyTime next_tick_{};
  std::uint64_t breaks_ = 0;
  bool half_closed_ = false;
  /// The stream that ends next was ended by the scenario.
  bool broken_by_us_ = false;
};

}  // namespace uplink::synthetic
