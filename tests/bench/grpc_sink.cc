// The least that a server by the gRPC library can do: a completion queue, and raw frames that are
// counted and thrown away. A comparator.
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>

#include <absl/synchronization/mutex.h>
#include <grpcpp/grpcpp.h>

#include "schema/base/check.h"
#include "tests/bench/grpc_sink_options.h"
#include "tests/bench/sink_protocol.h"
#include "uplink/v1/relay.grpc.pb.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::bench {
namespace {

using Service = v1::UplinkRelay::WithRawMethod_Relay<v1::UplinkRelay::Service>;

grpc::ByteBuffer BufferOf(const v1::RelayResponse& frame) {
  const grpc::Slice slice(frame.SerializeAsString());
  return {&slice, 1};
}

/// One stream. Deletes itself when its last tag has returned.
class Call final {
 public:
  Call(Service& service, grpc::ServerCompletionQueue& queue, std::uint64_t frame_messages)
      : service_(service), queue_(queue), frame_messages_(frame_messages), stream_(&context_) {
    service_.RequestRelay(&context_, &stream_, &queue_, &queue_, &started_);
  }

  struct Tag {
    Call* call;
    void (Call::*handler)(bool);
  };

  void OnStarted(bool ok) {
    if (!ok) {
      delete this;
      return;
    }
    new Call(service_, queue_, frame_messages_);
    stream_.Read(&incoming_, &read_);
  }

  void OnRead(bool ok) {
    if (!ok) {
      reading_ = false;
      return Finish();
    }
    if (!std::exchange(greeted_, true)) {
      v1::RelayResponse frame;
      frame.mutable_welcome()->mutable_limits()->set_in_flight_uplinks_max(4096);
      Write(frame);
    } else {
      messages_ += frame_messages_;
      AckIfDue();
    }
    stream_.Read(&incoming_, &read_);
  }

  void OnWritten(bool ok) {
    writing_ = false;
    if (!reading_) return Finish();
    if (ok) AckIfDue();
  }

  void OnFinished(bool /*ok*/) { delete this; }

 private:
  void AckIfDue() {
    if (writing_ || messages_ - acked_ < kMessagesAnAck) return;
    acked_ = messages_;
    v1::RelayResponse frame;
    frame.mutable_ack()->set_through_seq(messages_);
    frame.mutable_ack()->set_judged_seq(messages_);
    Write(frame);
  }

  void Write(const v1::RelayResponse& frame) {
    writing_ = true;
    stream_.Write(BufferOf(frame), &written_);
  }

  void Finish() {
    if (writing_ || std::exchange(finishing_, true)) return;
    stream_.Finish(grpc::Status::OK, &finished_);
  }

  Service& service_;
  grpc::ServerCompletionQueue& queue_;
  std::uint64_t frame_messages_;
  grpc::ServerContext context_;
  grpc::ServerAsyncReaderWriter<grpc::ByteBuffer, grpc::ByteBuffer> stream_;
  grpc::ByteBuffer incoming_;
  Tag started_{this, &Call::OnStarted};
  Tag read_{this, &Call::OnRead};
  Tag written_{this, &Call::OnWritten};
  Tag finished_{this, &Call::OnFinished};
  std::uint64_t messages_ = 0;
  std::uint64_t acked_ = 0;
  bool greeted_ = false;
  bool reading_ = true;
  bool writing_ = false;
  bool finishing_ = false;
};

[[noreturn]] void Run(const std::string& folder, const std::string& port,
                      std::uint64_t frame_messages) {
  Service service;
  grpc::ServerBuilder builder;
  SetChannelArguments(builder);
  builder.AddListeningPort("127.0.0.1:" + port, MutualTls(folder));
  builder.RegisterService(&service);
  const auto queue = builder.AddCompletionQueue();
  const auto server = builder.BuildAndStart();
  UPLINK_CHECK(server != nullptr, "the sink listens");
  new Call(service, *queue, frame_messages);
  void* tag = nullptr;
  bool ok = false;
  while (queue->Next(&tag, &ok)) {
    const auto* const of = static_cast<Call::Tag*>(tag);
    (of->call->*of->handler)(ok);
  }
  std::abort();
}

}  // namespace
}  // namespace uplink::bench

/// grpc_sink FOLDER PORT FRAME_MESSAGES: the folder holds server.crt, server.key and ca.crt; each
/// frame counts as so many messages.
int main(int argc, char** argv) {
  if (argc != 4) return 2;
  // Debian's abseil is built with its deadlock detector.
  absl::SetMutexDeadlockDetectionMode(absl::OnDeadlockCycle::kIgnore);
  uplink::bench::SendNoSessionTickets();
  uplink::bench::Run(argv[1], argv[2], std::stoull(argv[3]));
}
