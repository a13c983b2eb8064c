#include "server/http/entrance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/server_world.h"

namespace uplink::http {
namespace {

using ::testing::HasSubstr;

class EntranceTest : public ::testing::Test {
 protected:
  [[nodiscard]] Resolved Ask(const std::string& target, Method method = Method::kGet) const {
    return entrance_.Resolve({method, target});
  }

  testing::ServerWorld world_;
  Entrance entrance_;
};

TEST_F(EntranceTest, WhileTheServerStartsItLivesAndIsNotReady) {
  EXPECT_EQ(Ask("/livez").run().status, 200);
  EXPECT_EQ(Ask("/livez").run().body, R"({"relayLastHandshakeSeconds":0})");
  const Response ready = Ask("/readyz").run();
  EXPECT_EQ(ready.status, 503);
  EXPECT_EQ(ready.body, R"({"refuses":["starting"]})");
}

TEST_F(EntranceTest, WhileTheServerStartsEverythingElseIs503) {
  for (const char* target : {"/metrics", "/metrics/robots", "/api/v1/status", "/api/v1/robots/a",
                             "/api/v1/faults", "/", "/nowhere"}) {
    const Resolved resolved = Ask(target);
    EXPECT_EQ(resolved.lane, Lane::kIo) << target << " waits for nothing";
    const Response response = resolved.run();
    EXPECT_EQ(response.status, 503) << target;
    EXPECT_THAT(response.body, HasSubstr(R"("code":"UNAVAILABLE")"));
    EXPECT_THAT(response.body, HasSubstr("the server starts"));
  }
  EXPECT_EQ(Ask("/readyz", Method::kOther).run().status, 503);
  EXPECT_EQ(RouteName(Ask("/api/v1/status").route), "status");
  EXPECT_EQ(RouteName(Ask("/nowhere").route), "other");
}

TEST_F(EntranceTest, TheSiteAnswersOnceItIsThere) {
  entrance_.Open(world_.site);
  EXPECT_EQ(Ask("/readyz").run().body, R"({"degraded":[]})");
  EXPECT_EQ(Ask("/api/v1/status").run().status, 200);
  EXPECT_EQ(Ask("/nowhere").run().status, 404);
  EXPECT_EQ(Ask("/readyz", Method::kOther).run().status, 405);
}

}  // namespace
}  // namespace uplink::http
