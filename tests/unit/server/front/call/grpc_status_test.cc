#include "server/front/call/grpc_status.h"

#include <gtest/gtest.h>
#include <nghttp2/nghttp2.h>

namespace uplink::front {
namespace {

TEST(GrpcStatus, CodesAreGrpcs) {
  EXPECT_EQ(GrpcCode(absl::StatusCode::kOk), 0);
  EXPECT_EQ(GrpcCode(absl::StatusCode::kInvalidArgument), 3);
  EXPECT_EQ(GrpcCode(absl::StatusCode::kResourceExhausted), 8);
  EXPECT_EQ(GrpcCode(absl::StatusCode::kUnavailable), 14);
  EXPECT_EQ(GrpcCode(absl::StatusCode::kUnauthenticated), 16);
}

TEST(GrpcStatus, ACodeThatGrpcLacksIsUnknown) {
  EXPECT_EQ(GrpcCode(static_cast<absl::StatusCode>(17)), 2);
  EXPECT_EQ(GrpcCode(static_cast<absl::StatusCode>(-1)), 2);
}

TEST(GrpcStatus, PrintableTextStaysAsItIs) {
  EXPECT_EQ(PercentEncoded("frame 2: 65537 bytes ~!"), "frame 2: 65537 bytes ~!");
  EXPECT_EQ(PercentEncoded(""), "");
}

TEST(GrpcStatus, EverythingElseIsPercentEncoded) {
  EXPECT_EQ(PercentEncoded("100 %"), "100 %25");
  EXPECT_EQ(PercentEncoded("a\nb"), "a%0Ab");
  EXPECT_EQ(PercentEncoded("\x7f"), "%7F");
  EXPECT_EQ(PercentEncoded("ü"), "%C3%BC");
  EXPECT_EQ(PercentEncoded(std::string_view("\0", 1)), "%00");
}

TEST(GrpcStatus, ResetsAreReadInGrpcsWords) {
  EXPECT_EQ(CodeOfReset(NGHTTP2_CANCEL), absl::StatusCode::kCancelled);
  EXPECT_EQ(CodeOfReset(NGHTTP2_REFUSED_STREAM), absl::StatusCode::kUnavailable);
  EXPECT_EQ(CodeOfReset(NGHTTP2_ENHANCE_YOUR_CALM), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(CodeOfReset(NGHTTP2_INADEQUATE_SECURITY), absl::StatusCode::kPermissionDenied);
  EXPECT_EQ(CodeOfReset(NGHTTP2_PROTOCOL_ERROR), absl::StatusCode::kInternal);
  EXPECT_EQ(CodeOfReset(12345), absl::StatusCode::kInternal);
}

}  // namespace
}  // namespace uplink::front
