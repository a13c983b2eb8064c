#include "server/config/tls_groups.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/config/minimal.h"

namespace uplink::config {
namespace {

using ::testing::HasSubstr;
using ::uplink::config::testing::ParseWith;

/// The text of the one problem with these groups; empty if there is none.
std::string OneProblem(const std::string& groups) {
  const LoadResult result = ParseWith("groups = " + groups + "\n");
  EXPECT_LE(result.problems.size(), 1U);
  return result.problems.empty() ? std::string() : ToText(result.problems[0]);
}

std::string ServedWith(const std::string& more) {
  const LoadResult result = ParseWith(more);
  EXPECT_TRUE(result.ok());
  return ServedGroups(result.config->tls);
}

TEST(TlsGroups, AreSomeOfFour) {
  EXPECT_EQ(OneProblem("[\"P-521\"]"), "");
  EXPECT_EQ(OneProblem("[\"P-256\", \"X25519\", \"P-384\", \"P-521\"]"), "");
  EXPECT_THAT(
      OneProblem("[\"X25519\", \"x448\"]"),
      HasSubstr("tls.groups: \"x448\" is no group; take one of X25519, P-256, P-384, P-521"));
  EXPECT_THAT(OneProblem("[]"), HasSubstr("tls.groups: it is empty"));
  EXPECT_THAT(OneProblem("[\"P-256\", \"P-256\"]"), HasSubstr("\"P-256\" stands in it twice"));
}

TEST(TlsGroups, AreServedInTheirOrder) {
  EXPECT_EQ(ServedWith(""), "X25519:P-256");
  EXPECT_EQ(ServedWith("groups = [\"P-384\", \"X25519\"]\n"), "P-384:X25519");
}

TEST(TlsGroups, HaveTheCurvesOfCertificatesWhileTls12IsAccepted) {
  EXPECT_EQ(ServedWith("min_version = \"1.2\"\n"), "X25519:P-256:P-384:P-521");
  EXPECT_EQ(ServedWith("min_version = \"1.2\"\ngroups = [\"P-384\", \"X25519\"]\n"),
            "P-384:X25519:P-256:P-521");
  EXPECT_EQ(ServedWith("min_version = \"1.2\"\ngroups = [\"X25519\"]\n"),
            "X25519:P-256:P-384:P-521");
}

}  // namespace
}  // namespace uplink::config
