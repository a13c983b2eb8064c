#include "server/transport/end_cause.h"

#include <fstream>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace uplink::transport {
namespace {

TEST(EndCause, EachHasItsReason) {
  const std::vector<std::pair<EndCause, const char*>> expected = {
      {EndCause::kClosed, "orderly"},      {EndCause::kReset, "broken"},
      {EndCause::kCut, "broken"},          {EndCause::kUnanswered, "silent"},
      {EndCause::kSuperseded, "replaced"}, {EndCause::kDrain, "drained"},
      {EndCause::kAge, "drained"},         {EndCause::kExpired, "certificate_expired"},
      {EndCause::kNotRead, "not_read"},    {EndCause::kBrokeRules, "protocol_error"},
      {EndCause::kBound, "refused"},       {EndCause::kUnconfirmed, "refused"},
      {EndCause::kNotAllowed, "refused"},  {EndCause::kForgotten, "refused"},
      {EndCause::kBlocked, "refused"},     {EndCause::kDisconnected, "refused"},
      {EndCause::kStoreLost, "refused"},   {EndCause::kServerStops, "server_ended"},
  };
  ASSERT_EQ(expected.size(), kAllEndCauses.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(kAllEndCauses[i], expected[i].first) << i;
    EXPECT_EQ(model::ToText(WhyOf(expected[i].first)), expected[i].second) << i;
  }
}

TEST(EndCause, EachReasonHasACause) {
  std::set<model::ConnectionEnd> ends;
  for (const EndCause cause : kAllEndCauses) ends.insert(WhyOf(cause));
  EXPECT_EQ(ends.size(), model::kAllConnectionEnds.size());
}

// Tests start in the tree's top folder.
TEST(EndCause, ThePageHasEachReason) {
  std::ifstream page("docs/reference/connections.md");
  ASSERT_TRUE(page) << "docs/reference/connections.md cannot be read";
  std::vector<std::string> words;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("| `")) words.push_back(line.substr(3, line.find('`', 3) - 3));
  }
  std::vector<std::string> reasons;
  reasons.reserve(model::kAllConnectionEnds.size());
  for (const model::ConnectionEnd end : model::kAllConnectionEnds) {
    reasons.emplace_back(model::ToText(end));
  }
  EXPECT_EQ(words, reasons) << "one row each, in this order";
}

TEST(EndCause, EachHasASentence) {
  std::set<std::string> sentences;
  for (const EndCause cause : kAllEndCauses) sentences.emplace(SentenceOf(cause));
  EXPECT_EQ(sentences.size(), kAllEndCauses.size());
  EXPECT_FALSE(sentences.contains(""));
}

}  // namespace
}  // namespace uplink::transport
