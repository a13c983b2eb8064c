#include "server/relay/channel_arguments.h"

#include <algorithm>
#include <limits>

#include <grpc/compression.h>
#include <grpc/grpc.h>
#include <grpcpp/resource_quota.h>

namespace uplink::relay {
namespace {

/// Streams of one connection, at least: a robot needs one, and two at takeover. gRPC knows one
/// bound for all connections, so it is a gateway's if that is higher; what robots may have is for
/// transport::Gate to say.
constexpr int kStreamsPerConnectionMin = 64;
/// Bytes of all headers of a call.
constexpr int kHeaderBytesMax = 8 * 1024;
/// Bytes that a stream may send ahead of our reads; also the HTTP/2 window. Larger frames widen it
/// while they are read.
constexpr int kLookaheadBytes = 64 * 1024;
constexpr int kHttp2FrameBytesMax = 16 * 1024;
constexpr int kWriteBufferBytes = 32 * 1024;
/// A peer that is gone without a word is noticed within these two; robots' networks are bad.
constexpr int kKeepaliveMs = 25'000;
constexpr int kKeepaliveTimeoutMs = 15'000;
/// Pings of an agent closer than this count as strikes, of which it has two.
constexpr int kPingGapMs = 10'000;
constexpr int kPingStrikesMax = 2;
/// A connection without a call is closed after this.
constexpr int kIdleMs = 5 * 60'000;
constexpr int kHandshakeMs = 20'000;
/// Streams go on for so long on a connection that has reached its age, or for that age again.
constexpr milliseconds kAgeGrace{10'000};
/// gRPC's own limit lies above ours, so that our sentence, which names frame and limit, reaches the
/// agent; past this one gRPC ends the call with the same code.
constexpr int kReceiveLimitFactor = 2;
/// What frames of ours hold beside a payload.
constexpr int kFrameOverheadBytes = 64 * 1024;

int Milliseconds(milliseconds value) {
  return static_cast<int>(
      std::min<milliseconds::rep>(value.count(), std::numeric_limits<int>::max()));
}

void SetHttp2(const transport::RelayOptions& options, grpc::ServerBuilder& builder) {
  builder.AddChannelArgument(
      GRPC_ARG_MAX_CONCURRENT_STREAMS,
      std::max(kStreamsPerConnectionMin, static_cast<int>(options.gateway_streams_max)));
  builder.AddChannelArgument(GRPC_ARG_MAX_METADATA_SIZE, kHeaderBytesMax);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_STREAM_LOOKAHEAD_BYTES, kLookaheadBytes);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MAX_FRAME_SIZE, kHttp2FrameBytesMax);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_WRITE_BUFFER_SIZE, kWriteBufferBytes);
  // The probe costs a ping for each burst of reads (measured).
  builder.AddChannelArgument(GRPC_ARG_HTTP2_BDP_PROBE, 0);
}

void SetConnections(const transport::RelayOptions& options, grpc::ServerBuilder& builder) {
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, kKeepaliveMs);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, kKeepaliveTimeoutMs);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA, 0);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, kPingGapMs);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MAX_PING_STRIKES, kPingStrikesMax);
  builder.AddChannelArgument(GRPC_ARG_MAX_CONNECTION_IDLE_MS, kIdleMs);
  builder.AddChannelArgument(GRPC_ARG_SERVER_HANDSHAKE_TIMEOUT_MS, kHandshakeMs);
  // A second process on the same port would take half of the robots.
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  if (options.connection_age_max > milliseconds(0)) {
    builder.AddChannelArgument(GRPC_ARG_MAX_CONNECTION_AGE_MS,
                               Milliseconds(options.connection_age_max));
    builder.AddChannelArgument(GRPC_ARG_MAX_CONNECTION_AGE_GRACE_MS,
                               Milliseconds(std::min(kAgeGrace, options.connection_age_max)));
  }
}

void SetMessages(const session::SessionLimits& limits, grpc::ServerBuilder& builder) {
  builder.SetMaxReceiveMessageSize(static_cast<int>(limits.frame_bytes_max) * kReceiveLimitFactor);
  builder.SetMaxSendMessageSize(static_cast<int>(limits.payload_bytes_max) + kFrameOverheadBytes);
  // A compressed frame could unfold to a thousand times its size behind the limit's back.
  builder.AddChannelArgument(GRPC_ARG_ENABLE_PER_MESSAGE_DECOMPRESSION, 0);
  for (const grpc_compression_algorithm algorithm : {GRPC_COMPRESS_DEFLATE, GRPC_COMPRESS_GZIP}) {
    builder.SetCompressionAlgorithmSupportStatus(algorithm, false);
  }
}

}  // namespace

void SetChannelArguments(const transport::RelayOptions& options,
                         const session::SessionLimits& limits, grpc::ServerBuilder& builder) {
  SetHttp2(options, builder);
  SetConnections(options, builder);
  SetMessages(limits, builder);
  if (options.memory_bytes_max > 0) {
    builder.SetResourceQuota(grpc::ResourceQuota("relay").Resize(options.memory_bytes_max));
  }
}

}  // namespace uplink::relay
