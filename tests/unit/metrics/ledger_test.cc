#include "metrics/ledger.h"

#include <limits>

#include <gtest/gtest.h>

namespace uplink::metrics {
namespace {

TEST(UplinkCountsTest, NothingIsBalanced) { EXPECT_TRUE(MessageCounts().Balanced()); }

TEST(UplinkCountsTest, EveryColumnIsPartOfTheLaw) {
  MessageCounts counts{.received = 21,
                       .stored = 1,
                       .applied = 2,
                       .superseded = 3,
                       .duplicate = 4,
                       .rejected = 5,
                       .in_flight = 6};
  EXPECT_TRUE(counts.Balanced());
  for (std::uint64_t MessageCounts::*column :
       {&MessageCounts::received, &MessageCounts::stored, &MessageCounts::applied,
        &MessageCounts::superseded, &MessageCounts::duplicate, &MessageCounts::rejected}) {
    ++(counts.*column);
    EXPECT_FALSE(counts.Balanced());
    --(counts.*column);
  }
  ++counts.in_flight;
  EXPECT_FALSE(counts.Balanced());
}

TEST(UplinkCountsTest, MissingReasonsAndVariantsAreOutsideTheLaw) {
  MessageCounts counts;
  counts.missing = 5;
  counts.rejects[1] = 3;
  counts.records[2] = 4;
  EXPECT_TRUE(counts.Balanced());
}

TEST(UplinkCountsTest, AddsEveryColumn) {
  MessageCounts delta{.received = 1,
                      .stored = 2,
                      .applied = 3,
                      .superseded = 4,
                      .duplicate = 5,
                      .rejected = 6,
                      .in_flight = -7,
                      .missing = 8};
  delta.rejects[model::kRejectReasons] = 9;
  delta.records[model::kVariants - 1] = 10;
  MessageCounts sum;
  sum += delta;
  sum += delta;
  EXPECT_EQ(sum.received, 2U);
  EXPECT_EQ(sum.stored, 4U);
  EXPECT_EQ(sum.applied, 6U);
  EXPECT_EQ(sum.superseded, 8U);
  EXPECT_EQ(sum.duplicate, 10U);
  EXPECT_EQ(sum.rejected, 12U);
  EXPECT_EQ(sum.in_flight, -14);
  EXPECT_EQ(sum.missing, 16U);
  EXPECT_EQ(sum.rejects[model::kRejectReasons], 18U);
  EXPECT_EQ(sum.records[model::kVariants - 1], 20U);
}

TEST(UplinkCountsTest, MissingStopsAtTheTopInsteadOfWrapping) {
  constexpr std::uint64_t kTop = std::numeric_limits<std::uint64_t>::max();
  MessageCounts counts{.missing = kTop - 1};
  counts += {.missing = 1};
  EXPECT_EQ(counts.missing, kTop);
  counts += {.missing = 1};
  EXPECT_EQ(counts.missing, kTop);
}

TEST(LedgerTest, APageHoldsWhatWasPublished) {
  Ledger ledger;
  ledger.Publish({.received = 2, .in_flight = 2});
  ledger.Publish({.stored = 1, .in_flight = -1});
  ledger.CountDropped(static_cast<std::size_t>(model::Variant::kStatusTelemetry),
                      model::RejectReason::kOutOfRange);
  ledger.CountDropped(static_cast<std::size_t>(model::Variant::kStatusTelemetry),
                      model::RejectReason::kNotFinite, 240);
  ledger.CountOdd({.times_unknown = 3, .enumerants_unrecognized = 4, .control_characters = 5});
  const Ledger::Page page = ledger.Read();
  EXPECT_EQ(page.messages.in_flight, 1);
  EXPECT_TRUE(page.messages.Balanced());
  EXPECT_EQ(page.dropped[static_cast<std::size_t>(model::Variant::kStatusTelemetry)]
                        [static_cast<std::size_t>(model::RejectReason::kOutOfRange)],
            1U);
  EXPECT_EQ(page.dropped[static_cast<std::size_t>(model::Variant::kStatusTelemetry)]
                        [static_cast<std::size_t>(model::RejectReason::kNotFinite)],
            240U);
  EXPECT_EQ(page.odd.times_unknown, 3U);
  EXPECT_EQ(page.odd.enumerants_unrecognized, 4U);
  EXPECT_EQ(page.odd.control_characters, 5U);
}

TEST(LedgerBookTest, TheLawHoldsInTheSumOverPages) {
  LedgerBook book;
  Ledger& intake = book.NewPage();
  Ledger& journal = book.NewPage();
  intake.Publish({.received = 5, .in_flight = 5});
  journal.Publish({.stored = 3, .in_flight = -3});
  intake.CountOdd({.times_unknown = 1, .control_characters = 2});
  journal.CountOdd({.times_unknown = 1, .control_characters = 3});
  intake.CountDropped(static_cast<std::size_t>(model::Variant::kFault),
                      model::RejectReason::kMalformed);
  journal.CountDropped(static_cast<std::size_t>(model::Variant::kFault),
                       model::RejectReason::kMalformed);
  const Ledger::Page sum = book.Sum();
  EXPECT_TRUE(sum.messages.Balanced());
  EXPECT_EQ(sum.messages.in_flight, 2);
  EXPECT_EQ(sum.odd.times_unknown, 2U);
  EXPECT_EQ(sum.odd.control_characters, 5U);
  EXPECT_EQ(sum.dropped[static_cast<std::size_t>(model::Variant::kFault)]
                       [static_cast<std::size_t>(model::RejectReason::kMalformed)],
            2U);
}

TEST(LedgerBookTest, SumsThePagesOfEachSourceAndOfAll) {
  LedgerBook book;
  book.NewPage(model::MessageSource::kUplink).Publish({.received = 1, .applied = 1});
  book.NewPage(model::MessageSource::kCyberwave).Publish({.received = 4, .ignored = 4});
  book.NewPage(model::MessageSource::kCyberwave).Publish({.received = 2, .refused = 2});
  EXPECT_EQ(book.Sum(model::MessageSource::kUplink).messages.received, 1U);
  EXPECT_EQ(book.Sum(model::MessageSource::kCyberwave).messages.received, 6U);
  EXPECT_EQ(book.Sum(model::MessageSource::kCyberwave).messages.applied, 0U);
  EXPECT_EQ(book.Sum().messages.received, 7U);
  EXPECT_TRUE(book.Sum().messages.Balanced());
}

TEST(MessageCountsTest, CountsAMessageInTheColumnOfWhatItBecame) {
  for (std::size_t became = 0; became < kBecame.size(); ++became) {
    MessageCounts counts{.received = 1};
    EXPECT_FALSE(counts.Balanced());
    counts.Count(static_cast<Became>(became));
    EXPECT_EQ(counts.*kBecame.at(became).count, 1U) << kBecame.at(became).name;
    EXPECT_TRUE(counts.Balanced()) << kBecame.at(became).name;
  }
}

}  // namespace
}  // namespace uplink::metrics
