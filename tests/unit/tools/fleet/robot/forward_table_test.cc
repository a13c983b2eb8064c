// A robot's table of what others share: by the frames alone, and strict with the server.
#include "tools/uplink-fleet/robot/forward_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/nexus_command/encode.h"

namespace uplink::synthetic {
namespace {

using nexus_command::ItemKind;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

constexpr const char* kSelf = "rcan://test/self";
constexpr const char* kOther = "rcan://test/other";

v1::Forward Mark(v1::ForwardKind kind) {
  v1::Forward forward;
  forward.set_kind(kind);
  return forward;
}

v1::Forward Command(const std::string& bytes, const std::string& origin) {
  v1::Forward forward = Mark(v1::FORWARD_KIND_COMMAND);
  forward.set_origin_ruri(origin);
  forward.set_nexus_command(bytes);
  return forward;
}

model::ReportedShape ShapeOf(const std::string& id, std::uint32_t rev = 1) {
  model::ReportedShape shape;
  shape.identity = {.id = id, .name = "hole", .rev = rev, .hash = ""};
  shape.data = model::GeoPoint2{.lon = 8, .lat = 47};
  shape.area_type = model::ReportedLayerRole::kHazard;
  shape.scope = model::ScopeType::kFleet;
  return shape;
}

v1::Forward Upsert(const model::ReportedShape& shape, const std::string& origin = kOther) {
  return Command(nexus_command::EncodeUpsert({1}, shape, origin), origin);
}

v1::Forward Upsert(const std::string& id, std::uint32_t rev = 1) {
  return Upsert(ShapeOf(id, rev));
}

v1::Forward Delete(const std::string& id) {
  return Command(nexus_command::EncodeDelete({2}, ItemKind::kShape, id, kOther), kOther);
}

class ForwardTableTest : public ::testing::Test {
 protected:
  /// A new stream, on which a snapshot with these shapes comes.
  void Snapshot(const std::vector<std::string>& ids) {
    table_.BeginStream();
    table_.Take(Mark(v1::FORWARD_KIND_SNAPSHOT_BEGIN));
    for (const std::string& id : ids) table_.Take(Upsert(id));
    table_.Take(Mark(v1::FORWARD_KIND_SNAPSHOT_END));
  }
  [[nodiscard]] std::vector<std::string> Ids() const {
    std::vector<std::string> ids;
    for (const auto& [item, fingerprint] : table_.Held()) ids.push_back(item->id);
    return ids;
  }
  void ExpectViolation(const char* text) const {
    EXPECT_EQ(table_.violations(), 1U);
    EXPECT_THAT(table_.first_violation(), HasSubstr(text));
  }

