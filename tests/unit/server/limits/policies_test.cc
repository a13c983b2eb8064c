#include "server/limits/policies.h"

#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <utility>

#include <fmt/core.h>
#include <gtest/gtest.h>

namespace uplink::limits {
namespace {

/// `64 MiB` of bytes, else the number in groups of three.
std::string Amount(const Policy& policy, std::uint64_t amount) {
  if (policy.of.find("bytes") != std::string_view::npos) {
    return fmt::format("{} MiB", amount / config::kMiB);
  }
  std::string text = std::to_string(amount);
  for (std::size_t at = text.size(); at > 3; at -= 3) text.insert(at - 3, ",");
  return text;
}

/// The table of docs/operate/limits.md.
std::string PoliciesTable() {
  std::string table =
      "| of each | counted | most | at once | remembered | shown by | key |\n"
      "| --- | --- | --- | --- | --- | --- | --- |\n";
  for (const Policy& policy : kPolicies) {
    table += fmt::format("| {} | {} | {} per {} | {} | {} | `{}` | {} |\n", policy.whose, policy.of,
                         Amount(policy, policy.most),
                         policy.per == std::chrono::seconds(1) ? "second" : "minute",
                         Amount(policy, policy.at_once),
                         policy.keys_max == 0 ? "" : fmt::format("{}", policy.keys_max),
                         metrics::SpecOf(policy.shown).name,
                         policy.key.empty() ? "" : fmt::format("`{}`", policy.key));
  }
  return table;
}

TEST(Policies, AreInTheOrderOfTheirIds) {
  for (std::size_t i = 0; i < kPolicies.size(); ++i) {
    EXPECT_EQ(static_cast<std::size_t>(kPolicies[i].id), i) << kPolicies[i].of;
  }
}

TEST(Policies, EachHasABoundAndSaysOfWhomInWordsOfItsOwn) {
  std::set<std::pair<std::string_view, std::string_view>> names;
  for (const Policy& policy : kPolicies) {
    EXPECT_GT(policy.most, 0U) << policy.of;
    EXPECT_GE(policy.at_once, policy.most) << policy.of << ": less at once than in its span";
    EXPECT_TRUE(names.emplace(policy.whose, policy.of).second) << policy.whose << policy.of;
    EXPECT_TRUE(policy.per == std::chrono::seconds(1) || policy.per == std::chrono::minutes(1));
  }
}

// Tests start in the tree's top folder.
TEST(Policies, TheLimitsPageHoldsTheTable) {
  std::ifstream file("docs/operate/limits.md");
  ASSERT_TRUE(file) << "docs/operate/limits.md cannot be read";
  std::stringstream page;
  page << file.rdbuf();
  EXPECT_NE(page.str().find(PoliciesTable()), std::string::npos)
      << "the table of policies has changed; it is now:\n"
      << PoliciesTable();
}

}  // namespace
}  // namespace uplink::limits
