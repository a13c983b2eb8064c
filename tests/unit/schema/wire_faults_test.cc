#include <array>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <capnp/any.h>
#include <capnp/message.h>
#include <capnp/schema.h>
#include <capnp/serialize.h>

#include "schema/limits.h"
#include "schema/uplink.capnp.h"
#include "tests/unit/schema/judging.h"
#include "tests/unit/schema/samples.h"

namespace uplink::test {
namespace {

using model::RejectReason;
using wire::UplinkMsg;

/// The bytes of a message that only the wire can say: null pointers and unknown members.
std::string Built(const std::function<void(UplinkMsg::Builder)>& fill) {
  capnp::MallocMessageBuilder builder;
  fill(builder.initRoot<UplinkMsg>());
  const auto words = capnp::messageToFlatArray(builder);
  const auto bytes = words.asChars();
  return {bytes.begin(), bytes.size()};
}

schema::Judgement JudgeWire(const std::function<void(UplinkMsg::Builder)>& fill) {
  return JudgeBytes(Built(fill));
}

/// Sets a struct's union discriminant: the first 16 bits of every struct of ours that is a union.
template <typename Builder>
void SetMember(Builder builder, std::uint16_t member) {
  auto data = capnp::AnyStruct::Builder(kj::mv(builder)).getDataSection();
  data[0] = static_cast<kj::byte>(member & 0xFFU);
  data[1] = static_cast<kj::byte>(member >> 8U);
}

TEST(WireTest, RejectsAnUnknownVariant) {
  const schema::Judgement judgement = JudgeWire([](auto m) {
    m.initAgentInfo();
    SetMember(m, 16);
  });
  ExpectRejected(judgement, RejectReason::kUnknownVariant, "");
  EXPECT_EQ(judgement.variant, std::nullopt);
}

TEST(WireTest, RejectsANullPointerInPlaceOfAnyMember) {
  for (std::uint16_t member = 0; member < model::kVariants; ++member) {
    const schema::Judgement judgement = JudgeWire([&](auto m) { SetMember(m, member); });
    ExpectRejected(judgement, RejectReason::kMissingField, "");
    EXPECT_EQ(judgement.variant, static_cast<model::Variant>(member));
  }
}

TEST(WireTest, TellsTheVariantOfWhatItDoesNotDecode) {
  const schema::JudgeLimits limits{.message_bytes_max = 1024};
  schema::Judge judge(limits);
  for (std::uint16_t member = 0; member < model::kVariants; ++member) {
    const std::string null = Built([&](auto m) { SetMember(m, member); });
    EXPECT_EQ(judge.VariantOf(AsPayload(null)), static_cast<model::Variant>(member));
  }
  EXPECT_EQ(judge.VariantOf(AsPayload(Built([](auto m) { SetMember(m, 16); }))), std::nullopt);
  EXPECT_EQ(judge.VariantOf(AsPayload("")), std::nullopt);
  EXPECT_EQ(judge.VariantOf(AsPayload("12345678")), std::nullopt);
  const auto with_text = [](std::size_t bytes) {
    return Built([bytes](auto m) { m.initMessage().setMessage(std::string(bytes, 'x')); });
  };
  std::size_t bytes = 1;
  while (with_text(bytes + 8).size() <= limits.message_bytes_max) bytes += 8;
  EXPECT_EQ(judge.VariantOf(AsPayload(with_text(bytes))), model::Variant::kMessage);
  EXPECT_EQ(judge.VariantOf(AsPayload(with_text(bytes + 8))), std::nullopt) << "too large";
}

TEST(WireTest, ReportsAnnouncedStructsThatAreNull) {
  ExpectThinned(JudgeWire([](auto m) {
                  auto motion = m.initMotionTelemetry();
                  motion.setHasPose(true);
                  motion.setHasGpsFixType(true);
                }),
                RejectReason::kMissingField, "pose");
  ExpectRejected(JudgeWire([](auto m) { m.initMotionTelemetry().setHasVelocity(true); }),
                 RejectReason::kMissingField, "velocity");
  ExpectThinned(JudgeWire([](auto m) { m.initStatusTelemetry().setHasBattery(true); }),
                RejectReason::kMissingField, "battery");
  ExpectThinned(JudgeWire([](auto m) { m.initStatusTelemetry().setHasFuel(true); }),
                RejectReason::kMissingField, "fuel");
}

TEST(WireTest, DoesNotJudgeWhatIsNotAnnounced) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const schema::Judgement judgement = JudgeWire([&](auto m) {
    auto status = m.initStatusTelemetry();
    auto battery = status.initBattery();
    battery.setSocPct(-400);
    battery.setVoltageV(kNan);
    status.setRangeRemaining(-1);
    status.setRuntimeRemaining(kNan);
    status.setMode(static_cast<wire::RobotMode>(99));
    status.initFuel().setVolumeUnit("\xFF");
  });
  ExpectGood(judgement);
  EXPECT_EQ(judgement.enumerants_unrecognized, 0U);
  EXPECT_TRUE(BodyOf<model::StatusTelemetry>(judgement) ==
              (model::StatusTelemetry{.battery = {},
                                      .mode = {},
                                      .estop = {},
                                      .status = "",
                                      .fuel = {},
                                      .range_remaining = {},
                                      .runtime_remaining = {}}));
}

TEST(WireTest, ReadsANullEStopAsAbsent) {
  const schema::Judgement judgement = JudgeWire([](auto m) { m.initStatusTelemetry(); });
  ExpectGood(judgement);
  EXPECT_EQ(BodyOf<model::StatusTelemetry>(judgement).estop, std::nullopt);
}

TEST(WireTest, ReadsANullTargetAsAbsent) {
  const schema::Judgement judgement = JudgeWire([](auto m) {
    auto mission = m.initMissionRunStatus();
    mission.setRunId("run");
    mission.setHasCurrentTarget(true);
    mission.setHasStatusMessage(true);
  });
  ExpectGood(judgement);
  const auto mission = BodyOf<model::MissionRunStatus>(judgement);
  EXPECT_EQ(mission.current_target, std::nullopt);
  EXPECT_EQ(mission.status_message, "");
}

TEST(WireTest, NeedsAnEventsKindAndItsStruct) {
  ExpectRejected(JudgeWire([](auto m) { m.initEventTelemetry(); }), RejectReason::kMissingField,
                 "kind");
  const std::vector<std::string> members = {"modeChanged", "missionStarted", "missionCompleted",
                                            "faultRaised", "faultCleared"};
  for (std::size_t i = 0; i < members.size(); ++i) {
    ExpectRejected(JudgeWire([&](auto m) {
                     SetMember(m.initEventTelemetry().initKind(),
                               static_cast<std::uint16_t>(i + 2));
                   }),
                   RejectReason::kMissingField, "kind." + members[i]);
  }
  ExpectRejected(JudgeWire([](auto m) { SetMember(m.initEventTelemetry().initKind(), 7); }),
                 RejectReason::kUnknownVariant, "kind");
}

TEST(WireTest, NeedsEveryValue) {
  const auto reading = [](auto m) {
    auto kv = m.initTelemetryExtras().initKv(2);
    kv[0].setKey("good");
    kv[0].initValue().setBool(true);
    kv[1].setKey("bad");
    return kv[1];
  };
  ExpectThinned(JudgeWire([&](auto m) { reading(m); }), RejectReason::kMissingField, "kv[1].value");
  ExpectThinned(JudgeWire([&](auto m) { SetMember(reading(m).initValue(), 5); }),
                RejectReason::kUnknownVariant, "kv[1].value");
  ExpectRejected(JudgeWire([](auto m) { m.initCurrentSettings(1)[0].setKey("k"); }),
                 RejectReason::kMissingField, "[0].value");
  ExpectRejected(JudgeWire([](auto m) {
                   auto setting = m.initCurrentSettings(1)[0];
                   setting.setKey("k");
                   SetMember(setting.initValue(), 5);
                 }),
                 RejectReason::kUnknownVariant, "[0].value");
  ExpectRejected(JudgeWire([](auto m) { m.initUiCapabilities().initSettings(1)[0].setKey("k"); }),
                 RejectReason::kMissingField, "settings[0].default");
}

TEST(WireTest, NeedsTheStructsOfAShape) {
  ExpectRejected(JudgeWire([](auto m) { SetMember(m.initShape(), 0); }),
                 RejectReason::kMissingField, "upsert");
  ExpectRejected(JudgeWire([](auto m) { SetMember(m.initShape(), 2); }),
                 RejectReason::kUnknownVariant, "");
  ExpectRejected(JudgeWire([](auto m) { m.initShape().initUpsert().initIdentity().setId("s"); }),
                 RejectReason::kMissingField, "upsert.data");
  ExpectRejected(JudgeWire([](auto m) { m.initShape().initUpsert().initData().initPoint(); }),
                 RejectReason::kMissingField, "upsert.identity");
  const std::vector<std::string> members = {"point",           "multiPoint", "lineString",
                                            "multiLineString", "polygon",    "multiPolygon"};
  std::uint16_t ordinal = 0;
  for (const std::string& member : members) {
    ExpectRejected(
        JudgeWire([&](auto m) { SetMember(m.initShape().initUpsert().initData(), ordinal); }),
        RejectReason::kMissingField, "upsert.data." + member);
    ++ordinal;
  }
  ExpectRejected(JudgeWire([](auto m) { SetMember(m.initShape().initUpsert().initData(), 6); }),
                 RejectReason::kUnknownVariant, "upsert.data");
}

TEST(WireTest, NeedsTheStructsOfAnObject) {
  ExpectRejected(JudgeWire([](auto m) { SetMember(m.initObject(), 0); }),
                 RejectReason::kMissingField, "upsert");
  ExpectRejected(JudgeWire([](auto m) { SetMember(m.initObject(), 2); }),
                 RejectReason::kUnknownVariant, "");
  ExpectRejected(JudgeWire([](auto m) { m.initObject().initUpsert().setId("o"); }),
                 RejectReason::kMissingField, "upsert.location");
}

/// Puts a list of structs without fields into a struct's first pointer: it costs no bytes, however
/// many it claims.
template <typename Builder>
void PutListOfNothing(Builder builder, unsigned count) {
  capnp::AnyStruct::Builder(kj::mv(builder))
      .getPointerSection()[0]
      .initAsListOfAnyStruct(0, 0, count);
}

TEST(WireTest, RejectsListsOfNothing) {
  const auto judge_extras = [](unsigned count) {
    return JudgeWire([&](auto m) { PutListOfNothing(m.initTelemetryExtras(), count); });
  };
  ExpectRejected(judge_extras(16), RejectReason::kMissingField, "kv[0].key");
  // Past the traversal limit, which goes by the bytes, it is Cap'n Proto that stops.
  for (const unsigned count : {64U, 256U, 257U, 2'000U, (1U << 29U) - 1}) {
    ExpectRejected(judge_extras(count), RejectReason::kMalformed, "");
  }
}

/// A shape of so many positions that has no bytes for any of them.
schema::Judgement JudgeNothing(std::uint16_t member, unsigned count) {
  return JudgeWire([&](auto m) {
    auto shape = m.initShape().initUpsert();
    shape.initIdentity().setId("s");
    auto data = shape.initData();
    SetMember(data, member);
    PutListOfNothing(data, count);
  });
}

TEST(WireTest, RejectsListsOfPositionsWithoutData) {
  constexpr std::uint16_t kMultiPoint = 1;
  constexpr std::uint16_t kLineString = 2;
  for (const std::uint16_t member : {kMultiPoint, kLineString}) {
    for (const unsigned count : {2U, 16U}) {
      ExpectRejected(JudgeNothing(member, count), RejectReason::kMalformed, "upsert.data");
    }
    // 160 bytes that were 32 KB in the store, and to each receiver.
    ExpectRejected(JudgeNothing(member, 2'000), RejectReason::kMalformed, "");
  }
  EXPECT_EQ(JudgeNothing(kLineString, 16).rejection()->detail, "16 positions without coordinates");
  // One position has no more than its own size.
  const schema::Judgement one = JudgeNothing(kMultiPoint, 1);
  ExpectGood(one);
  EXPECT_TRUE(BodyOf<model::ShapeOp>(one).upsert()->data ==
              model::ShapeData(model::MultiPoint{{{.lon = 0, .lat = 0}}}));
  const auto judge_ring = [](unsigned count) {
    return JudgeWire([&](auto m) {
      auto shape = m.initShape().initUpsert();
      shape.initIdentity().setId("s");
      PutListOfNothing(shape.initData().initPolygon(), count);
    });
  };
  ExpectRejected(judge_ring(3), RejectReason::kMalformed, "upsert.data");
}

TEST(WireTest, RejectsPositionsOfLessThanAWord) {
  // Cap'n Proto reads a list of bytes as structs that have one byte of data each.
  for (const unsigned count : {2U, 64U}) {
    ExpectRejected(JudgeWire([&](auto m) {
                     auto shape = m.initShape().initUpsert();
                     shape.initIdentity().setId("s");
                     auto data = shape.initData();
                     SetMember(data, 2);
                     capnp::AnyStruct::Builder(kj::mv(data))
                         .getPointerSection()[0]
                         .template initAs<capnp::List<std::uint8_t>>(count);
                   }),
                   RejectReason::kMalformed, "upsert.data");
  }
}

/// The message in its canonical form: structs end behind the last word that is not zero.
std::string Canonical(const std::function<void(UplinkMsg::Builder)>& fill) {
  capnp::MallocMessageBuilder builder;
  fill(builder.initRoot<UplinkMsg>());
  const auto words = capnp::canonicalize(builder.getRoot<UplinkMsg>().asReader());
  const auto content = words.asChars();
  const std::array<std::uint32_t, 2> table = {0, static_cast<std::uint32_t>(words.size())};
  std::string bytes(sizeof(table), '\0');
  std::memcpy(bytes.data(), table.data(), sizeof(table));
  return bytes + std::string(content.begin(), content.size());
}

TEST(WireTest, TakesPositionsInTheirCanonicalForm) {
  const auto line = [](const std::vector<model::GeoPoint2>& positions) {
    return JudgeBytes(Canonical([&](auto m) {
      auto shape = m.initShape().initUpsert();
      shape.initIdentity().setId("s");
      auto list = shape.initData().initMultiPoint(static_cast<unsigned>(positions.size()));
      for (unsigned i = 0; i < positions.size(); ++i) {
        list[i].setLon(positions[i].lon);
        list[i].setLat(positions[i].lat);
      }
    }));
  };
  ExpectGood(line({{.lon = 0, .lat = 0}}));
  ExpectGood(line({{.lon = 8, .lat = 0}, {.lon = 9, .lat = 0}}));  // one word for each
  ExpectGood(line({{.lon = 0, .lat = 0}, {.lon = 0, .lat = 47}}));
  ExpectRejected(line({{.lon = 0, .lat = 0}, {.lon = 0, .lat = 0}}), RejectReason::kMalformed,
                 "upsert.data");
}

TEST(WireTest, StopsLinesThatShareOneListOfPositions) {
  // All lines point at one list, so the counts multiply while the bytes do not.
  constexpr unsigned kLines = 256;
  constexpr unsigned kPositions = 4000;
  capnp::MallocMessageBuilder builder(16'384);  // words: everything in one segment
  auto shape = builder.initRoot<UplinkMsg>().initShape().initUpsert();
  shape.initIdentity().setId("s");
  shape.initData().initMultiLineString(kLines).init(kLines - 1, kPositions);
  auto words = capnp::messageToFlatArray(builder);
  // The pointers stand in a row before the last one's tag and positions.
  auto bytes = words.asChars();
  char* pointers = bytes.begin() + 8 * (words.size() - 2 * kPositions - 1 - kLines);
  std::uint64_t last = 0;
  std::memcpy(&last, pointers + 8 * (kLines - 1), sizeof(last));
  ASSERT_EQ(last & 7U, 1U) << "not a list pointer to the next word";
  for (unsigned line = 0; line + 1 < kLines; ++line) {
    const std::uint64_t pointer = last + 4 * std::uint64_t{kLines - 1 - line};
    std::memcpy(pointers + std::size_t{8} * line, &pointer, sizeof(pointer));
  }
  ExpectRejected(JudgeBytes({bytes.begin(), bytes.size()}), RejectReason::kTooManyItems,
                 "upsert.data");
}

TEST(WireTest, KnowsEveryMemberOfEveryEnumeration) {
  const auto same = [](auto ours, capnp::EnumSchema theirs) {
    using Ours = decltype(ours);
    const auto members = theirs.getEnumerants();
    ASSERT_EQ(members.size(), model::kEnumNames<Ours>.size());
    for (unsigned i = 0; i < members.size(); ++i) {
      EXPECT_EQ(std::string(members[i].getProto().getName().cStr()),
                model::EnumText(static_cast<Ours>(i)));
    }
  };
  using capnp::Schema;
  same(model::MissionStatus{}, Schema::from<wire::MissionStatus>());
  same(model::GpsFixType{}, Schema::from<wire::GpsFixType>());
  same(model::GpsSource{}, Schema::from<wire::GpsSource>());
  same(model::RobotMode{}, Schema::from<wire::RobotMode>());
  same(model::PowerSupplyStatus{}, Schema::from<wire::PowerSupplyStatus>());
  same(model::PowerSupplyHealth{}, Schema::from<wire::PowerSupplyHealth>());
  same(model::PowerSupplyTechnology{}, Schema::from<wire::PowerSupplyTechnology>());
  same(model::CapabilityType{}, Schema::from<wire::CapabilityType>());
  same(model::Role{}, Schema::from<wire::Role>());
  same(model::DangerLevel{}, Schema::from<wire::DangerLevel>());
  same(model::ValueType{}, Schema::from<wire::ValueType>());
  same(model::DisplayHint{}, Schema::from<wire::DisplayHint>());
  same(model::FaultSeverity{}, Schema::from<wire::FaultSeverity>());
  same(model::ReportedLayerRole{}, Schema::from<wire::ReportedLayerRole>());
  same(model::ScopeType{}, Schema::from<wire::ScopeType>());
  same(model::ObjectType{}, Schema::from<wire::ObjectType>());
  same(model::MessageLevel{}, Schema::from<wire::MessageLevel>());
}

}  // namespace
}  // namespace uplink::test
