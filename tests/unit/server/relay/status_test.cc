#include "server/relay/status.h"

#include <gtest/gtest.h>

namespace uplink::relay {
namespace {

TEST(ToGrpc, KeepsEveryCode) {
  // The two libraries number their codes alike; 16 is the last.
  for (int code = 0; code <= 16; ++code) {
    const absl::Status status(static_cast<absl::StatusCode>(code), "text");
    EXPECT_EQ(static_cast<int>(ToGrpc(status).error_code()), code);
  }
}

TEST(ToGrpc, KeepsTheText) {
  EXPECT_EQ(ToGrpc(absl::AbortedError("superseded")).error_message(), "superseded");
  EXPECT_EQ(ToGrpc(absl::OkStatus()).error_message(), "");
}

TEST(ToGrpc, TakesACodeOfALaterLibraryAsUnknown) {
  const absl::Status status(static_cast<absl::StatusCode>(99), "text");
  EXPECT_EQ(ToGrpc(status).error_code(), grpc::StatusCode::UNKNOWN);
}

}  // namespace
}  // namespace uplink::relay
