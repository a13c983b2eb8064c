#pragma once

#include <string>
#include <string_view>

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/slice.h>

#include "uplink/v1/relay.pb.h"

namespace uplink::relay {

/// The bytes of a received message in one piece: a view where gRPC holds one slice (nearly always),
/// else a copy that this object owns. Lives no longer than the buffer.
class FrameBytes final {
 public:
  explicit FrameBytes(const grpc::ByteBuffer& buffer);
  FrameBytes(const FrameBytes&) = delete;
  FrameBytes& operator=(const FrameBytes&) = delete;

  [[nodiscard]] std::string_view view() const { return view_; }
  /// False if gRPC could not give the bytes out.
  [[nodiscard]] bool ok() const { return ok_; }

 private:
  grpc::Slice slice_;
  std::string copy_;
  std::string_view view_;
  bool ok_ = false;
};

/// The frame serialized once, straight into gRPC's memory.
[[nodiscard]] grpc::ByteBuffer Serialized(const v1::RelayResponse& frame);
/// Bytes that are serialized already, copied into gRPC's memory.
[[nodiscard]] grpc::ByteBuffer Copied(std::string_view bytes);

}  // namespace uplink::relay
