#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include <absl/status/status.h>
#include <grpcpp/server_context.h>
#include <grpcpp/support/async_stream.h>
#include <grpcpp/support/byte_buffer.h>

#include "server/relay/queue.h"
#include "server/relay/tag.h"
#include "server/session/frame_sink.h"
#include "server/session/session.h"
#include "server/transport/gate.h"
#include "server/transport/timers.h"

namespace uplink::relay {

/// One Relay call between gRPC and a Session: offered, started, ended, and destroyed when its last
/// tag has returned. At most one read and one write are under way.
///
/// Thread: confined to its queue's.
class Call final : public session::FrameSource, public session::FrameSink {
 public:
  Call(Queue& queue, std::uint64_t id);
  ~Call() override;
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

  /// Lets gRPC give it the next robot's call.
  void Offer();
  void OnWake();
  void OnTimer();
  /// Session::OnDrain at `at`, with what is left until `end`.
  void DrainAt(SteadyTime at, SteadyTime end);

  [[nodiscard]] std::uint64_t id() const { return id_; }
  [[nodiscard]] bool has_session() const { return session_.has_value(); }

  // session::FrameSource
  void RequestRead() override;
  // session::FrameSink
  void Write(const v1::RelayResponse& frame) override;
  void WriteEncoded(std::span<const session::EncodedFrame> frames) override;
  void Finish(const absl::Status& status) override;
  void Cancel() override;

 private:
  template <void (Call::*kStep)(bool ok)>
  class Step final : public Tag {
   public:
    explicit Step(Call& call) : call_(call) {}
    void Proceed(bool ok) override {
      --call_.tags_out_;
      (call_.*kStep)(ok);
      call_.AfterStep();
    }

   private:
    Call& call_;
  };

  void OnStarted(bool ok);
  void OnDone(bool ok);
  void OnRead(bool ok);
  void OnWritten(bool ok);
  void OnFinished(bool ok);

  [[nodiscard]] absl::Status Admit();
  void HandleFrame();
  void WriteBytes(const grpc::ByteBuffer& bytes);
  void WriteNextEncoded();
  void StartFinish();
  void Break();
  void AfterStep();
  void SetTimer();
  [[nodiscard]] bool finishing() const { return finish_status_.has_value(); }

  Queue& queue_;
  const std::uint64_t id_;
  grpc::ServerContext context_;
  grpc::ServerAsyncReaderWriter<grpc::ByteBuffer, grpc::ByteBuffer> stream_{&context_};
  grpc::ByteBuffer received_;

  Step<&Call::OnStarted> started_tag_{*this};
  /// Out only once the call has started: of a call that never does, it never returns (measured).
  Step<&Call::OnDone> done_tag_{*this};
  Step<&Call::OnRead> read_tag_{*this};
  Step<&Call::OnWritten> written_tag_{*this};
  Step<&Call::OnFinished> finished_tag_{*this};
  int tags_out_ = 0;

  bool admitted_ = false;
  /// Empty before it is known.
  transport::Entrant who_;
  bool reading_ = false;
  bool writing_ = false;
  /// Frames of the write under way that gRPC, which takes one after the other, was not given yet.
  std::deque<session::EncodedFrame> encoded_;
  /// gRPC says that the call was cut, or that it is over.
  bool broken_ = false;
  std::optional<absl::Status> finish_status_;
  std::optional<SteadyTime> finish_by_;
  /// The last read said no more; unless the call breaks by then, the agent half-closed.
  std::optional<SteadyTime> half_close_at_;
  std::optional<SteadyTime> drain_at_;
  SteadyTime drain_end_;
  /// What the session last answered: asked again once it has passed, it may say nothing.
  std::optional<SteadyTime> session_due_;
  transport::Timers::Slot timer_;

  /// Last, so that it goes before what it writes to.
  std::optional<session::Session> session_;
};

}  // namespace uplink::relay
