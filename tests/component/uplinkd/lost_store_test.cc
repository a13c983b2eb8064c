// A server whose store was lost between two lives of it: robots bring back what they alone know.
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include "schema/encode.h"
#include "tests/component/uplinkd/uplinkd_fixture.h"
#include "tests/unit/schema/samples.h"

namespace uplink::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kRuri = "rcan://test/1";

class LostStoreTest : public UplinkdTest {
 protected:
  void Stop() {
    process_->Signal(SIGTERM);
    ASSERT_EQ(process_->WaitForExit(), 0);
  }
  void LoseStore() {
    std::vector<std::filesystem::path> lost;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.Path(""))) {
      if (entry.path().filename().string().starts_with("uplinkd.db")) lost.push_back(entry.path());
    }
    ASSERT_FALSE(lost.empty());
    for (const std::filesystem::path& path : lost) std::filesystem::remove(path);
  }
  std::unique_ptr<TestAgent> Connect(model::Seq settled) {
    auto agent = std::make_unique<TestAgent>(Channel(RobotSpec(kRuri)));
    EXPECT_TRUE(agent->Connect(SessionOf(1), settled, settled));
    return agent;
  }
};

std::vector<int> NextRequest(TestAgent& agent) {
  while (const auto frame = agent.Read()) {
    if (!frame->has_resend_request()) continue;
    const auto& kinds = frame->resend_request().kinds();
    return {kinds.begin(), kinds.end()};
  }
  return {};
}

TEST_F(LostStoreTest, AsksARobotThatGoesOnWithItsSession) {
  const std::string settings = schema::Encode(test::SampleSettings());
  Serve();
  {
    const auto agent = Connect(0);
    agent->Send(BatchFrame({{1, schema::Encode(test::SampleAgentInfo())},
                            {2, settings},
                            {3, schema::Encode(test::SampleCapabilities())}}));
    ASSERT_TRUE(agent->ReadThrough(3));
    agent->HalfClose();
    EXPECT_TRUE(agent->End().ok());
  }
  Stop();
  LoseStore();
  Serve();
  const auto agent = Connect(3);
  EXPECT_THAT(NextRequest(*agent),
              ElementsAre(v1::RESEND_KIND_AGENT_INFO, v1::RESEND_KIND_CURRENT_SETTINGS,
                          v1::RESEND_KIND_UI_CAPABILITIES));
  agent->Send(BatchFrame({{4, settings}}));
  ASSERT_TRUE(agent->ReadThrough(4));
  EXPECT_THAT(HttpGet(http_, "/api/v1/robots?parts=settings").body, HasSubstr(R"("settings":{)"));
  EXPECT_EQ(Sample("uplinkd_resend_requests_total{kind=\"currentSettings\"}"), 1);
  EXPECT_EQ(Sample("uplinkd_resend_unanswered{kind=\"currentSettings\"}"), 0);
  EXPECT_EQ(Sample("uplinkd_resend_unanswered{kind=\"agentInfo\"}"), 1);
}

}  // namespace
}  // namespace uplink::testing
