#include "tools/uplinkctl/doctor/service_user.h"

#include <gtest/gtest.h>
#include <unistd.h>

namespace uplink::ctl {
namespace {

TEST(ServiceUser, AUserOfTheMachineIsFound) {
  const std::optional<User> root = FindUser("root");
  ASSERT_TRUE(root.has_value());
  EXPECT_EQ(root->uid, 0U);
  EXPECT_FALSE(FindUser("no such user").has_value());
}

TEST(ServiceUser, AnUnknownUserIsWrongUse) {
  EXPECT_TRUE(absl::IsInvalidArgument(UserToCheckAs("no such user").status()));
}

TEST(ServiceUser, OnlyRootBecomesAnother) {
  const User current = CurrentUser();
  EXPECT_EQ(current.uid, ::geteuid());
  const auto other = UserToCheckAs("daemon");
  if (current.uid == 0) {
    EXPECT_EQ(other->name, "daemon");
  } else if (current.name != "daemon") {
    EXPECT_TRUE(absl::IsInvalidArgument(other.status()));
  }
  EXPECT_TRUE(Become(current).ok());
  EXPECT_EQ(::geteuid(), current.uid);
}

}  // namespace
}  // namespace uplink::ctl
