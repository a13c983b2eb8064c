#include "server/relay/call.h"

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

#include <grpc/grpc_security_constants.h>

#include "schema/base/check.h"
#include "server/identity/peer_identity.h"
#include "server/relay/frame_bytes.h"
#include "server/relay/status.h"
#include "server/transport/refusals.h"

namespace uplink::relay {
namespace {

/// Who showed the client certificate that the TLS layer has verified.
absl::StatusOr<identity::PeerIdentity> PeerOf(const grpc::ServerContext& context,
                                              const identity::PeerReader& reader) {
  const auto auth = context.auth_context();
  if (auth == nullptr || !auth->IsPeerAuthenticated()) {
    return absl::UnauthenticatedError("client certificate: none was shown");
  }
  const std::vector<grpc::string_ref> pems =
      auth->FindPropertyValues(GRPC_X509_PEM_CERT_PROPERTY_NAME);
  if (pems.size() != 1) {
    return absl::UnauthenticatedError("client certificate: none was shown");
  }
  return reader.IdentityOf(std::string_view(pems.front().data(), pems.front().size()));
}

}  // namespace

Call::Call(Queue& queue, std::uint64_t id) : queue_(queue), id_(id) {}

Call::~Call() {
  queue_.Forget(id_, timer_);
  session_.reset();
  if (admitted_) queue_.gate().Leave(who_);
}

void Call::Offer() {
  context_.AsyncNotifyWhenDone(&done_tag_);
  ++tags_out_;
  grpc::ServerCompletionQueue& completions = queue_.completions();
  queue_.service().RequestRelay(&context_, &stream_, &completions, &completions, &started_tag_);
}

void Call::OnStarted(bool ok) {
  if (!ok) return;  // the server shuts down; no tag is out
  ++tags_out_;      // the done tag
  queue_.Offer();
  if (const absl::Status status = Admit(); !status.ok()) return Finish(status);
  session_->Start();
}

absl::Status Call::Admit() {
  auto peer = PeerOf(context_, queue_.peer_reader());
  if (!peer.ok()) {
    queue_.relay().probe.refused_identity_total.Add();
    return peer.status();
  }
  who_ = transport::EntrantOf(*peer);
  if (absl::Status status = queue_.gate().Enter(who_); !status.ok()) return status;
  admitted_ = true;
  session_.emplace(queue_.session_context(), *std::move(peer), robot::StreamRef{&queue_, id_},
                   *this, *this);
  return absl::OkStatus();
}

void Call::RequestRead() {
  UPLINK_CHECK(!reading_, "a read is under way");
  reading_ = true;
  ++tags_out_;
  stream_.Read(&received_, &read_tag_);
}

void Call::OnRead(bool ok) {
  reading_ = false;
  if (broken_ || finishing()) return;
  if (!ok) {
    // A half-close, or the stream broke: then the done tag is on its way and comes before the tick.
    half_close_at_ = queue_.now() + transport::kTimerTick;
    return;
  }
  HandleFrame();
  received_.Clear();
}

void Call::HandleFrame() {
  // The length first: a frame over the limit is never copied.
  const std::size_t bytes = received_.Length();
  if (bytes > queue_.relay().limits.frame_bytes_max) return session_->OnFrameTooLarge(bytes);
  const FrameBytes frame(received_);
  if (!frame.ok()) {
    context_.TryCancel();
    return Break();
  }
  session_->OnFrame(frame.view());
}

void Call::Write(const v1::RelayResponse& frame) { WriteBytes(Serialized(frame)); }

void Call::WriteEncoded(std::span<const session::EncodedFrame> frames) {
  encoded_.assign(frames.begin(), frames.end());
  WriteNextEncoded();
}

void Call::WriteNextEncoded() {
  const session::EncodedFrame frame = std::move(encoded_.front());
  encoded_.pop_front();
  WriteBytes(Copied(*frame));
}

void Call::WriteBytes(const grpc::ByteBuffer& bytes) {
  UPLINK_CHECK(!writing_ && !finishing(), "a write is under way, or the call ends");
  writing_ = true;
  ++tags_out_;
  stream_.Write(bytes, &written_tag_);
}

void Call::OnWritten(bool ok) {
  writing_ = false;
  if (broken_) return;
  if (finishing()) return StartFinish();
  if (!ok) return Break();
  if (!encoded_.empty()) return WriteNextEncoded();
  session_->OnWritten();
}

void Call::Finish(const absl::Status& status) {
  UPLINK_CHECK(!finishing(), "a call ends once");
  const std::string& robot = session_ && !who_.gateway.empty() ? session_->ruri() : who_.robot;
  transport::LogRefusal(queue_.relay().refusals,
                        {.peer = context_.peer(), .robot = robot, .gateway = who_.gateway}, status);
  finish_status_ = status;
  finish_by_ = queue_.now() + session::kFinishWait;
  if (!writing_) StartFinish();
}

void Call::StartFinish() {
  ++tags_out_;
  stream_.Finish(ToGrpc(*finish_status_), &finished_tag_);
}

void Call::OnFinished(bool /*ok*/) {}

void Call::Cancel() { context_.TryCancel(); }

void Call::OnDone(bool /*ok*/) {
  finish_by_.reset();
  Break();
}

void Call::Break() {
  broken_ = true;
  if (session_ && !session_->done()) session_->OnBroken();
}

void Call::OnWake() {
  if (!session_ || broken_ || finishing()) return;
  session_->OnWake();
  SetTimer();
}

void Call::DrainAt(SteadyTime at, SteadyTime end) {
  drain_at_ = at;
  drain_end_ = end;
  SetTimer();
}

void Call::OnTimer() {
  timer_.reset();
  const SteadyTime now = queue_.now();
  if (finish_by_ && now >= *finish_by_) {
    finish_by_.reset();
    queue_.relay().probe.finish_timeouts_total.Add();
    context_.TryCancel();
    return;
  }
  if (session_ && !broken_ && !finishing()) {
    if (half_close_at_ && now >= *half_close_at_) {
      half_close_at_.reset();
      session_->OnHalfClose();
    } else if (drain_at_ && now >= *drain_at_) {
      drain_at_.reset();
      session_->OnDrain(
          std::max(milliseconds(0), std::chrono::duration_cast<milliseconds>(drain_end_ - now)));
    } else if (session_due_ && now >= *session_due_) {
      session_->OnTimer();
    }
  }
  SetTimer();
}

void Call::SetTimer() {
  std::optional<SteadyTime> deadline = finish_by_;
  const auto consider = [&deadline](const std::optional<SteadyTime>& at) {
    if (at && (!deadline || *at < *deadline)) deadline = at;
  };
  if (session_ && !broken_ && !finishing()) {
    session_due_ = session_->deadline();
    consider(session_due_);
    consider(half_close_at_);
    consider(drain_at_);
  }
  if (deadline) queue_.CallAt(id_, timer_, *deadline);
}

void Call::AfterStep() {
  if (tags_out_ == 0) return queue_.Retire(*this);
  SetTimer();
}

}  // namespace uplink::relay
