#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <string_view>
#include <utility>

#include <gtest/gtest.h>

#include "schema/nexus_command/encode.h"
#include "tests/unit/schema/samples.h"

/// The bytes as robots of generation 0.1 read them, followed by hand: our own schema file cannot
/// vouch for itself.
namespace uplink::nexus_command {
namespace {

constexpr std::string_view kOrigin = "rcan://local.rcan/acme/mower/1";
constexpr CommandId kId = {0x00, 0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77,
                           0x88, 0x99, 0xAA, 0xBB, 0xCC, 0xDD, 0xEE, 0xFF};

/// A message of one segment as words; word 0 is the segment table, word 1 the root pointer.
class Words final {
 public:
  explicit Words(std::string bytes) : bytes_(std::move(bytes)) {}

  [[nodiscard]] std::uint64_t At(std::size_t word) const {
    std::uint64_t value = 0;
    std::memcpy(&value, bytes_.data() + word * sizeof(value), sizeof(value));
    return value;
  }
  /// Where the pointer in this word leads.
  [[nodiscard]] std::size_t Target(std::size_t word) const {
    return word + 1 + static_cast<std::size_t>((At(word) & 0xFFFF'FFFFU) >> 2U);
  }
  /// Words of the data section of the struct that the pointer in this word leads to.
  [[nodiscard]] std::size_t DataWords(std::size_t word) const {
    return (At(word) >> 32U) & 0xFFFFU;
  }
  [[nodiscard]] std::size_t count() const { return bytes_.size() / sizeof(std::uint64_t); }
  [[nodiscard]] const char* bytes(std::size_t word) const {
    return bytes_.data() + word * sizeof(std::uint64_t);
  }

 private:
  std::string bytes_;
};

/// The word that points to the InternalCommand.
std::size_t CommandPointer(const Words& words) { return words.Target(1) + 1; }

TEST(NexusCommandBytesTest, HaveOneSegmentAndTheIdAsRawBytes) {
  const Words words(EncodeDelete(kId, ItemKind::kShape, "a", kOrigin));
  EXPECT_EQ(words.At(0) & 0xFFFF'FFFFU, 0U);
  EXPECT_EQ(words.At(0) >> 32U, words.count() - 1);
  EXPECT_EQ(words.DataWords(1), 0U);
  const std::size_t id = words.Target(1);
  EXPECT_EQ(words.At(id) & 3U, 1U) << "a list";
  EXPECT_EQ(words.At(id) >> 32U, (kId.size() << 3U) | 2U) << "of 16 bytes";
  EXPECT_EQ(std::memcmp(words.bytes(words.Target(id)), kId.data(), kId.size()), 0);
}

/// setMode, the first member, takes the 16 bits before it.
TEST(NexusCommandBytesTest, HaveTheMembersNumberInBits16To32) {
  const Words shape(EncodeUpsert(kId, test::SampleShape(), kOrigin));
  const Words object(EncodeUpsert(kId, test::SampleObject(), kOrigin));
  const Words no_shape(EncodeDelete(kId, ItemKind::kShape, "a", kOrigin));
  const Words no_object(EncodeDelete(kId, ItemKind::kObject, "a", kOrigin));
  for (const Words* words : {&shape, &object, &no_shape, &no_object}) {
    EXPECT_EQ(words->DataWords(CommandPointer(*words)), 1U);
  }
  EXPECT_EQ(shape.At(shape.Target(CommandPointer(shape))), 8U << 16U);
  EXPECT_EQ(object.At(object.Target(CommandPointer(object))), 9U << 16U);
  EXPECT_EQ(no_shape.At(no_shape.Target(CommandPointer(no_shape))), 8U << 16U);
  EXPECT_EQ(no_object.At(no_object.Target(CommandPointer(no_object))), 9U << 16U);
}

TEST(NexusCommandBytesTest, SayUpsertAsZeroAndDeleteAsOne) {
  const Words upsert(EncodeUpsert(kId, test::SampleShape(), kOrigin));
  const Words deletion(EncodeDelete(kId, ItemKind::kShape, "a", kOrigin));
  const auto operation = [](const Words& words) {
    return words.At(words.Target(words.Target(CommandPointer(words)) + 1));
  };
  EXPECT_EQ(operation(upsert), 0U);
  EXPECT_EQ(operation(deletion), 1U);
}

TEST(RandomCommandIdTest, IsAVersion4UuidOfWhatIsDrawn) {
  EXPECT_EQ(RandomCommandId([] { return ~std::uint64_t{0}; }),
            (CommandId{0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x4F, 0xFF, 0xBF, 0xFF, 0xFF, 0xFF, 0xFF,
                       0xFF, 0xFF, 0xFF}));
  EXPECT_EQ(RandomCommandId([] { return std::uint64_t{0}; }),
            (CommandId{0, 0, 0, 0, 0, 0, 0x40, 0, 0x80, 0, 0, 0, 0, 0, 0, 0}));
  std::mt19937_64 random(7);
  const auto draw = [&random] { return random(); };
  EXPECT_NE(RandomCommandId(draw), RandomCommandId(draw));
}

TEST(ForwardedIdTest, IsTheIdAtItsOrigin) {
  EXPECT_EQ(ForwardedId("fence", "rcan://a/b/c/d"), "fence@rcan://a/b/c/d");
  EXPECT_EQ(ForwardedId("a@b", "o"), "a@b@o");
}

TEST(LayerRoleTest, OfAReportedRoleIsThatOfTheSameName) {
  for (std::size_t i = 0; i < model::kEnumNames<model::ReportedLayerRole>.size(); ++i) {
    const auto reported = static_cast<model::ReportedLayerRole>(i);
    EXPECT_EQ(model::EnumText(model::LayerRoleOf(reported)), model::EnumText(reported));
  }
}

TEST(LayerRoleTest, OfANumberWithoutANameHasNoNameEither) {
  for (const std::uint16_t number : std::to_array<std::uint16_t>({7, 17, 65'525, 65'526, 65'535})) {
    const auto role = model::LayerRoleOf(static_cast<model::ReportedLayerRole>(number));
    EXPECT_FALSE(model::IsRecognized(role)) << number;
  }
  EXPECT_EQ(static_cast<int>(model::LayerRoleOf(model::ReportedLayerRole{65'525})), 65'535);
  EXPECT_EQ(static_cast<int>(model::LayerRoleOf(model::ReportedLayerRole{65'526})), 65'535);
}

}  // namespace
}  // namespace uplink::nexus_command
