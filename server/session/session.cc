#include "server/session/session.h"

#include <utility>

#include <fmt/format.h>

#include "server/session/batch_check.h"
#include "server/session/end_status.h"
#include "server/session/frames.h"
#include "server/session/goodbye.h"

namespace uplink::session {
using transport::EndCause;

Session::Session(const SessionContext& context, Peer peer, loop::StreamRef self,
                 FrameSource& source, FrameSink& sink)
    : context_(context),
      peer_(std::move(peer.identity)),
      sink_(sink),
      robot_(context_, self),
      hello_wait_(context_.pressed),
      reading_({.context = context_, .robot = robot_, .source = source, .timers = timers_}),
      outgoing_({.context = context_, .robot = robot_, .sink = sink_, .timers = timers_}),
      reject_pages_({.context = context_, .robot = robot_, .timers = timers_}),
      resends_({context_, robot_, outgoing_, timers_}),
      settling_({context_, robot_, outgoing_, reading_, timers_}),
      report_({context_, robot_, reading_, peer.connection}) {
  context_.probe.streams.Add();
  context_.probe.streams_total.Add();
}

Session::~Session() {
  Leave({});
  context_.probe.streams.Add(-1);
}

// --- Frames ---

void Session::OnFrame(std::string_view bytes) {
  reading_.OnAnswer();
  slow_frame_.End();
  if (state_ != State::kHello && state_ != State::kStreaming) return;
  ++frames_;
  context_.probe.frames_total.Add();
  context_.probe.frame_bytes_total.Add(static_cast<std::int64_t>(bytes.size()));
  report_.CountFrame(bytes.size());
  switch (ReadFrame(bytes, context_.scratch.batch, context_.limits.batch_uplinks_max)) {
    case FrameContent::kMalformed:
      return ProtocolError(kNoRequest);
    case FrameContent::kForeign:
      return ProtocolError(kForeignRequest);
    case FrameContent::kHello:
      return HandleHello(bytes);
    case FrameContent::kBatch:
      if (state_ == State::kHello) return ProtocolError("the first frame must be a hello");
      return HandleBatch();
    case FrameContent::kGoodbye:
      if (state_ == State::kHello) return ProtocolError("the first frame must be a hello");
      if (!TakeGoodbye(bytes, context_, robot_, outgoing_)) return ProtocolError(kNoRequest);
      return Advance(News::kNone);
    case FrameContent::kNothing:
      return ProtocolError("it holds neither hello, batch nor goodbye");
  }
}

void Session::OnFrameTooLarge(std::uint64_t bytes) {
  reading_.OnAnswer();
  if (state_ != State::kHello && state_ != State::kStreaming) return;
  ++frames_;
  if (bytes <= context_.limits.frame_bytes_max) return ProtocolError(kForeignRequest);
  context_.probe.protocol_errors_total.Add();
  Finish(FrameTooLarge(frames_, bytes, context_.limits.frame_bytes_max), EndCause::kBrokeRules);
}

void Session::HandleHello(std::string_view bytes) {
  v1::RelayRequest frame;
  if (!frame.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
    return ProtocolError(kNoRequest);
  }
  if (state_ != State::kHello) return ProtocolError("hello: only the first frame may be one");
  timers_.Clear(Timer::kHello);
  auto terms = CheckHello(frame.hello(), std::exchange(peer_, {}));
  if (!terms.ok()) {
    context_.probe.CountRefusedHello(terms.status());
    return Finish(terms.status(), EndCause::kBrokeRules);
  }
  const absl::StatusOr<milliseconds> delay = robot_.Admit(*std::move(terms));
  if (!delay.ok()) return Finish(delay.status(), EndCause::kBound);
  if (*delay == milliseconds(0)) return Attach();
  state_ = State::kDelayed;
  timers_.Set(Timer::kAttach, context_.clock.Steady() + *delay);
}

void Session::Attach() {
  timers_.Clear(Timer::kAttach);
  state_ = State::kAttaching;
  FollowStanding(robot_.Attach());
}

void Session::BeginOpening() {
  const SteadyTime now = context_.clock.Steady();
  auto by = robot_.Open(now);
  if (!by.ok()) return Finish(by.status(), CauseOfRefusal(by.status()));
  report_.Begin(now);
  state_ = State::kOpening;
  timers_.Set(Timer::kWelcome, now + kWelcomeWait);
  intake_ = std::make_unique<Intake>(
      Intake::Sources{context_, robot_.robot(), timers_, robot_.session(), *std::move(by)});
}

void Session::SendWelcome() {
  timers_.Clear(Timer::kWelcome);
  state_ = State::kStreaming;
  outgoing_.Begin(robot_.Resume());
  resends_.Begin();
  Advance(News::kNone);
}

void Session::HandleBatch() {
  const BatchView& batch = context_.scratch.batch;
  if (auto status = CheckBatch(batch, last_seq_, context_.limits, frames_); !status.ok()) {
    context_.probe.protocol_errors_total.Add();
    return Finish(status, EndCause::kBrokeRules);
  }
  const SteadyTime now = context_.clock.Steady();
  const SystemTime system_now = context_.clock.System();
  robot_.robot().state.NoteBatch(batch.head, now, system_now);
  report_.CountMessages(batch.uplinks.size(), now);
  if (!batch.uplinks.empty()) {
    last_seq_ = batch.uplinks.back().seq;
    intake_->Begin(batch.uplinks, now, system_now);
  }
  Advance(News::kNone);
}

// --- What every call ends with ---

void Session::Advance(News news) {
  ProcessAndWrite(news);
  EndForRejects();
  EndWhenSettled();
  if (news != News::kLastFrame) Read();
}

void Session::ProcessAndWrite(News news) {
  if (intake_ != nullptr && intake_->due()) {
    outgoing_.AddProcessed(intake_->Process(outgoing_.size()));
    // Pending messages must not point into the frame's bytes, which are the transport's, nor into
    // the scratch that all streams of the thread share.
    intake_->Keep();
  }
  if (state_ == State::kStreaming) resends_.Follow();
  if (reject_pages_.Collect() || news == News::kCommits) outgoing_.AddProgress();
  outgoing_.Flush();
  if (state_ != State::kStreaming && state_ != State::kSettling) return;
  reject_pages_.Ask(outgoing_.size());
}

bool Session::EndForRejects() {
  if (state_ != State::kStreaming || !intake_->rejects_full()) return false;
  // Messages that were not judged were not processed: the agent sends them again.
  intake_->Drop();
  state_ = State::kSettling;
  settling_.BeginUnconfirmed();
  return true;
}

void Session::EndWhenSettled() {
  if (state_ != State::kSettling || intake_->pending()) return;
  if (const std::optional<absl::Status> status = settling_.StatusWhenSettled()) {
    Finish(*status, settling_.cause());
  }
}

void Session::Read() {
  if (reading_.under_way()) return reading_.WatchPeer(outgoing_.size());
  if (state_ != State::kStreaming) return;
  // The last look decides: the stream then waits for what blocks it.
  ingest::Block block = intake_->FindBlock(outgoing_.size());
  while (intake_->pending() && block.none()) {
    if (intake_->yields()) return robot_.self().Wake();
    ProcessAndWrite(News::kNone);
    if (EndForRejects()) return EndWhenSettled();
    block = intake_->FindBlock(outgoing_.size());
  }
  reading_.WatchPeer(outgoing_.size());
  reading_.RequestUnless(block);
}

// --- Writes, wakes, timers ---

void Session::OnWritten() {
  outgoing_.OnWritten();
  if (state_ == State::kDone) return;
  timers_.Clear(Timer::kStall);
  settling_.OnWritten();
  Advance(News::kNone);
}

void Session::OnWake() {
  if (state_ == State::kDone || !robot_.attached()) return;
  outgoing_.BeginTurn();
  if (!FollowStanding(robot_.standing())) return;
  if (robot_.robot().state.TakeAskPeer()) sink_.AskPeer();
  if (state_ != State::kOpening) return Advance(News::kCommits);
  if (robot_.opened()) SendWelcome();
}

bool Session::FollowStanding(robot::Standing standing) {
  if (const absl::Status end = robot_.EndOf(standing); !end.ok()) {
    if (standing == robot::Standing::kSuperseded) context_.probe.superseded_total.Add();
    Finish(end, Attachment::CauseOf(standing));
  }
  if (standing != robot::Standing::kCurrent) return false;
  if (state_ == State::kAttaching) BeginOpening();
  return state_ != State::kDone;
}

void Session::OnTimer() {
  if (state_ == State::kDone) return;
  const SteadyTime now = context_.clock.Steady();
  if (timers_.Due(Timer::kHello, now)) {
    if (const auto over = hello_wait_.Over(now)) {
      frames_ = 1;
      return ProtocolError(fmt::format("no hello within {} s", over->count()));
    }
    timers_.Set(Timer::kHello, hello_wait_.NextLook(now));
  }
  if (timers_.Due(Timer::kAttach, now)) return Attach();
  if (state_ == State::kOpening && timers_.Due(Timer::kWelcome, now)) return SendWelcome();
  if (timers_.Due(Timer::kSettle, now)) {
    return Finish(NotSettled(), settling_.cause());
  }
  if (timers_.Due(Timer::kStall, now)) {
    context_.probe.peer_stalls_total.Add();
    Finish(ReadNothing(outgoing_.size()), EndCause::kNotRead);
    return sink_.Cancel();
  }
  if (timers_.Due(Timer::kAck, now)) {
    timers_.Clear(Timer::kAck);
    outgoing_.MakeAckDue();
  }
  Advance(News::kNone);
}

// --- How a stream ends: half-closed, drained, broken, invalid ---

void Session::OnHalfClose() {
  reading_.OnAnswer();
  if (state_ == State::kHello) {
    ++frames_;
    return ProtocolError("the stream was half-closed before a hello");
  }
  if (state_ != State::kStreaming) return;
  state_ = State::kSettling;
  settling_.BeginHalfClosed();
  Advance(News::kLastFrame);
}

void Session::OnDrain(milliseconds grace, EndCause cause) {
  if (state_ == State::kDone) return;
  if (state_ != State::kStreaming && state_ != State::kSettling) return Finish(Drained(), cause);
  outgoing_.Push(DrainFrame(grace));
  if (state_ == State::kStreaming) {
    intake_->Drop();  // the agent sends it again
    state_ = State::kSettling;
    settling_.BeginDrained(cause);
  }
  settling_.EndWithin(grace);
  Advance(News::kLastFrame);
}

void Session::ProtocolError(std::string_view rule) {
  context_.probe.protocol_errors_total.Add();
  Finish(absl::InvalidArgumentError(fmt::format("frame {}: {}", frames_, rule)),
         EndCause::kBrokeRules);
}

void Session::Finish(const absl::Status& status, EndCause cause) {
  if (state_ == State::kDone) return;
  context_.probe.CountEnd(status.code());
  Leave(transport::EndingWith(cause, status));
  sink_.Finish(status);
}

void Session::Leave(const transport::Ending& ending) {
  if (state_ == State::kDone) return;
  state_ = State::kDone;
  outgoing_.EndForwards();
  robot_.EndWait();
  resends_.End();
  if (robot_.attached()) {
    if (intake_ != nullptr) intake_->End();
    reading_.SetReading(ReadGate::Reading::kFlowing);
    robot_.Detach();
  }
  report_.End(ending);
}

}  // namespace uplink::session
