#pragma once

#include <cstdint>
#include <memory>
#include <random>
#include <string>

#include <grpcpp/alarm.h>
#include <grpcpp/grpcpp.h>

#include "schema/base/clock.h"
#include "tools/pki/authority.h"
#include "tools/uplink-fleet/agent.h"
#include "uplink/v1/relay.grpc.pb.h"

namespace uplink::synthetic {

/// What a completion queue hands back.
class Tag {
 public:
  virtual ~Tag() = default;
  virtual void Proceed(bool ok) = 0;
};

struct RobotOptions {
  std::string target;
  std::string ruri;
  pki::Credentials credentials;
  std::string ca_pem;
  milliseconds tick{100};
  /// Breaks of its own making, a minute.
  double breaks_per_minute = 0;
  std::uint64_t seed = 1;
};

/// One robot's connection: a TLS connection and a stream of its own, opened again after each end,
/// driven by an alarm each tick. Tags of one robot all return on one completion queue.
///
/// Thread: Start from the thread that makes it; everything else on the queue's thread. It may be
/// destroyed once done() and the queue is drained.
class Robot final {
 public:
  Robot(RobotOptions options, Agent agent, grpc::CompletionQueue& queue, const Clock& clock,
        Shared& shared);
  ~Robot();
  Robot(const Robot&) = delete;
  Robot& operator=(const Robot&) = delete;

  /// Sets the first alarm, `after` from now: a fleet does not connect in one instant.
  void Start(milliseconds after);
  [[nodiscard]] bool done() const { return done_; }
  [[nodiscard]] RobotOutcome TakeOutcome() { return agent_.TakeOutcome(options_.ruri); }

 private:
  enum class State : std::uint8_t { kIdle, kOpening, kStreaming, kEnding };
  template <void (Robot::*Handler)(bool)>
  class Handled;
  struct Call;

  void OnTick(bool ok);
  void OnStarted(bool ok);
  void OnRead(bool ok);
  void OnWritten(bool ok);
  void OnHalfClosed(bool ok);
  void OnFinished(bool ok);

  void Open();
  void Write(const v1::RelayRequest& frame);
  void Pump();
  void Break();
  void EndIfQuiet();
  void ArmTick();
  void ForgetChannel();
  [[nodiscard]] milliseconds NextBackoff();

  RobotOptions options_;
  Agent agent_;
  grpc::CompletionQueue& queue_;
  const Clock& clock_;
  Shared& shared_;
  std::mt19937_64 random_;

  std::unique_ptr<Tag> tick_tag_;
  std::unique_ptr<Tag> started_tag_;
  std::unique_ptr<Tag> read_tag_;
  std::unique_ptr<Tag> written_tag_;
  std::unique_ptr<Tag> half_closed_tag_;
  std::unique_ptr<Tag> finished_tag_;
  grpc::Alarm alarm_;

  std::unique_ptr<v1::UplinkRelay::Stub> stub_;
  std::unique_ptr<Call> call_;
  State state_ = State::kIdle;
  SteadyTime next_open_{};
  SteadyTime opened_{};
  SteadyTime next_tick_{};
  int failures_ = 0;
  bool done_ = false;
};

}  // namespace uplink::synthetic
