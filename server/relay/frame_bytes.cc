#include "server/relay/frame_bytes.h"

#include <vector>

#include "schema/base/check.h"

namespace uplink::relay {
namespace {

std::string_view ViewOf(const grpc::Slice& slice) {
  // gRPC's bytes are unsigned char; looking at them as char is always allowed.
  return {reinterpret_cast<const char*>(slice.begin()), slice.size()};
}

}  // namespace

FrameBytes::FrameBytes(const grpc::ByteBuffer& buffer) {
  if (!buffer.Valid()) return;
  if (buffer.TrySingleSlice(&slice_).ok()) {
    view_ = ViewOf(slice_);
    ok_ = true;
    return;
  }
  std::vector<grpc::Slice> slices;
  if (!buffer.Dump(&slices).ok()) return;
  copy_.reserve(buffer.Length());
  for (const grpc::Slice& slice : slices) copy_.append(ViewOf(slice));
  view_ = copy_;
  ok_ = true;
}

grpc::ByteBuffer Serialized(const v1::RelayResponse& frame) {
  const std::size_t bytes = frame.ByteSizeLong();
  grpc::Slice slice(bytes);
  // The slice is ours alone until it is handed over, so writing to it is what it is there for.
  const bool done =
      frame.SerializeToArray(const_cast<std::uint8_t*>(slice.begin()), static_cast<int>(bytes));
  UPLINK_CHECK(done, "a frame of ours does not serialize");
  return {&slice, 1};
}

grpc::ByteBuffer Copied(std::string_view bytes) {
  const grpc::Slice slice(bytes.data(), bytes.size());
  return {&slice, 1};
}

}  // namespace uplink::relay
