// What an answer takes while it is made, besides the rows that it is made of.
#include <cstddef>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "server/view/rows_json.h"
#include "tests/unit/server/view/heap_use.h"

namespace uplink::view {
namespace {

/// The answer's text may stand in memory twice while it grows, and one row as a message and a text.
constexpr std::size_t kTimesTheTextMax = 4;

template <typename Make>
void ExpectCheap(std::size_t text_bytes, Make make) {
  BeginPeak();
  const std::size_t before = HeapBytes();
  const auto json = make();
  const std::size_t took = HeapBytesPeak() - before;
  ASSERT_TRUE(json.ok()) << json.status();
  EXPECT_GE(json->size(), text_bytes);
  EXPECT_LT(took, kTimesTheTextMax * json->size())
      << static_cast<double>(took) / static_cast<double>(json->size()) << " times the text";
}

/// A line of so many positions that hold nothing, as it is stored.
std::string Zeros(std::size_t positions) {
  std::string text = R"({"type":"LineString","coordinates":[[0E0,0E0])";
  for (std::size_t i = 1; i < positions; ++i) text += ",[0E0,0E0]";
  return text + "]}";
}

TEST(AnswerMemory, AThousandShapesCostAFewTimesTheirText) {
  storage::Page<storage::ShapeRow> page;
  const std::string geometry = Zeros(200);
  for (int i = 0; i < 1000; ++i) page.rows.emplace_back().geometry_json = geometry;
  ExpectCheap(1000 * geometry.size(), [&] { return ToJson(page); });
}

TEST(AnswerMemory, ARobotsSettingsCostAFewTimesTheirText) {
  RobotView robot;
  std::string settings = R"({"k":[0)";
  for (int i = 0; i < 500'000; ++i) settings += ",0";
  settings += "]}";
  robot.stored.settings = settings;
  ExpectCheap(settings.size(), [&] { return ToJson(robot, PartSet::All()); });
}

TEST(AnswerMemory, QuarantineCostsAFewTimesItsPayloads) {
  storage::Page<storage::QuarantineRow> page;
  constexpr std::size_t kPayloadBytes = 64 * 1024;
  for (int i = 0; i < 100; ++i) page.rows.emplace_back().payload.assign(kPayloadBytes, 'p');
  ExpectCheap(100 * kPayloadBytes, [&] { return ToJson(page); });
}

}  // namespace
}  // namespace uplink::view
