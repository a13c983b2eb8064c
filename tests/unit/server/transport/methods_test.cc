#include "server/transport/methods.h"

#include <string>

#include <gtest/gtest.h>

namespace uplink::transport {
namespace {

using identity::Role;

class MayCallTest : public ::testing::Test {
 protected:
  MayCallTest() {
    methods_.emplace("/a.A/Robots",
                     Method{.roles = {Role::kRobot, Role::kGateway}, .audience = "robots alone"});
    methods_.emplace("/a.A/Viewers", Method{.roles = {Role::kViewer}, .audience = "viewers alone"});
  }
  [[nodiscard]] std::string Ask(Role role, std::string_view path) const {
    return MayCall(identity::PeerIdentity{.role = role, .fleet = "f"}, methods_, path).ToString();
  }

  Methods methods_;
};

TEST_F(MayCallTest, TheRolesOfAMethodMay) {
  EXPECT_EQ(Ask(Role::kRobot, "/a.A/Robots"), "OK");
  EXPECT_EQ(Ask(Role::kGateway, "/a.A/Robots"), "OK");
  EXPECT_EQ(Ask(Role::kViewer, "/a.A/Viewers"), "OK");
}

TEST_F(MayCallTest, OthersMayNotAndAreToldWhy) {
  EXPECT_EQ(Ask(Role::kViewer, "/a.A/Robots"),
            "UNAUTHENTICATED: the certificate is of role viewer; robots alone");
  EXPECT_EQ(Ask(Role::kRobot, "/a.A/Viewers"),
            "UNAUTHENTICATED: the certificate is of role robot; viewers alone");
}

TEST_F(MayCallTest, WhetherThereIsAMethodIsToldToThoseWhoMayCallAny) {
  EXPECT_EQ(Ask(Role::kRobot, "/a.A/Nothing"), "OK");
  EXPECT_EQ(Ask(Role::kAdmin, "/a.A/Nothing"),
            "UNAUTHENTICATED: the certificate is of role admin; nothing here takes it");
}

TEST_F(MayCallTest, AnOpenMethodTakesThoseWithoutACertificateToo) {
  methods_.emplace("/a.A/Open", Method{.open = true});
  const absl::Status none = absl::UnauthenticatedError("client certificate: none was shown");
  EXPECT_TRUE(MayCall(none, methods_, "/a.A/Open").ok());
  EXPECT_TRUE(MayCall(none, methods_, "/a.A/Nothing").ok());
  EXPECT_EQ(MayCall(none, methods_, "/a.A/Viewers"), none);
  EXPECT_EQ(Ask(Role::kRobot, "/a.A/Open"), "OK");
}

TEST_F(MayCallTest, AFlawOfTheCertificateIsAllThatIsTold) {
  const absl::Status flaw = absl::UnauthenticatedError("client certificate: it has expired");
  for (const char* path : {"/a.A/Robots", "/a.A/Nothing", ""}) {
    EXPECT_EQ(MayCall(flaw, methods_, path), flaw) << path;
  }
}

}  // namespace
}  // namespace uplink::transport
