#include <algorithm>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <google/protobuf/util/json_util.h>
#include <google/protobuf/util/message_differencer.h>
#include <gtest/gtest.h>

#include "schema/encode.h"
#include "schema/json/render.h"
#include "schema/judge.h"
#include "schema/limits.h"
#include "schema/model/held_bytes.h"
#include "tests/support/proto_struct.h"
#include "tests/support/records.h"
#include "tests/support/vector_files.h"

namespace uplink {
namespace {

google::protobuf::Struct Expected(const std::string& name) {
  google::protobuf::Struct expected;
  const auto status =
      google::protobuf::util::JsonStringToMessage(test::ReadVector(name, ".json"), &expected);
  EXPECT_TRUE(status.ok()) << status.ToString();
  return expected;
}

class VectorTest : public testing::TestWithParam<std::string> {
 protected:
  [[nodiscard]] std::string Payload() const { return test::ReadVector(GetParam(), ".bin"); }

  schema::Judge judge_{schema::JudgeLimits()};
};

TEST_P(VectorTest, MeansWhatItsJsonSays) {
  const schema::Judgement judgement = judge_.Payload(test::AsPayload(Payload()));
  ASSERT_NE(judgement.record(), nullptr) << judgement.rejection()->detail;
  EXPECT_THAT(judgement.record()->dropped(), testing::IsEmpty());
  EXPECT_EQ(judgement.times_unknown, 0U);
  EXPECT_EQ(judgement.enumerants_unrecognized, 0U);

  google::protobuf::util::MessageDifferencer differencer;
  std::string difference;
  differencer.ReportDifferencesToString(&difference);
  EXPECT_TRUE(differencer.Compare(Expected(GetParam()),
                                  test::ToStruct(json::RenderBody(judgement.record()->body()))))
      << difference;
}

TEST_P(VectorTest, SurvivesOurEncoder) {
  const schema::Judgement first = judge_.Payload(test::AsPayload(Payload()));
  ASSERT_NE(first.record(), nullptr);
  const std::string encoded = schema::Encode(first.record()->body());
  const schema::Judgement second = judge_.Payload(test::AsPayload(encoded));
  ASSERT_NE(second.record(), nullptr) << second.rejection()->detail;
  EXPECT_TRUE(first.record()->body() == second.record()->body());
}

TEST_P(VectorTest, HoldsAFewTimesItsPayload) {
  const schema::Judgement judgement = judge_.Payload(test::AsPayload(Payload()));
  ASSERT_NE(judgement.record(), nullptr);
  EXPECT_LE(model::HeldBytes(*judgement.record()), schema::kTraversalFactor * Payload().size());
}

std::string TestName(const testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Vendor, VectorTest, testing::ValuesIn(test::VectorNames()), TestName);

TEST(VectorsTest, AreComplete) {
  EXPECT_EQ(test::VectorNames(".bin"), test::VectorNames(".json"));
  std::set<std::size_t> variants;
  schema::Judge judge{schema::JudgeLimits()};
  for (const std::string& name : test::VectorNames(".bin")) {
    const std::string payload = test::ReadVector(name, ".bin");
    const auto variant = judge.Payload(test::AsPayload(payload)).variant;
    ASSERT_TRUE(variant.has_value()) << name;
    variants.insert(static_cast<std::size_t>(*variant));
  }
  EXPECT_EQ(variants.size(), model::kVariants);
  EXPECT_EQ(test::VectorNames(".bin").size(), 2 * model::kVariants);
}

}  // namespace
}  // namespace uplink
