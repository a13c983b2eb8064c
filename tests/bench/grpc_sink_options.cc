#include "tests/bench/grpc_sink_options.h"

#include <string_view>

#include <grpc/compression.h>
#include <grpc/grpc.h>
#include <grpcpp/security/tls_certificate_provider.h>
#include <grpcpp/security/tls_credentials_options.h>
#include <openssl/bio.h>
#include <openssl/conf.h>
#include <openssl/crypto.h>

#include "schema/base/check.h"

namespace uplink::bench {
namespace {

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

}  // namespace

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

}  // namespace uplink::bench
