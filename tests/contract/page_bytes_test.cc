#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "schema/json/text.h"
#include "schema/limits.h"
#include "tests/contract/store_contract.h"
#include "tests/unit/schema/samples.h"

/// Pages of large rows end at kPageBytesMax.
namespace uplink::testing {
namespace {

using storage::kPageBytesMax;

class PageBytesContract : public StoreContract {
 protected:
  static constexpr std::size_t kPayloadBytes = 256 * std::size_t{1024};
  /// More than a page's worth of them.
  static constexpr std::size_t kPayloads = kPageBytesMax / kPayloadBytes + 8;

  /// The bytes of each page's rows, over all pages. `read` gives a page by its token.
  template <typename Read, typename BytesOf>
  static std::vector<std::size_t> PageBytes(const Read& read, const BytesOf& bytes_of,
                                            std::size_t& rows) {
    std::vector<std::size_t> pages;
    std::string token;
    do {
      const auto page = read(token);
      EXPECT_TRUE(page.ok()) << page.status();
      if (!page.ok()) return pages;
      std::size_t bytes = 0;
      for (const auto& row : page->rows) bytes += bytes_of(row);
      rows += page->rows.size();
      pages.push_back(bytes);
      token = page->next_token;
    } while (!token.empty() && pages.size() < 10);
    return pages;
  }

  /// Two pages: the first ends with the row that passed the bound, a few texts more or less.
  static void ExpectCut(const std::vector<std::size_t>& pages, std::size_t row_bytes) {
    ASSERT_EQ(pages.size(), 2U);
    EXPECT_GE(pages[0], kPageBytesMax - row_bytes);
    EXPECT_LE(pages[0], kPageBytesMax + row_bytes);
    EXPECT_GE(pages[1], row_bytes);
  }
};

TEST_P(PageBytesContract, EndAPageOfQuarantine) {
  Open();
  std::vector<storage::CommitRecord> records;
  for (model::Seq seq = 1; seq <= kPayloads; ++seq) {
    records.push_back(Bad(seq, std::string(kPayloadBytes, 'p')));
  }
  Commit(std::move(records));
  std::size_t rows = 0;
  const auto pages = PageBytes(
      [this](const std::string& token) {
        storage::HistoryQuery query;
        query.page_token = token;
        query.page_size = storage::kPageSizeMax;
        return store_->reader().Quarantine({.rows = query});
      },
      [](const storage::QuarantineRow& row) { return row.payload.size(); }, rows);
  EXPECT_EQ(rows, kPayloads) << "each row once";
  ExpectCut(pages, kPayloadBytes);
}

TEST_P(PageBytesContract, EndAPageOfShapes) {
  Open();
  model::ReportedShape shape = test::SampleShape();
  model::Positions positions(schema::kShapePositionsMax, {8.123456789012345, 47.12345678901234});
  shape.data = model::LineString{positions};
  const std::size_t row_bytes = json::GeometryText(shape.data).size();
  const std::size_t shapes = kPageBytesMax / row_bytes + 8;
  std::vector<storage::CommitRecord> records;
  for (model::Seq seq = 1; seq <= shapes; ++seq) {
    shape.identity.id = std::to_string(seq);
    records.push_back(Good(seq, model::ShapeOp{shape}));
  }
  Commit(std::move(records));
  std::size_t rows = 0;
  const auto pages = PageBytes(
      [this](const std::string& token) {
        storage::PresentQuery query;
        query.rows.page_token = token;
        return store_->reader().Shapes(query);
      },
      [](const storage::ShapeRow& row) { return row.geometry_json.size(); }, rows);
  EXPECT_EQ(rows, shapes);
  ExpectCut(pages, row_bytes);
}

TEST_P(PageBytesContract, LeaveAThousandOfTheLongestMessagesInOnePage) {
  static_assert(schema::kMessageTextBytesMax * storage::kPageSizeMax < kPageBytesMax);
  Open();
  const model::Record good = test::RecordOf(model::Message{
      0, model::MessageLevel::kInfo, std::string(schema::kMessageTextBytesMax, 'm')});
  std::vector<storage::CommitRecord> records;
  for (model::Seq seq = 1; seq <= storage::kPageSizeMax; ++seq) records.push_back(With(seq, good));
  Commit(std::move(records));
  storage::HistoryQuery query;
  query.page_size = storage::kPageSizeMax;
  const auto page = store_->reader().Messages({.rows = query});
  ASSERT_TRUE(page.ok()) << page.status();
  EXPECT_EQ(page->rows.size(), storage::kPageSizeMax);
  EXPECT_EQ(page->next_token, "");
}

TEST_P(PageBytesContract, BoundTheLatestAfterAWholeRobot) {
  Open();
  model::UiCapabilities capabilities;
  for (int i = 0; i < 60; ++i) {
    model::ServiceCapability service;
    service.name = std::to_string(i);
    service.description = std::string(schema::kDescriptionBytesMax, 'd');
    capabilities.services.push_back(service);
  }
  const model::Record good = test::RecordOf(capabilities);
  const model::Record agent = test::RecordOf(test::SampleAgentInfo());
  const std::size_t body_bytes = json::Text(capabilities).size();
  const std::size_t robots = kPageBytesMax / body_bytes + 8;
  std::vector<storage::RobotRef> all;
  for (std::size_t i = 0; i < robots; ++i) all.push_back(Robot(std::to_string(i)));
  OpenAlso(all);
  std::vector<storage::CommitRecord> records;
  std::vector<std::string> ruris;
  for (const storage::RobotRef& robot : all) {
    records.push_back(Of(robot, With(1, good)));
    records.push_back(Of(robot, With(2, agent)));
    ruris.push_back(robot->ruri);
  }
  Commit(std::move(records));
  const auto first = store_->reader().Latest(ruris, kAllLatest);
  ASSERT_TRUE(first.ok()) << first.status();
  EXPECT_LT(first->complete, robots);
  EXPECT_GE(first->complete, kPageBytesMax / body_bytes - 1);
  EXPECT_LE(first->complete, kPageBytesMax / body_bytes + 1);
  EXPECT_EQ(first->rows.size(), 2 * first->complete) << "all of each that was looked at";
  EXPECT_EQ(first->rows.back().ruri, ruris[first->complete - 1]);
  const std::span<const std::string> left = std::span(ruris).subspan(first->complete);
  const auto rest = store_->reader().Latest(left, kAllLatest);
  ASSERT_TRUE(rest.ok()) << rest.status();
  EXPECT_EQ(rest->complete, left.size());
  EXPECT_EQ(rest->rows.size(), 2 * left.size());
}

INSTANTIATE_TEST_SUITE_P(Stores, PageBytesContract, EveryStore(), NameOfKind);

}  // namespace
}  // namespace uplink::testing
