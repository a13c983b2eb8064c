#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/robot/robot.h"
#include "server/session/context.h"
#include "server/session/hello.h"
#include "server/transport/end_cause.h"

namespace uplink::session {

/// One stream's attachment to its robot, from its Hello to its end: its standing among the robot's
/// streams, and the session that it opened. Confined to the stream's thread.
class Attachment final {
 public:
  Attachment(const SessionContext& context, loop::StreamRef self)
      : context_(context), self_(self) {}

  /// Admits the robot. Returns how long the stream must wait before Attach: zero unless streams of
  /// the robot come too often (robot::Reconnects).
  ///
  /// Errors: kResourceExhausted if the server admits no more robots, or no more of the gateway's,
  ///         or no more streams of this one may wait; kPermissionDenied if the robot is of another
  ///         fleet than the gateway that speaks for it; kUnauthenticated if the fleet's name is odd
  ///         and new (fleet::OddFleets), kUnavailable while the store was not read for that; those
  ///         of fleet::StatusOfEntry.
  [[nodiscard]] absl::StatusOr<milliseconds> Admit(HelloTerms terms);
  /// The status with which a stream of this standing must end; OK if it goes on.
  [[nodiscard]] absl::Status EndOf(robot::Standing standing) const;
  /// The cause of that end.
  [[nodiscard]] static transport::EndCause CauseOf(robot::Standing standing);
  /// Attaches the stream to the robot, and wakes the streams that it replaces. After Admit, and
  /// after the wait.
  [[nodiscard]] robot::Standing Attach();
  /// The wait has ended, or the stream ends during it. Idempotent.
  void EndWait();
  /// Begins the session and asks the store for its cursor. Returns the mark for what the stream
  /// appends.
  ///
  /// Errors: kResourceExhausted if all sessions of the robot wait for the store; kPermissionDenied
  ///         if the robot came into another fleet than its gateway's since Admit, or was blocked.
  [[nodiscard]] absl::StatusOr<journal::AppendedBy> Open(SteadyTime now);
  /// The contents of Welcome.
  [[nodiscard]] robot::Resume Resume();
  /// The stream says that the robot is parked; its signs of life do not end that.
  void Park(SystemTime until);
  /// Until when the stream said so; nothing if it did not.
  [[nodiscard]] std::optional<SystemTime> parked_until() const { return parked_until_; }
  /// The stream takes no more frames: wakes the one that waits for the robot.
  void Detach();

  /// The robot given to Admit; empty before.
  [[nodiscard]] const std::string& ruri() const { return terms_.claim.robot.ruri; }
  /// The robot; from Admit on.
  [[nodiscard]] robot::Robot& robot() { return *robot_; }
  /// The stream is one of the robot's. The functions below need that.
  [[nodiscard]] bool attached() const { return attached_; }
  [[nodiscard]] const model::SessionId& session() const { return terms_.session; }
  [[nodiscard]] loop::StreamRef self() const { return self_; }
  /// From Admit on.
  [[nodiscard]] const fleet::Claim& claim() const { return terms_.claim; }
  /// Hello.agent_version, as it came.
  [[nodiscard]] const std::string& agent_version() const { return terms_.agent_version; }
  /// Older streams of the robot that it took over from.
  [[nodiscard]] std::uint32_t takeovers() const { return takeovers_; }
  /// Hello.declines_forwards.
  [[nodiscard]] bool declines_forwards() const { return terms_.declines_forwards; }
  [[nodiscard]] journal::Journal& journal() const { return context_.journals.Of(robot_->ruri()); }
  /// Wakes the stream once the journal has room for it and its gateway.
  void WakeWhenRoom() { journal().WhenRoom(self_, gateway_); }
  [[nodiscard]] robot::Standing standing() const { return robot_->sessions.StandingOf(self_); }
  /// The store has answered Open.
  [[nodiscard]] bool opened() const { return robot_->sessions.Opened(open_id_); }
  /// Messages of the session that wait for their commit.
  [[nodiscard]] std::size_t waiting() const { return robot_->sessions.waiting(terms_.session); }
  /// As robot::RobotSessions::UnreadOf, AddPage and AwaitsRejects.
  [[nodiscard]] std::optional<robot::UnreadRejects> Unread() const {
    return robot_->sessions.UnreadOf(terms_.session);
  }
  void AddPage(std::vector<storage::StoredReject> page, model::Seq through) {
    robot_->sessions.AddPage(terms_.session, std::move(page), through);
  }
  [[nodiscard]] bool AwaitsRejects() const {
    return robot_->sessions.AwaitsRejects(terms_.session);
  }
  /// The session's progress, with the store's Rejects that were not reported yet.
  [[nodiscard]] robot::Progress TakeProgress() { return robot_->sessions.Take(terms_.session); }

 private:
  /// Puts the robot into the fleet of its certificate. False if the claim does not move robots
  /// (fleet::Entry::Moves), and the robot is in another fleet by now.
  [[nodiscard]] bool ClaimFleet();
  /// Whether a stream may name this fleet (fleet::OddFleets).
  [[nodiscard]] fleet::Refusal JudgeFleet() const;
  /// Counts the refusal, and returns the peer's status.
  [[nodiscard]] absl::Status Refused(fleet::Refusal refusal) const;

  const SessionContext& context_;
  const loop::StreamRef self_;
  HelloTerms terms_;
  /// From Admit on.
  fleet::RobotPtr robot_;
  robot::Reconnects::Arrival arrival_;
  bool waits_ = false;
  /// Its claim has moved the robot from another fleet.
  bool moved_ = false;
  bool attached_ = false;
  std::optional<SystemTime> parked_until_;
  std::uint32_t takeovers_ = 0;
  std::uint64_t open_id_ = 0;
  /// From Open on; null for a robot without a gateway.
  journal::GatewayRef gateway_;
};

}  // namespace uplink::session
