#include "server/session/session.h"

#include <utility>

#include <fmt/format.h>

#include "server/session/batch_check.h"
#include "server/session/frames.h"

namespace uplink::session {
namespace {

constexpr std::string_view kNoRequest =
    "not a RelayRequest (bad protobuf, or a text that is not UTF-8)";

}  // namespace

Session::Session(const SessionContext& context, identity::PeerIdentity peer, robot::StreamRef self,
                 FrameSource& source, FrameSink& sink)
    : context_(context), peer_(std::move(peer)), self_(self), source_(source), sink_(sink) {
  context_.probe.streams.Add();
  context_.probe.streams_total.Add();
}

Session::~Session() {
  Leave();
  context_.probe.streams.Add(-1);
}

void Session::Start() {
  hello_until_ = context_.clock.Steady() + kHelloWait;
  Read();
}

void Session::OnFrame(std::string_view bytes) {
  read_under_way_ = false;
  if (state_ != State::kHello && state_ != State::kStreaming) return;
  ++frames_;
  context_.probe.frames_total.Add();
  context_.probe.frame_bytes_total.Add(static_cast<std::int64_t>(bytes.size()));
  switch (ReadFrame(bytes, context_.scratch.batch)) {
    case FrameContent::kMalformed:
      return ProtocolError(kNoRequest);
    case FrameContent::kHello:
      return TakeHelloFrame(bytes);
    case FrameContent::kBatch:
      if (state_ == State::kHello) return ProtocolError("the first frame must be a hello");
      return TakeBatch();
    case FrameContent::kNothing:
      return ProtocolError("it holds neither hello nor batch");
  }
}

void Session::TakeHelloFrame(std::string_view bytes) {
  v1::RelayRequest frame;
  if (!frame.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
    return ProtocolError(kNoRequest);
  }
  if (state_ != State::kHello) return ProtocolError("hello: only the first frame may be one");
  TakeHello(frame.hello());
}

void Session::OnFrameTooLarge(std::uint64_t bytes) {
  read_under_way_ = false;
  if (state_ != State::kHello && state_ != State::kStreaming) return;
  ++frames_;
  context_.probe.protocol_errors_total.Add();
  Finish(absl::ResourceExhaustedError(
      fmt::format("frame {}: {} bytes, the limit is {} (limits.frame_bytes_max)", frames_, bytes,
                  context_.limits.frame_bytes_max)));
}

void Session::ProtocolError(std::string_view rule) {
  context_.probe.protocol_errors_total.Add();
  Finish(absl::InvalidArgumentError(fmt::format("frame {}: {}", frames_, rule)));
}

void Session::TakeHello(const v1::Hello& hello) {
  hello_until_.reset();
  auto terms = CheckHello(hello, peer_);
  if (!terms.ok()) {
    const bool identity =
        absl::IsUnauthenticated(terms.status()) || absl::IsPermissionDenied(terms.status());
    (identity ? context_.probe.refused_identity_total : context_.probe.protocol_errors_total).Add();
    return Finish(terms.status());
  }
  hello_ = *std::move(terms);
  const auto robot = context_.fleet.FindOrAdmit(hello_.robot);
  if (!robot.ok()) {
    context_.probe.refused_full_total.Add();
    return Finish(robot.status());
  }
  robot_ = *robot;
  const robot::Takeover::Attached attached =
      robot_->sessions.Attach(self_, context_.clock.Steady(), context_.clock.System());
  if (attached.took_over) context_.probe.takeovers_total.Add();
  if (attached.contested) context_.probe.contested_total.Add();
  for (const robot::StreamRef stream : attached.to_wake) stream.Wake();
  if (attached.place == robot::StreamPlace::kCurrent) return BeginOpening();
  state_ = State::kAttaching;
}

void Session::BeginOpening() {
  const SteadyTime now = context_.clock.Steady();
  const auto begun = robot_->sessions.Begin(hello_.session, now);
  if (!begun) {
    return Finish(absl::ResourceExhaustedError(
        fmt::format("all {} sessions of the robot wait for the store", robot::kSessionsMax)));
  }
  open_id_ = begun->open_id;
  state_ = State::kOpening;
  welcome_at_ = now + kWelcomeWait;
  intake_ =
      std::make_unique<Intake>(context_, *robot_, robot_->id(), hello_.session, begun->generation);
  context_.journals.Of(robot_->ruri())
      .Open(robot_->sessions, open_id_,
            {.robot = robot_->id(),
             .session = hello_.session,
             .settled_seq = hello_.settled_seq,
             .at = context_.clock.System(),
             .sessions_held = robot_->sessions.Held()});
}

void Session::SendWelcome() {
  welcome_at_.reset();
  state_ = State::kStreaming;
  robot_->state.StreamBegan();
  const robot::Resume resume =
      robot_->sessions.ResumeFrom(hello_.session, open_id_, hello_.settled_seq, hello_.judged_seq);
  if (resume.committed > 0) context_.probe.resumes_total.Add();
  outgoing_.push_back(
      WelcomeFrame(robot_->ruri(), resume.committed, context_.limits, context_.clock.System()));
  for (const robot::RejectedSeq& rejected : resume.rejects) {
    outgoing_.push_back(RejectFrame(rejected.seq, rejected.rejection));
  }
  ack_due_ = true;
  Flush();
  Read();
}

void Session::TakeBatch() {
  const BatchView& batch = context_.scratch.batch;
  const absl::Status status = CheckBatch(batch, last_seq_, context_.limits, frames_);
  if (!status.ok()) {
    context_.probe.protocol_errors_total.Add();
    return Finish(status);
  }
  const SystemTime now = context_.clock.System();
  if (batch.sent_unix_ms > 0) {
    robot_->state.NoteClockSkew(batch.sent_unix_ms - UnixMs(now));
  }
  if (!batch.uplinks.empty()) {
    last_seq_ = batch.uplinks.back().seq;
    intake_->Begin(batch.uplinks, context_.clock.Steady(), now);
    TakePending();
    // The frame's bytes are the transport's, until this returns.
    intake_->Keep();
  }
  Flush();
  Read();
}

void Session::TakePending() {
  Intake::Taken taken = intake_->Take(outgoing_.size());
  for (v1::RelayResponse& frame : taken.frames) outgoing_.push_back(std::move(frame));
  unacked_messages_ += taken.messages;
  if (taken.ack_owed || unacked_messages_ >= kAckMessages) ack_due_ = true;
  if (unacked_messages_ > 0 && !ack_at_) {
    ack_at_ = context_.clock.Steady() + context_.limits.ack_interval;
  }
}

void Session::Read() {
  if (read_under_way_) return NoteStall();
  if (state_ == State::kHello) return RequestRead();
  if (state_ != State::kStreaming) return;
  // One look decides: what keeps the stream back is what it then waits for.
  Hold hold = intake_->Holding(outgoing_.size());
  while (intake_->pending() && hold == Hold::kNone) {
    TakePending();
    hold = intake_->Holding(outgoing_.size());
  }
  Flush();
  NoteStall();
  SetHeldBack(hold != Hold::kNone);
  read_again_at_.reset();
  switch (hold) {
    case Hold::kNone:
      return RequestRead();
    case Hold::kInFlight:  // a commit of the robot wakes the stream
    case Hold::kOutgoing:  // a write that is done calls
      return;
    case Hold::kJournal:
      return context_.journals.Of(robot_->ruri()).WhenRoom(self_);
    case Hold::kThrottled:
      read_again_at_ = intake_->throttle_end();
      return;
  }
}

void Session::RequestRead() {
  read_under_way_ = true;
  source_.RequestRead();
}

void Session::NoteStall() {
  if (outgoing_.size() < kOutgoingFramesMax) {
    stalled_at_.reset();
  } else if (!stalled_at_) {
    stalled_at_ = context_.clock.Steady() + kPeerStallMax;
  }
}

void Session::SetHeldBack(bool held_back) {
  if (held_back_ == held_back) return;
  held_back_ = held_back;
  context_.probe.held_back.Add(held_back ? 1 : -1);
  if (held_back) context_.probe.held_back_total.Add();
  robot_->state.SetReading(
      held_back ? robot::RobotState::Reading::kHeldBack : robot::RobotState::Reading::kFlowing,
      context_.clock.Steady());
}

void Session::OnWritten() {
  write_under_way_ = false;
  if (state_ == State::kDone) return;
  stalled_at_.reset();
  if (intake_ != nullptr && intake_->pending()) TakePending();
  Flush();
  EndWhenSettled();
  Read();
}

void Session::OnWake() {
  if (state_ == State::kDone || robot_ == nullptr) return;
  switch (robot_->sessions.PlaceOf(self_)) {
    case robot::StreamPlace::kSuperseded:
      context_.probe.superseded_total.Add();
      return Finish(absl::AbortedError("superseded"));
    case robot::StreamPlace::kWaiting:
      return;
    case robot::StreamPlace::kCurrent:
      break;
  }
  if (state_ == State::kAttaching) BeginOpening();
  if (state_ == State::kOpening) {
    if (robot_->sessions.Opened(open_id_)) SendWelcome();
    return;
  }
  if (state_ == State::kDone) return;
  if (intake_->pending()) TakePending();
  TakeProgress();
  Flush();
  EndWhenSettled();
  Read();
}

}  // namespace uplink::session
