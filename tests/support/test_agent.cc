#include "tests/support/test_agent.h"

#include <utility>

#include <grpcpp/create_channel.h>
#include <grpcpp/impl/codegen/rpc_method.h>
#include <grpcpp/security/credentials.h>
#include <grpcpp/support/channel_arguments.h>
#include <grpcpp/support/slice.h>

#include "schema/base/check.h"
#include "schema/base/clock.h"

namespace uplink::testing {
namespace {

using Stream = grpc::ClientReaderWriter<grpc::ByteBuffer, grpc::ByteBuffer>;

grpc::ByteBuffer BufferOf(std::string_view bytes) {
  const grpc::Slice slice(bytes.data(), bytes.size());
  return {&slice, 1};
}

std::string BytesOf(const grpc::ByteBuffer& buffer) {
  std::vector<grpc::Slice> slices;
  UPLINK_CHECK(buffer.Dump(&slices).ok(), "gRPC gave no bytes");
  std::string bytes;
  for (const grpc::Slice& slice : slices) bytes.append(slice.begin(), slice.end());
  return bytes;
}

}  // namespace

std::shared_ptr<grpc::Channel> MakeChannel(const ChannelSpec& spec) {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  if (spec.lookahead_bytes > 0) {
    arguments.SetInt(GRPC_ARG_HTTP2_STREAM_LOOKAHEAD_BYTES, spec.lookahead_bytes);
    arguments.SetInt(GRPC_ARG_HTTP2_BDP_PROBE, 0);
  }
  const std::shared_ptr<grpc::ChannelCredentials> credentials =
      spec.server_ca.empty()
          ? grpc::InsecureChannelCredentials()
          : grpc::SslCredentials({spec.server_ca, spec.identity.key, spec.identity.certificate});
  return grpc::CreateCustomChannel("127.0.0.1:" + std::to_string(spec.port), credentials,
                                   arguments);
}

TestAgent::TestAgent(const std::shared_ptr<grpc::Channel>& channel)
    : TestAgent(channel, Options{}) {}

TestAgent::TestAgent(const std::shared_ptr<grpc::Channel>& channel, const Options& options) {
  context_.set_deadline(
      std::chrono::system_clock::time_point(SystemClock{}.System() + options.patience));
  if (options.compress) context_.set_compression_algorithm(GRPC_COMPRESS_GZIP);
  // The generated stub knows only whole frames; its parts take any bytes.
  const grpc::internal::RpcMethod method(options.method, grpc::internal::RpcMethod::BIDI_STREAMING,
                                         channel);
  stream_.reset(
      grpc::internal::ClientReaderWriterFactory<grpc::ByteBuffer, grpc::ByteBuffer>::Create(
          channel.get(), method, &context_));
}

TestAgent::~TestAgent() {
  if (ended_) return;
  context_.TryCancel();
  End();
}

bool TestAgent::Send(const v1::RelayRequest& frame) { return SendBytes(frame.SerializeAsString()); }

bool TestAgent::SendBytes(std::string_view bytes) { return stream_->Write(BufferOf(bytes)); }

void TestAgent::HalfClose() { stream_->WritesDone(); }

void TestAgent::Cancel() { context_.TryCancel(); }

std::optional<v1::RelayResponse> TestAgent::Read() {
  grpc::ByteBuffer buffer;
  if (ended_ || !stream_->Read(&buffer)) return std::nullopt;
  v1::RelayResponse frame;
  UPLINK_CHECK(frame.ParseFromString(BytesOf(buffer)), "the server sent no RelayResponse");
  frames_.push_back(frame);
  return frame;
}

std::optional<v1::Welcome> TestAgent::Connect(const model::SessionId& session, model::Seq settled,
                                              model::Seq judged) {
  Send(HelloFrame(session, settled, judged));
  const std::optional<v1::RelayResponse> frame = Read();
  if (!frame || !frame->has_welcome()) return std::nullopt;
  return frame->welcome();
}

std::optional<v1::Ack> TestAgent::ReadThrough(model::Seq through) {
  while (const std::optional<v1::RelayResponse> frame = Read()) {
    if (frame->has_ack() && frame->ack().through_seq() >= through) return frame->ack();
  }
  return std::nullopt;
}

std::optional<v1::Ack> TestAgent::ReadJudged(model::Seq judged) {
  while (const std::optional<v1::RelayResponse> frame = Read()) {
    if (frame->has_ack() && frame->ack().judged_seq() >= judged) return frame->ack();
  }
  return std::nullopt;
}

grpc::Status TestAgent::End() {
  while (Read()) {
  }
  if (!ended_) ended_ = stream_->Finish();
  return *ended_;
}

std::vector<v1::Reject> TestAgent::rejects() const {
  std::vector<v1::Reject> rejects;
  for (const v1::RelayResponse& frame : frames_) {
    if (frame.has_reject()) rejects.push_back(frame.reject());
  }
  return rejects;
}

}  // namespace uplink::testing
