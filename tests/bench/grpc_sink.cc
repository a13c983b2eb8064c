// The least that a server by the gRPC library can do: a completion queue, and raw frames that are
// counted and thrown away, or calls that are parsed and answered. A comparator.
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include <absl/synchronization/mutex.h>
#include <grpc/compression.h>
#include <grpc/grpc.h>
#include <grpcpp/grpcpp.h>
#include <grpcpp/security/tls_certificate_provider.h>
#include <grpcpp/security/tls_credentials_options.h>
#include <openssl/bio.h>
#include <openssl/conf.h>
#include <openssl/crypto.h>

#include "schema/base/check.h"
#include "tests/bench/avatar/sink_calls.h"
#include "tests/bench/sink_protocol.h"
#include "tests/bench/sink_tag.h"
#include "uplink/v1/relay.grpc.pb.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::bench {
namespace {

using Service = v1::UplinkRelay::WithRawMethod_Relay<v1::UplinkRelay::Service>;

constexpr int kStreamsPerConnection = 256;
constexpr int kHeaderBytesMax = 8 * 1024;
constexpr int kLookaheadBytes = 64 * 1024;
constexpr int kHttp2FrameBytesMax = 16 * 1024;
constexpr int kWriteBufferBytes = 32 * 1024;
constexpr int kKeepaliveMs = 25'000;
constexpr int kKeepaliveTimeoutMs = 15'000;
constexpr int kPingGapMs = 10'000;
constexpr int kIdleMs = 5 * 60'000;
constexpr int kHandshakeMs = 20'000;
constexpr int kMessageBytesMax = 2 * 1024 * 1024;
constexpr unsigned kFilesRefreshSeconds = 5;

constexpr std::string_view kNoTickets =
    "openssl_conf = sink\n[sink]\nssl_conf = ssl\n[ssl]\nsystem_default = tls\n[tls]\n"
    "NumTickets = 0\n";

// It serves as the relay does: mutual TLS without session tickets, the same windows and bounds.

/// `folder` holds server.crt, server.key and ca.crt.
std::shared_ptr<grpc::ServerCredentials> MutualTls(const std::string& folder) {
  namespace tls = grpc::experimental;
  tls::TlsServerCredentialsOptions options(std::make_shared<tls::FileWatcherCertificateProvider>(
      folder + "/server.key", folder + "/server.crt", folder + "/ca.crt", kFilesRefreshSeconds));
  options.watch_root_certs();
  options.watch_identity_key_cert_pairs();
  options.set_cert_request_type(GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY);
  return tls::TlsServerCredentials(options);
}

void SetChannelArguments(grpc::ServerBuilder& builder) {
  builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, kStreamsPerConnection);
  builder.AddChannelArgument(GRPC_ARG_MAX_METADATA_SIZE, kHeaderBytesMax);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_STREAM_LOOKAHEAD_BYTES, kLookaheadBytes);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MAX_FRAME_SIZE, kHttp2FrameBytesMax);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_WRITE_BUFFER_SIZE, kWriteBufferBytes);
  // The probe costs a ping for each burst of reads (measured).
  builder.AddChannelArgument(GRPC_ARG_HTTP2_BDP_PROBE, 0);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, kKeepaliveMs);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, kKeepaliveTimeoutMs);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA, 0);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, kPingGapMs);
  builder.AddChannelArgument(GRPC_ARG_MAX_CONNECTION_IDLE_MS, kIdleMs);
  builder.AddChannelArgument(GRPC_ARG_SERVER_HANDSHAKE_TIMEOUT_MS, kHandshakeMs);
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  builder.SetMaxReceiveMessageSize(kMessageBytesMax);
  builder.AddChannelArgument(GRPC_ARG_ENABLE_PER_MESSAGE_DECOMPRESSION, 0);
  for (const grpc_compression_algorithm algorithm : {GRPC_COMPRESS_DEFLATE, GRPC_COMPRESS_GZIP}) {
    builder.SetCompressionAlgorithmSupportStatus(algorithm, false);
  }
}

/// For the whole process: gRPC 1.51 has no setter, but reads OpenSSL's own configuration. Before
/// anything else of OpenSSL is used.
void SendNoSessionTickets() {
  // From here on OpenSSL does not read its configuration file, which would undo this.
  OPENSSL_init_crypto(OPENSSL_INIT_NO_LOAD_CONFIG, nullptr);
  BIO* const text = BIO_new_mem_buf(kNoTickets.data(), static_cast<int>(kNoTickets.size()));
  CONF* const configuration = NCONF_new(nullptr);
  UPLINK_CHECK(NCONF_load_bio(configuration, text, nullptr) == 1 &&
                   CONF_modules_load(configuration, nullptr, CONF_MFLAGS_IGNORE_ERRORS) == 1,
               "OpenSSL takes its configuration");
  NCONF_free(configuration);
  BIO_free(text);
}

grpc::ByteBuffer BufferOf(const v1::RelayResponse& frame) {
  const grpc::Slice slice(frame.SerializeAsString());
  return {&slice, 1};
}

/// One stream. Deletes itself when its last tag has returned.
class Call final {
 public:
  Call(Service& service, grpc::ServerCompletionQueue& queue, std::uint64_t frame_messages)
      : service_(service), queue_(queue), frame_messages_(frame_messages), stream_(&context_) {
    service_.RequestRelay(&context_, &stream_, &queue_, &queue_, started_.tag());
  }

  struct Tag final : SinkTag {
    Tag(Call* its_call, void (Call::*its_handler)(bool)) : call(its_call), handler(its_handler) {}
    void Proceed(bool ok) override { (call->*handler)(ok); }

    Call* call;
    void (Call::*handler)(bool);
  };

  void OnStarted(bool ok) {
    if (!ok) {
      delete this;
      return;
    }
    new Call(service_, queue_, frame_messages_);
    stream_.Read(&incoming_, read_.tag());
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
    stream_.Read(&incoming_, read_.tag());
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
    stream_.Write(BufferOf(frame), written_.tag());
  }

  void Finish() {
    if (writing_ || std::exchange(finishing_, true)) return;
    stream_.Finish(grpc::Status::OK, finished_.tag());
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
  SinkCalls calls(builder);
  const auto queue = builder.AddCompletionQueue();
  const auto server = builder.BuildAndStart();
  UPLINK_CHECK(server != nullptr, "the sink listens");
  new Call(service, *queue, frame_messages);
  calls.Await(*queue);
  void* tag = nullptr;
  bool ok = false;
  while (queue->Next(&tag, &ok)) static_cast<SinkTag*>(tag)->Proceed(ok);
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
