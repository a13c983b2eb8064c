#include "server/front/call/request_head.h"

#include <string>

#include <gtest/gtest.h>

#include "server/front/http2/limits.h"

namespace uplink::front {
namespace {

RequestHead Grpc() {
  RequestHead head;
  head.Add(":method", "POST");
  head.Add(":path", "/uplink.v1.UplinkRelay/Relay");
  head.Add("content-type", "application/grpc");
  head.Add("te", "trailers");
  return head;
}

TEST(RequestHead, AGrpcRequestIsGood) {
  const RequestHead head = Grpc();
  EXPECT_FALSE(head.NotGrpc());
  EXPECT_TRUE(head.Judge().ok());
  EXPECT_EQ(head.path(), "/uplink.v1.UplinkRelay/Relay");
  EXPECT_FALSE(head.timeout());
}

TEST(RequestHead, AnotherMethodOrContentIsNoGrpc) {
  RequestHead get = Grpc();
  get.Add(":method", "GET");
  EXPECT_EQ(get.NotGrpc(), 405);
  RequestHead text = Grpc();
  text.Add("content-type", "text/plain");
  EXPECT_EQ(text.NotGrpc(), 415);
  RequestHead near = Grpc();
  near.Add("content-type", "application/grpcx");
  EXPECT_EQ(near.NotGrpc(), 415);
}

TEST(RequestHead, ContentTypesOfGrpcHaveEndings) {
  for (const char* type : {"application/grpc+proto", "application/grpc;charset=utf-8"}) {
    RequestHead head = Grpc();
    head.Add("content-type", type);
    EXPECT_FALSE(head.NotGrpc()) << type;
  }
}

TEST(RequestHead, TrailersMustBeTaken) {
  RequestHead head = Grpc();
  head.Add("te", "deflate");
  EXPECT_EQ(head.Judge().code(), absl::StatusCode::kInternal);
}

TEST(RequestHead, OnlyIdentityIsAnEncoding) {
  RequestHead head = Grpc();
  head.Add("grpc-encoding", "identity");
  EXPECT_TRUE(head.Judge().ok());
  head.Add("grpc-encoding", "gzip");
  EXPECT_EQ(head.Judge().code(), absl::StatusCode::kUnimplemented);
  EXPECT_EQ(std::string(head.Judge().message()), "grpc-encoding gzip: only identity is taken");
  EXPECT_TRUE(head.foreign_encoding());
}

TEST(RequestHead, HeadersAtTheirLimitAreTakenAndNoByteMore) {
  RequestHead head;
  // HTTP/2 counts 32 bytes more for each header.
  const std::string value(kHeaderBytesMax - 32 - 1, 'x');
  EXPECT_TRUE(head.Add("n", value));
  EXPECT_FALSE(head.Add("", ""));
  EXPECT_EQ(head.Judge().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_FALSE(head.NotGrpc()) << "what was cut may have said that it is gRPC";

  RequestHead over;
  EXPECT_FALSE(over.Add("n", value + "x"));
}

TEST(RequestHead, ALongPathIsCut) {
  RequestHead head;
  head.Add(":path", std::string(kPathBytesMax + 1, '/'));
  EXPECT_EQ(head.path().size(), kPathBytesMax);
}

TEST(ParseTimeout, UnitsAreThoseOfGrpc) {
  EXPECT_EQ(ParseTimeout("1H"), std::chrono::hours(1));
  EXPECT_EQ(ParseTimeout("2M"), std::chrono::minutes(2));
  EXPECT_EQ(ParseTimeout("3S"), std::chrono::seconds(3));
  EXPECT_EQ(ParseTimeout("4m"), milliseconds(4));
  EXPECT_EQ(ParseTimeout("5001u"), milliseconds(6)) << "rounded up";
  EXPECT_EQ(ParseTimeout("1n"), milliseconds(1));
  EXPECT_EQ(ParseTimeout("0S"), milliseconds(0));
}

TEST(ParseTimeout, EightDigitsAndAUnitAreAllThereIs) {
  EXPECT_EQ(ParseTimeout("99999999H"), std::chrono::hours(99'999'999));
  for (const char* bad : {"", "S", "1", "1s", "100000000S", "-1S", "1 S", "0x1S", "1.5S"}) {
    EXPECT_FALSE(ParseTimeout(bad)) << bad;
    RequestHead head = Grpc();
    head.Add("grpc-timeout", bad);
    EXPECT_EQ(head.Judge().code(), absl::StatusCode::kInvalidArgument) << bad;
  }
}

}  // namespace
}  // namespace uplink::front
