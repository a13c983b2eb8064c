#include "server/relay/environment.h"

#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::relay {
namespace {

using ::testing::HasSubstr;

absl::Status CheckWith(const char* value) {
  return CheckEnvironment([value](const char* name) -> const char* {
    return std::string_view(name) == "GRPC_POLL_STRATEGY" ? value : nullptr;
  });
}

TEST(CheckEnvironment, TakesTheDefault) {
  for (const char* value :
       {static_cast<const char*>(nullptr), "", "all", "epoll1", "epoll1,poll"}) {
    EXPECT_TRUE(CheckWith(value).ok()) << (value == nullptr ? "unset" : value);
  }
}

TEST(CheckEnvironment, RefusesASlowOrUnknownEngine) {
  for (const char* value : {"poll", "poll,epoll1", "none", "epollex"}) {
    const absl::Status status = CheckWith(value);
    EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition) << value;
    EXPECT_THAT(std::string(status.message()),
                HasSubstr(std::string("GRPC_POLL_STRATEGY=") + value));
  }
}

}  // namespace
}  // namespace uplink::relay
