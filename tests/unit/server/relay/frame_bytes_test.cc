#include "server/relay/frame_bytes.h"

#include <gtest/gtest.h>

namespace uplink::relay {
namespace {

TEST(FrameBytes, OneSlice) {
  const grpc::Slice slice("a frame");
  const grpc::ByteBuffer buffer(&slice, 1);
  const FrameBytes bytes(buffer);
  ASSERT_TRUE(bytes.ok());
  EXPECT_EQ(bytes.view(), "a frame");
}

TEST(FrameBytes, SeveralSlicesBecomeOne) {
  const grpc::Slice slices[] = {grpc::Slice("one, "), grpc::Slice("two, "), grpc::Slice("three")};
  const grpc::ByteBuffer buffer(slices, 3);
  const FrameBytes bytes(buffer);
  ASSERT_TRUE(bytes.ok());
  EXPECT_EQ(bytes.view(), "one, two, three");
}

TEST(FrameBytes, NoBytesAreAFrameToo) {
  const grpc::Slice slice;
  const grpc::ByteBuffer buffer(&slice, 1);
  const FrameBytes bytes(buffer);
  ASSERT_TRUE(bytes.ok());
  EXPECT_EQ(bytes.view(), "");
}

TEST(FrameBytes, ABufferWithoutBytesIsNone) {
  const grpc::ByteBuffer buffer;
  EXPECT_FALSE(FrameBytes(buffer).ok());
}

TEST(Serialized, ReadsBack) {
  v1::RelayResponse frame;
  frame.mutable_ack()->set_through_seq(7);
  frame.mutable_ack()->set_judged_seq(9);
  const grpc::ByteBuffer buffer = Serialized(frame);
  const FrameBytes bytes(buffer);
  v1::RelayResponse read;
  ASSERT_TRUE(read.ParseFromArray(bytes.view().data(), static_cast<int>(bytes.view().size())));
  EXPECT_EQ(read.ack().through_seq(), 7U);
  EXPECT_EQ(read.ack().judged_seq(), 9U);
}

}  // namespace
}  // namespace uplink::relay
