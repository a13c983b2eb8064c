#include <string>
#include <string_view>
#include <variant>

#include <gtest/gtest.h>

#include "schema/judge.h"
#include "schema/nexus_command/decode.h"
#include "schema/nexus_command/encode.h"
#include "tests/support/records.h"
#include "tests/support/vector_files.h"

/// The vendor's shapes and objects as other robots receive them: all but the id is as it came.
namespace uplink::nexus_command {
namespace {

constexpr std::string_view kOrigin = "rcan://local.rcan/acme/mower/1";

template <typename Op>
Op Reported(const std::string& vector) {
  schema::Judge judge{schema::JudgeLimits()};
  const std::string payload = test::ReadVector(vector, ".bin");
  const schema::Judgement judgement = judge.Payload(test::AsPayload(payload));
  if (judgement.record() == nullptr) {
    ADD_FAILURE() << judgement.rejection()->detail;
    return {};
  }
  return std::get<Op>(judgement.record()->body());
}

TEST(ForwardedVectorTest, KeepsAllOfAShapeButItsIdAndExpiry) {
  const auto op = Reported<model::ShapeOp>("shape");
  ASSERT_NE(op.upsert(), nullptr);
  const model::ReportedShape& sent = *op.upsert();
  const auto command = Decode(EncodeUpsert({}, sent, kOrigin));
  ASSERT_TRUE(command.ok()) << command.status();
  const auto& told = std::get<Shape>(command->what);
  EXPECT_EQ(told.identity.id, sent.identity.id + "@rcan://local.rcan/acme/mower/1");
  EXPECT_EQ(told.identity.name, sent.identity.name);
  EXPECT_EQ(told.identity.rev, sent.identity.rev);
  EXPECT_EQ(told.identity.hash, sent.identity.hash);
  EXPECT_TRUE(told.data == sent.data);
  EXPECT_EQ(model::EnumText(told.area_type), model::EnumText(sent.area_type));
  EXPECT_EQ(told.scope, sent.scope);
  EXPECT_EQ(told.min_z_m, sent.min_z_m);
  EXPECT_EQ(told.max_z_m, sent.max_z_m);
  EXPECT_EQ(told.level_id, sent.level_id);
}

TEST(ForwardedVectorTest, KeepsAllOfAnObjectButItsId) {
  const auto op = Reported<model::ObjectOp>("object");
  ASSERT_NE(op.upsert(), nullptr);
  const auto command = Decode(EncodeUpsert({}, *op.upsert(), kOrigin));
  ASSERT_TRUE(command.ok()) << command.status();
  auto told = std::get<model::Object>(command->what);
  EXPECT_EQ(told.id, op.upsert()->id + "@rcan://local.rcan/acme/mower/1");
  told.id = op.upsert()->id;
  EXPECT_TRUE(told == *op.upsert());
}

/// The least shape and object are deletes.
TEST(ForwardedVectorTest, DeletesByTheForwardedId) {
  const auto shape = Reported<model::ShapeOp>("shape-min");
  const auto object = Reported<model::ObjectOp>("object-min");
  ASSERT_NE(shape.deletion(), nullptr);
  ASSERT_NE(object.deletion(), nullptr);
  const auto no_shape = Decode(EncodeDelete({}, ItemKind::kShape, shape.id(), kOrigin));
  const auto no_object = Decode(EncodeDelete({}, ItemKind::kObject, object.id(), kOrigin));
  ASSERT_TRUE(no_shape.ok()) << no_shape.status();
  ASSERT_TRUE(no_object.ok()) << no_object.status();
  EXPECT_EQ(std::get<ShapeDeletion>(no_shape->what).id, ForwardedId(shape.id(), kOrigin));
  EXPECT_EQ(std::get<ObjectDeletion>(no_object->what).id, ForwardedId(object.id(), kOrigin));
}

}  // namespace
}  // namespace uplink::nexus_command