  ForwardReader reader_;
  ForwardTable table_{kSelf, reader_};
};

TEST_F(ForwardTableTest, ASnapshotReplacesOnceItIsWhole) {
  Snapshot({"a", "b"});
  EXPECT_TRUE(table_.whole());
  EXPECT_THAT(Ids(), UnorderedElementsAre("a@rcan://test/other", "b@rcan://test/other"));
  table_.BeginStream();
  EXPECT_FALSE(table_.whole());
  table_.Take(Mark(v1::FORWARD_KIND_SNAPSHOT_BEGIN));
  table_.Take(Upsert("c"));
  EXPECT_THAT(Ids(), UnorderedElementsAre("a@rcan://test/other", "b@rcan://test/other"))
      << "what is held is kept until the end";
  table_.Take(Mark(v1::FORWARD_KIND_SNAPSHOT_END));
  EXPECT_THAT(Ids(), ElementsAre("c@rcan://test/other"));
  EXPECT_EQ(table_.snapshots(), 2U);
  EXPECT_EQ(table_.changes(), 0U);
  EXPECT_EQ(table_.violations(), 0U) << table_.first_violation();
}

TEST_F(ForwardTableTest, ASnapshotThatBrokeOffChangesNothing) {
  Snapshot({"a"});
  table_.BeginStream();
  table_.Take(Mark(v1::FORWARD_KIND_SNAPSHOT_BEGIN));
  Snapshot({"a"});
  EXPECT_THAT(Ids(), ElementsAre("a@rcan://test/other"));
  EXPECT_EQ(table_.violations(), 0U) << table_.first_violation();
}

TEST_F(ForwardTableTest, ChangesFollow) {
  Snapshot({"a"});
  const std::uint64_t before = table_.Held().front().second;
  table_.Take(Upsert("a", 2));
  EXPECT_NE(table_.Held().front().second, before);
  table_.Take(Upsert("a", 1));
  EXPECT_EQ(table_.Held().front().second, before) << "equal contents, equal fingerprints";
  table_.Take(Delete("a"));
  EXPECT_THAT(Ids(), IsEmpty());
  EXPECT_EQ(table_.changes(), 3U);
  EXPECT_EQ(table_.violations(), 0U) << table_.first_violation();
}

TEST_F(ForwardTableTest, ShapesAndObjectsOfOneIdAreTwo) {
  Snapshot({"a"});
  model::Object object;
  object.id = "a";
  object.scope = model::ScopeType::kFleet;
  table_.Take(Command(nexus_command::EncodeUpsert({1}, object, kOther), kOther));
  EXPECT_EQ(table_.Held().size(), 2U);
  table_.Take(Delete("a"));
  ASSERT_EQ(table_.Held().size(), 1U);
  EXPECT_EQ(table_.Held().front().first->kind, ItemKind::kObject);
  EXPECT_EQ(table_.violations(), 0U) << table_.first_violation();
}

TEST_F(ForwardTableTest, ACommandBeforeTheFirstSnapshot) {
  table_.BeginStream();
  table_.Take(Upsert("a"));
  ExpectViolation("before the stream's first snapshot");
}

TEST_F(ForwardTableTest, ADeleteOfWhatIsNotHeld) {
  Snapshot({"a"});
  table_.Take(Delete("b"));
  ExpectViolation("shape b@rcan://test/other ended, but was never shared");
}

TEST_F(ForwardTableTest, ADeleteWithinASnapshot) {
  Snapshot({"a"});
  table_.Take(Mark(v1::FORWARD_KIND_SNAPSHOT_BEGIN));
  table_.Take(Delete("a"));
  ExpectViolation("within a snapshot");
}

TEST_F(ForwardTableTest, OfAnItemThatStandsTwiceInASnapshotTheLaterCounts) {
  Snapshot({"a"});
  const std::uint64_t before = table_.Held().front().second;
  table_.Take(Mark(v1::FORWARD_KIND_SNAPSHOT_BEGIN));
  table_.Take(Upsert("a", 1));
  table_.Take(Upsert("a", 2));
  table_.Take(Mark(v1::FORWARD_KIND_SNAPSHOT_END));
  EXPECT_THAT(Ids(), ElementsAre("a@rcan://test/other"));
  EXPECT_NE(table_.Held().front().second, before);
  EXPECT_EQ(table_.violations(), 0U) << table_.first_violation();
}

TEST_F(ForwardTableTest, AnOwnItem) {
  Snapshot({});
  table_.Take(Upsert(ShapeOf("a"), kSelf));
  ExpectViolation("came back to its origin");
  EXPECT_THAT(Ids(), IsEmpty());
}

TEST_F(ForwardTableTest, AnIdOfAnotherThanTheOrigin) {
  Snapshot({});
  v1::Forward forward = Upsert("a");
  forward.set_origin_ruri("rcan://test/third");
  table_.Take(forward);
  ExpectViolation("came as one of rcan://test/third");
}

TEST_F(ForwardTableTest, AnIdThatHoldsAnotherRobotsAddressIsOfItsOrigin) {
  const std::string id = std::string("a@") + kSelf;
  Snapshot({id});
  EXPECT_THAT(Ids(), ElementsAre("a@rcan://test/self@rcan://test/other"));
  EXPECT_TRUE(IsOf(*table_.Held().front().first, kOther));
  EXPECT_FALSE(IsOf(*table_.Held().front().first, kSelf));
  table_.Take(Delete(id));
  EXPECT_THAT(Ids(), IsEmpty());
  EXPECT_EQ(table_.violations(), 0U) << table_.first_violation();
}

TEST_F(ForwardTableTest, BytesThatAreNoCommand) {
  Snapshot({});
  table_.Take(Command("no command", kOther));
  EXPECT_EQ(table_.violations(), 1U);
  table_.Take(Command("", kOther));
  EXPECT_EQ(table_.violations(), 2U);
}

TEST_F(ForwardTableTest, MarksOutOfOrderAndOfNoKind) {
  table_.BeginStream();
  table_.Take(Mark(v1::FORWARD_KIND_SNAPSHOT_END));
  ExpectViolation("had not begun");
  table_.Take(Mark(v1::FORWARD_KIND_SNAPSHOT_BEGIN));
  table_.Take(Mark(v1::FORWARD_KIND_SNAPSHOT_BEGIN));
  EXPECT_EQ(table_.violations(), 2U);
  table_.Take(Mark(v1::FORWARD_KIND_UNSPECIFIED));
  EXPECT_EQ(table_.violations(), 3U);
}

TEST(ForwardReaderTest, ReadsTheSameBytesOnceAndForgetsAtItsBound) {
  ForwardReader reader;
  const ItemRef first = reader.Read(Upsert("a")).item;
  EXPECT_EQ(reader.Read(Upsert("a")).item, first);
  for (std::size_t i = 0; i < kReadCommandsMax; ++i) {
    static_cast<void>(reader.Read(Delete(std::to_string(i))));
  }
  EXPECT_NE(reader.Read(Upsert("a")).item, first);
  EXPECT_THAT(reader.origins(), ElementsAre(kOther));
}

}  // namespace
}  // namespace uplink::synthetic
