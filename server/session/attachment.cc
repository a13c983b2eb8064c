#include "server/session/attachment.h"

#include <utility>

#include <fmt/format.h>

#include "server/identity/invisible_characters.h"
#include "server/robot/outcome.h"

namespace uplink::session {

absl::Status Attachment::EndOf(robot::Standing standing) const {
  switch (standing) {
    case robot::Standing::kSuperseded:
      return absl::AbortedError("superseded");
    case robot::Standing::kEnded:
      return absl::UnavailableError("an operator ended the stream");
    case robot::Standing::kWentBack:
      return absl::UnavailableError("the store lost what it had of the robot: resume from Welcome");
    case robot::Standing::kOtherFleet:
      return Refused(fleet::Refusal::kOtherFleet);
    case robot::Standing::kBlocked:
      return fleet::StatusOfEntry(fleet::Refusal::kBlocked, terms_.claim);
    case robot::Standing::kDisconnected:
      return absl::UnavailableError("disconnected by an operator");
    case robot::Standing::kNotRegistered:
      return Refused(fleet::Refusal::kNotRegistered);
    case robot::Standing::kWaiting:
    case robot::Standing::kCurrent:
      break;
  }
  return absl::OkStatus();
}

transport::EndCause Attachment::CauseOf(robot::Standing standing) {
  switch (standing) {
    case robot::Standing::kEnded:
      return transport::EndCause::kForgotten;
    case robot::Standing::kWentBack:
      return transport::EndCause::kStoreLost;
    case robot::Standing::kOtherFleet:
    case robot::Standing::kNotRegistered:
      return transport::EndCause::kNotAllowed;
    case robot::Standing::kBlocked:
      return transport::EndCause::kBlocked;
    case robot::Standing::kDisconnected:
      return transport::EndCause::kDisconnected;
    case robot::Standing::kSuperseded:
    case robot::Standing::kWaiting:
    case robot::Standing::kCurrent:
      break;
  }
  return transport::EndCause::kSuperseded;
}

absl::Status Attachment::Refused(fleet::Refusal refusal) const {
  const fleet::Claim& claim = terms_.claim;
  switch (refusal) {
    case fleet::Refusal::kNone:
      break;
    case fleet::Refusal::kFull:
      context_.probe.refused_full_total.Add();
      return absl::ResourceExhaustedError(
          fmt::format("the server admits no more than {} robots (limits.robots_max)",
                      context_.fleet.robots_max()));
    case fleet::Refusal::kGatewayFull:
      context_.probe.refused_gateway_total.Add();
      return absl::ResourceExhaustedError(
          fmt::format("gateway {} has brought in {} robots, and may bring in no more",
                      claim.gateway, context_.fleet.gateway_robots_max()));
    case fleet::Refusal::kOtherFleet:
      if (claim.grant != fleet::Grant::kFleet) {
        return Refused(claim.bounds == nullptr ? fleet::Refusal::kFleetStays
                                               : fleet::Refusal::kAuthorityOutside);
      }
      context_.probe.refused_identity_total.Add();
      return absl::PermissionDeniedError(
          fmt::format("the certificate of gateway {} may not speak for hello.robot_ruri {}: the "
                      "robot is of another fleet, and the certificate does not name it",
                      claim.gateway, claim.robot.ruri));
    case fleet::Refusal::kOddFleet:
      context_.probe.refused_identity_total.Add();
      return absl::UnauthenticatedError(fmt::format(
          "client certificate: its O holds U+{:04X}, which is invisible, and the store "
          "has no robot of that fleet",
          static_cast<std::uint32_t>(*identity::InvisibleCharacter(claim.robot.fleet))));
    case fleet::Refusal::kFleetsUnread:
      context_.probe.refused_identity_total.Add();
      return absl::UnavailableError(
          "client certificate: its O holds an invisible character, and the server has not "
          "read yet whether the store has robots of that fleet");
    case fleet::Refusal::kBlocked:
    case fleet::Refusal::kNotRegistered:
      context_.probe.refused_operator_total.Add();
      return fleet::StatusOfEntry(refusal, claim);
    case fleet::Refusal::kGatewayUnnamed:
    case fleet::Refusal::kFleetStays:
    case fleet::Refusal::kAuthorityOutside:
    case fleet::Refusal::kNotCanonical:
    case fleet::Refusal::kRobotsUnread:
      context_.probe.refused_identity_total.Add();
      return fleet::StatusOfEntry(refusal, claim);
  }
  return absl::OkStatus();
}

fleet::Refusal Attachment::JudgeFleet() const {
  using Verdict = fleet::OddFleets::Verdict;
  switch (context_.fleet.odd_fleets().Judge(terms_.claim.robot.fleet)) {
    case Verdict::kFits:
      break;
    case Verdict::kRefused:
      return fleet::Refusal::kOddFleet;
    case Verdict::kUnread:
      return fleet::Refusal::kFleetsUnread;
  }
  return fleet::Refusal::kNone;
}

absl::StatusOr<milliseconds> Attachment::Admit(HelloTerms terms) {
  terms_ = std::move(terms);
  if (const fleet::Refusal refusal = JudgeFleet(); refusal != fleet::Refusal::kNone) {
    return Refused(refusal);
  }
  fleet::Fleet::Admission admission = context_.fleet.FindOrAdmitBy(terms_.claim);
  if (admission.robot == nullptr) return Refused(admission.refusal);
  robot_ = std::move(admission.robot);
  moved_ = admission.moved;
  robot_->NoteHeard(context_.clock.System());
  const SteadyTime now = context_.clock.Steady();
  const auto arrival = robot_->sessions.Arrive(now, context_.limits.reconnects);
  if (!arrival) {
    context_.probe.refused_waiting_total.Add();
    return absl::ResourceExhaustedError(fmt::format(
        "{} streams of the robot wait already: they come too often", robot::kStreamsWaitingMax));
  }
  arrival_ = *arrival;
  if (arrival_.delay == milliseconds(0)) return arrival_.delay;
  waits_ = true;
  context_.probe.delayed_total.Add();
  context_.probe.waiting.Add();
  // Silence during the wait is the server's doing.
  robot_->state.NoteStall(now + arrival_.delay);
  return arrival_.delay;
}

void Attachment::EndWait() {
  if (!std::exchange(waits_, false)) return;
  context_.probe.waiting.Add(-1);
  robot_->sessions.EndWait();
}

robot::Standing Attachment::Attach() {
  EndWait();
  const robot::Takeover::Attached attached =
      robot_->sessions.Attach(self_, context_.clock.Steady(), context_.clock.System(),
                              {.number = arrival_.number, .gateway = terms_.claim.gateway});
  attached_ = attached.standing != robot::Standing::kSuperseded;
  // It may have been asked to leave before its stream was visible.
  context_.fleet.Keep(*robot_);
  if (attached.took_over) {
    ++takeovers_;
    context_.probe.takeovers_total.Add();
  }
  if (attached.contested) context_.probe.contested_total.Add();
  for (const loop::StreamRef stream : attached.to_wake) stream.Wake();
  return attached.standing;
}

bool Attachment::ClaimFleet() {
  const fleet::Claim& claim = terms_.claim;
  const auto now = robot_->id();
  if (now->fleet == claim.robot.fleet) return true;
  // A gateway may have moved it between Admit and now.
  if (!context_.fleet.entry().Moves(claim, now->fleet)) return false;
  robot_->SetFleet(claim.robot.fleet);
  moved_ = true;
  return true;
}

absl::StatusOr<journal::AppendedBy> Attachment::Open(SteadyTime now) {
  // It may have been kept out during the wait, before its stream was visible.
  if (robot_->blocked()) return Refused(fleet::Refusal::kBlocked);
  if (robot_->kept_out()) return Refused(fleet::Refusal::kNotRegistered);
  if (!ClaimFleet()) return Refused(fleet::Refusal::kOtherFleet);
  const auto begun =
      robot_->sessions.Begin(terms_.session, now,
                             {.fleet = terms_.claim.robot.fleet,
                              .word = moved_ || context_.fleet.entry().Moves(terms_.claim)
                                          ? storage::FleetWord::kMoves
                                          : storage::FleetWord::kMatches});
  if (!begun) {
    return absl::ResourceExhaustedError(
        fmt::format("all {} sessions of the robot wait for the store", robot::kSessionsMax));
  }
  if (begun->disowned) {
    context_.ledger.Publish(robot::SupersededCounts(*begun->disowned));
    if (robot_->state.held_since() == 0) robot_->state.Lose();
  }
  open_id_ = begun->open_id;
  gateway_ = journal().GatewayOf(terms_.claim.gateway);
  robot_->state.Claim(now);
  robot_->SetSpeaker(terms_.claim.gateway);
  journal().Open(*robot_, open_id_,
                 {.robot = robot_->id(),
                  .session = terms_.session,
                  .settled_seq = terms_.settled_seq,
                  .at = context_.clock.System(),
                  .sessions_held = robot_->sessions.Held(),
                  .rejects_max = context_.limits.open_rejects_max,
                  .fleet_word = begun->fleet_word},
                 terms_.claim.gateway);
  return journal::AppendedBy(begun->generation, gateway_);
}

robot::Resume Attachment::Resume() {
  robot_->state.BeginStream();
  robot_->rates.BeginStream();
  robot::Resume resume =
      robot_->sessions.ResumeFrom(terms_.session, open_id_, terms_.settled_seq, terms_.judged_seq);
  if (resume.committed > 0) context_.probe.resumes_total.Add();
  return resume;
}

void Attachment::Park(SystemTime until) {
  parked_until_ = until;
  robot_->state.Park(until, context_.clock.Steady());
}

void Attachment::Detach() {
  if (parked_until_) robot_->state.EndParkingStream(context_.clock.Steady());
  robot_->NoteHeard(context_.clock.System());
  robot_->sessions.Detach(self_, context_.clock.Steady()).Wake();
  if (!robot_->HasStream()) robot_->state.EndClaim();
}

}  // namespace uplink::session
