#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <absl/status/status.h>

#include "schema/base/clock.h"
#include "schema/model/uncrew/types.h"
#include "schema/uncrew/judge.h"
#include "schema/uncrew/limits.h"
#include "server/ingest/port.h"
#include "server/robot/connection_reports.h"
#include "server/transport/call_handler.h"
#include "server/uncrew/drones.h"
#include "server/uncrew/limits.h"
#include "server/uncrew/probe.h"

namespace uplink::uncrew {

/// What the calls of one thread share. The references outlive it. Confined to the thread.
struct AvatarThread {
  /// The event clock of the thread, which stands still during an event.
  const Clock& clock;
  /// Measures the time until an answer.
  const Clock& watch;
  Drones& drones;
  AvatarProbe& probe;
  /// uncrew.answer_within and uncrew.ruri_template.
  milliseconds answer_within;
  std::string ruri_template;
  ingest::Port port;
  /// Where the drones' connections are reported; null: nowhere.
  robot::ConnectionReports* reports = nullptr;
};

/// One Publish call: its sample is judged, offered to its drone, and answered at once or after its
/// commit.
///
/// Thread: confined to its connection's.
class AvatarCall final : public transport::CallHandler {
 public:
  AvatarCall(AvatarThread& thread, transport::ServedCall& call, model::uncrew::SampleType type)
      : thread_(thread), call_(call), type_(type) {}
  ~AvatarCall() override { End(); }
  AvatarCall(const AvatarCall&) = delete;
  AvatarCall& operator=(const AvatarCall&) = delete;

  // transport::CallHandler
  void Start() override;
  [[nodiscard]] std::uint64_t message_bytes_max() const override { return kRequestBytesMax; }
  void OnMessage(std::string_view bytes) override;
  void OnTooLarge(std::uint64_t bytes) override;
  void OnHalfClose() override {}
  void OnBroken(const transport::Ending& ending) override;
  void OnWritten() override {}
  void OnWake() override;
  void OnTimer() override;
  [[nodiscard]] std::optional<SteadyTime> deadline() const override;
  void OnDrain(milliseconds grace) override;

 private:
  [[nodiscard]] absl::Status FindDrone();
  /// Counts the call for the connection that it came by.
  void CountForConnection(const std::string& gateway);
  void Offer();
  void Take(Drone::Offered offered);
  void OnCommitted(const Ticket& ticket);
  void Tell(const Answer& answer);
  /// Ends the call without an answer.
  void Fail(const absl::Status& status, Outcome outcome);
  void FailWithoutRequest(const absl::Status& status);
  void Count(Outcome outcome);
  /// Lets go of the drone. Idempotent.
  void End();

  AvatarThread& thread_;
  transport::ServedCall& call_;
  const model::uncrew::SampleType type_;
  SteadyTime began_;
  SystemTime began_system_;
  /// By AvatarThread::watch.
  SteadyTime arrived_;
  /// The deadline of the request, then of its answer.
  SteadyTime answer_by_;
  bool awaits_request_ = false;
  /// When to offer a sample again that had no room.
  std::optional<SteadyTime> again_at_;
  milliseconds again_in_ = kRoomAgain;
  std::string request_;
  Judgement judged_;
  storage::SampleDigest digest_{};
  /// Null before the message, and after the end.
  DronePtr drone_;
  /// Null while it does not wait for a commit.
  TicketRef ticket_;
  Answer once_committed_;
  /// The sample waits before the journal, and is counted as in flight.
  bool is_held_ = false;
};

}  // namespace uplink::uncrew
