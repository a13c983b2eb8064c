#include <algorithm>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "schema/base/check.h"
#include "schema/judge.h"
#include "tests/support/records.h"
#include "tests/support/server_world.h"
#include "tests/support/vector_files.h"
#include "tests/support/vector_views.h"

// What a robot sent, as the paths of HTTP show it: judged, applied or committed, asked for.
namespace uplink {
namespace {

class ViewsTest : public ::testing::TestWithParam<std::string> {
 protected:
  /// The vector's robot sends it.
  void Send() {
    robot::Robot& robot = world_.AddRobot(Ruri());
    const std::string payload = test::ReadVector(GetParam(), ".bin");
    schema::Judgement judgement = judge_.Payload(test::AsPayload(payload));
    UPLINK_CHECK(judgement.record() != nullptr, "every vector is good");
    auto record = std::get<model::Record>(std::move(judgement.verdict));
    if (record.durable()) {
      world_.CommitJudged(Ruri(), std::move(record));
    } else {
      std::vector<model::Record> records;
      records.push_back(std::move(record));
      robot.state.Apply(records, {});
    }
  }
  [[nodiscard]] static std::string Ruri() { return test::RuriOfVector(GetParam()); }
  [[nodiscard]] test::TimeSpan Now() const {
    const std::int64_t now = UnixMs(world_.clock.System());
    return {now, now};
  }

  testing::ServerWorld world_;
  schema::Judge judge_{schema::JudgeLimits()};
};

TEST_P(ViewsTest, ShowEveryFieldAndNothingElse) {
  Send();
  for (const test::VectorView& view :
       test::ViewsOf(Ruri(), test::ReadVector(GetParam(), ".json"))) {
    const http::Response answer = world_.Get(view.target);
    ASSERT_EQ(answer.status, 200) << view.target << " " << answer.body;
    EXPECT_EQ(test::Difference(view, answer.body, Now()), "") << view.target;
  }
}

TEST_P(ViewsTest, DifferFromThoseOfARobotThatSentNothing) {
  // The comparison itself: an empty world must not pass where something was sent.
  world_.AddRobot(Ruri());
  bool anything = false;
  bool differs = false;
  for (const test::VectorView& view :
       test::ViewsOf(Ruri(), test::ReadVector(GetParam(), ".json"))) {
    anything |= view.row.has_value() && !view.row->empty();
    differs |= !test::Difference(view, world_.Get(view.target).body, Now()).empty();
  }
  EXPECT_EQ(differs, anything);
}

std::string TestName(const ::testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Vendor, ViewsTest, ::testing::ValuesIn(test::VectorNames()), TestName);

}  // namespace
}  // namespace uplink
