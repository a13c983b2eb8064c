#include "server/uncrew/avatar_call.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "server/robot/mutation.h"
#include "server/uncrew/drone_connections.h"
#include "server/uncrew/limits.h"
#include "server/uncrew/publish_response.h"
#include "server/uncrew/sample_digest.h"
#include "server/uncrew/speaker.h"

namespace uplink::uncrew {
namespace {

absl::Status NotInTime() {
  return absl::UnavailableError(
      "the store did not confirm the sample in time: send the same sample again");
}

absl::Status NoRequest() {
  return absl::DeadlineExceededError("the request did not come whole within uncrew.answer_within");
}

}  // namespace

void AvatarCall::Start() {
  began_ = thread_.clock.Steady();
  began_system_ = thread_.clock.System();
  answer_by_ = began_ + thread_.answer_within;
  awaits_request_ = true;
  call_.RequestMessage();
}

void AvatarCall::OnTooLarge(std::uint64_t bytes) {
  awaits_request_ = false;
  Fail(absl::ResourceExhaustedError(
           fmt::format("the request has {} bytes, the limit is {}", bytes, kRequestBytesMax)),
       Outcome::kRefused);
}

void AvatarCall::OnMessage(std::string_view bytes) {
  awaits_request_ = false;
  arrived_ = thread_.watch.Steady();
  began_ = thread_.clock.Steady();
  began_system_ = thread_.clock.System();
  answer_by_ = began_ + thread_.answer_within;
  request_ = std::string(bytes);
  judged_ = Judge(type_, request_);
  digest_ = DigestOf(type_, request_);
  if (const absl::Status found = FindDrone(); !found.ok()) {
    return Fail(found, absl::IsUnavailable(found) ? Outcome::kUnavailable : Outcome::kRefused);
  }
  Offer();
}

absl::Status AvatarCall::FindDrone() {
  if (!judged_.decoded && call_.peer().role == identity::Role::kGateway) {
    return absl::PermissionDeniedError(
        "a gateway must name the drone that it speaks for, and the request cannot be decoded");
  }
  const auto claim = SpeakerOf(call_.peer(), judged_.metadata.uav_id, thread_.ruri_template);
  if (!claim.ok()) return claim.status();
  auto drone = thread_.drones.Enter(*claim);
  if (!drone.ok()) return drone.status();
  drone_ = *std::move(drone);
  CountForConnection(claim->gateway);
  return absl::OkStatus();
}

void AvatarCall::CountForConnection(const std::string& gateway) {
  transport::PeerConnection* connection = call_.connection();
  if (connection == nullptr || thread_.reports == nullptr) return;
  if (connection->user() == nullptr) {
    connection->SetUser(std::make_unique<DroneConnections>(DroneConnections::Context{
        .clock = thread_.clock, .reports = *thread_.reports, .connection = *connection}));
  }
  // Only these calls set a user.
  static_cast<DroneConnections&>(*connection->user())
      .Count(drone_->robot(), gateway, request_.size());
}

void AvatarCall::Offer() {
  again_at_.reset();
  Drone::Offered offered = drone_->Offer(thread_.port,
                                         {.judged = judged_,
                                          .request = request_,
                                          .digest = digest_,
                                          .arrived = began_,
                                          .arrived_system = began_system_,
                                          .is_counted = is_held_},
                                         call_.self());
  using Is = Drone::Offered::Is;
  const bool was_held =
      std::exchange(is_held_, offered.is == Is::kNoRoom || offered.is == Is::kUnclaimed);
  if (is_held_ && !was_held) {
    thread_.port.CountHeld();
    thread_.port.Publish();
  }
  Take(std::move(offered));
}

void AvatarCall::Take(Drone::Offered offered) {
  switch (offered.is) {
    case Drone::Offered::Is::kAnswer:
      return Tell(offered.answer);
    case Drone::Offered::Is::kWaits:
      if (robot::Planted(robot::Mutation::kSampleAnsweredEarly)) {
        drone_->Forget(offered.ticket, call_.self());
        return Tell(offered.answer);
      }
      ticket_ = std::move(offered.ticket);
      once_committed_ = std::move(offered.answer);
      return;
    case Drone::Offered::Is::kNoRoom:
      again_at_ = thread_.clock.Steady() + again_in_;
      again_in_ = std::min(2 * again_in_, kRoomAgainMax);
      return;
    case Drone::Offered::Is::kUnclaimed:
      return;
    case Drone::Offered::Is::kOtherFleet:
      return Fail(absl::PermissionDeniedError(
                      "the drone is of another fleet, and the certificate does not name it"),
                  Outcome::kRefused);
    case Drone::Offered::Is::kBlocked:
      return Fail(absl::PermissionDeniedError("blocked"), Outcome::kRefused);
    case Drone::Offered::Is::kNotRegistered:
      return Fail(
          fleet::StatusOfEntry(fleet::Refusal::kNotRegistered, {.robot = *drone_->robot()->id()}),
          Outcome::kRefused);
  }
}

void AvatarCall::OnWake() {
  if (drone_ == nullptr) return;
  if (ticket_ == nullptr) return Offer();
  const Ticket ticket = drone_->Look(ticket_);
  switch (ticket.state) {
    case Ticket::State::kWaiting:
      return;
    case Ticket::State::kCommitted:
      return OnCommitted(ticket);
    case Ticket::State::kVoid:
      ticket_.reset();
      return Offer();
  }
}

void AvatarCall::OnCommitted(const Ticket& ticket) {
  Answer answer = std::move(once_committed_);
  if (answer.outcome == Outcome::kStored && ticket.was_stored) answer.outcome = Outcome::kDuplicate;
  if (answer.outcome == Outcome::kStored || answer.outcome == Outcome::kDuplicate) {
    if (ticket.refused) answer = {.outcome = Outcome::kRejected, .rejection = ticket.refused};
  }
  Tell(answer);
}

void AvatarCall::OnTimer() {
  const SteadyTime now = thread_.clock.Steady();
  if (awaits_request_ && now >= answer_by_) return FailWithoutRequest(NoRequest());
  if (drone_ == nullptr) return;
  if (now >= answer_by_) return Fail(NotInTime(), Outcome::kUnavailable);
  if (again_at_ && now >= *again_at_) Offer();
}

std::optional<SteadyTime> AvatarCall::deadline() const {
  if (awaits_request_) return answer_by_;
  if (drone_ == nullptr) return std::nullopt;
  return again_at_ ? std::min(*again_at_, answer_by_) : answer_by_;
}

void AvatarCall::OnDrain(milliseconds grace) {
  if (awaits_request_) {
    return FailWithoutRequest(absl::UnavailableError("the server drains: send it to another"));
  }
  // The drone sends a sample that still waits then again, to another server.
  answer_by_ = std::min(answer_by_, thread_.clock.Steady() + grace);
}

void AvatarCall::OnBroken(const transport::Ending& /*ending*/) {
  if (drone_ != nullptr) Count(Outcome::kUnavailable);
  End();
}

void AvatarCall::FailWithoutRequest(const absl::Status& status) {
  awaits_request_ = false;
  Fail(status, Outcome::kRefused);
}

void AvatarCall::Tell(const Answer& answer) {
  if (answer.outcome == Outcome::kUnavailable) {
    return Fail(absl::UnavailableError("the drone is held by another server, or is let go of: "
                                       "send the same sample again"),
                Outcome::kUnavailable);
  }
  Count(answer.outcome);
  AnswerSeconds& seconds = thread_.probe.answer_seconds;
  (ticket_ == nullptr ? seconds.live : seconds.durable)
      .ObserveSince(arrived_, thread_.watch.Steady());
  ticket_.reset();
  End();
  call_.Write(transport::WithPrefix(ResponseOf(answer, judged_)));
  call_.Finish(absl::OkStatus());
}

void AvatarCall::Fail(const absl::Status& status, Outcome outcome) {
  Count(outcome);
  if (outcome == Outcome::kUnavailable) {
    thread_.probe.answer_seconds.durable.ObserveSince(arrived_, thread_.watch.Steady());
  }
  End();
  if (outcome == Outcome::kRefused) return call_.FinishRefused(status);
  call_.Finish(status);
}

void AvatarCall::Count(Outcome outcome) {
  thread_.probe.publishes_total[static_cast<std::size_t>(type_)][static_cast<std::size_t>(outcome)]
      .Add();
}

void AvatarCall::End() {
  if (drone_ == nullptr) return;
  if (std::exchange(is_held_, false)) {
    thread_.port.Count({.is_counted = true}, metrics::Became::kRefused);
    thread_.port.Publish();
  }
  drone_->Forget(ticket_, call_.self());
  drone_->Leave();
  drone_.reset();
}

}  // namespace uplink::uncrew
