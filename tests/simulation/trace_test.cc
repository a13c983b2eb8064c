#include "tests/simulation/trace.h"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/simulation/backends.h"
#include "tests/simulation/traced_store.h"

namespace uplink::simulation {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::uint64_t DigestOf(const std::vector<std::string>& lines) {
  Trace trace;
  for (const std::string& line : lines) trace.Add(line);
  return trace.digest();
}

TEST(Trace, DigestTellsTheOrderOfLinesAndWhereTheyEnd) {
  EXPECT_EQ(DigestOf({"a", "b"}), DigestOf({"a", "b"}));
  EXPECT_NE(DigestOf({"a", "b"}), DigestOf({"b", "a"}));
  EXPECT_NE(DigestOf({"ab"}), DigestOf({"a", "b"}));
  EXPECT_NE(DigestOf({"a"}), DigestOf({"a", ""}));
}

class StoreInATrace : public ::testing::Test {
 protected:
  static storage::OpenRequest Request() {
    storage::OpenRequest request;
    request.robot = std::make_shared<model::RobotId>(model::RobotId{"rcan://sim/0", "sim"});
    return request;
  }

  uplink::testing::FakeDatabase database_;
  uplink::testing::FakeStore store_{database_, storage::ProcessId{}};
  std::vector<std::string> lines_;
  Trace trace_{[this](std::string_view line) { lines_.emplace_back(line); }};
  TracedStore traced_{store_, trace_};
};

TEST_F(StoreInATrace, WritesACallWithItsArgumentsAndThenItsAnswer) {
  const storage::OpenRequest request = Request();
  const auto results = traced_.OpenStreams({&request, 1});
  ASSERT_TRUE(results.ok());
  EXPECT_EQ(results->size(), 1U);
  EXPECT_THAT(lines_, ElementsAre("store OpenStreams of 1", HasSubstr("open rcan://sim/0 session"),
                                  HasSubstr("opened epoch 1 held since 1 cursor 0")));
}

TEST_F(StoreInATrace, WritesACallThatFails) {
  store_.FailNext(1, uplink::testing::FailAt::kBefore);
  EXPECT_FALSE(traced_.Commit({}).ok());
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("store Commit by"), "failed UNAVAILABLE"));
}

TEST_F(StoreInATrace, WritesThePartsOfACheckpoint) {
  storage::LiveRow row{.ruri = "rcan://sim/9"};
  row.parts[1] = "ab";
  ASSERT_TRUE(traced_.Checkpoint({&row, 1}).ok());
  EXPECT_THAT(lines_, ElementsAre("store Checkpoint of 1", "live rcan://sim/9 part 1 6162",
                                  "passed over 0"));
}

struct TracedRun {
  std::string result;
  std::uint64_t digest = 0;
};

TracedRun RunTraced(std::uint64_t seed) {
  const Payloads payloads;
  FakeBackend backend;
  Trace trace;
  World world(payloads, backend, {.seed = seed, .steps = 400, .trace = &trace});
  const RunResult result = world.Run();
  return {ToText(result), trace.digest()};
}

TEST(TracedWorld, HasOneDigestPerSeed) {
  const TracedRun first = RunTraced(77);
  EXPECT_EQ(first.digest, RunTraced(77).digest);
  EXPECT_NE(first.digest, RunTraced(78).digest);
}

TEST(TracedWorld, RunsAsItDoesUntraced) {
  const Payloads payloads;
  FakeBackend backend;
  const RunResult untraced = World(payloads, backend, {.seed = 77, .steps = 400}).Run();
  EXPECT_EQ(RunTraced(77).result, ToText(untraced));
}

}  // namespace
}  // namespace uplink::simulation
