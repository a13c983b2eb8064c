#include "server/uncrew/speaker.h"

#include <string>

#include <gtest/gtest.h>

#include "server/config/config.h"

namespace uplink::uncrew {
namespace {

using identity::Role;

const std::string& Template() {
  static const std::string standard = config::UncrewConfig().ruri_template;
  return standard;
}

std::string RuriOf(const identity::PeerIdentity& peer, std::string_view uav_id) {
  const auto claim = SpeakerOf(peer, uav_id, Template());
  return claim.ok() ? claim->robot.ruri
                    : std::string(absl::StatusCodeToString(claim.status().code()));
}

TEST(Speaker, ARobotsCertificateIsItsOwnDrones) {
  const identity::PeerIdentity own{
      .role = Role::kRobot, .fleet = "f", .ruri = "rcan://local.rcan/uncrew/uav/7"};
  EXPECT_EQ(RuriOf(own, ""), own.ruri);
  EXPECT_EQ(RuriOf(own, "7"), own.ruri);
  EXPECT_EQ(RuriOf(own, own.ruri), own.ruri);
  EXPECT_EQ(RuriOf(own, "8"), "PERMISSION_DENIED");
}

TEST(Speaker, ACertificateThatGoesByNoTemplateKeepsItsRuri) {
  const identity::PeerIdentity odd{.role = Role::kRobot, .fleet = "f", .ruri = "rcan://a/b/c/d7"};
  EXPECT_EQ(RuriOf(odd, ""), odd.ruri);
  EXPECT_EQ(RuriOf(odd, "d7"), odd.ruri);
  EXPECT_EQ(RuriOf(odd, "7"), "PERMISSION_DENIED");
}

TEST(Speaker, AGatewayNamesOneOfItsRobots) {
  const identity::PeerIdentity named{
      .role = Role::kGateway,
      .fleet = "f",
      .gateway = {.subject = "CN=g", .ruris = {"rcan://local.rcan/uncrew/uav/7"}}};
  EXPECT_EQ(RuriOf(named, "7"), "rcan://local.rcan/uncrew/uav/7");
  EXPECT_EQ(RuriOf(named, "8"), "PERMISSION_DENIED");
  EXPECT_EQ(RuriOf(named, ""), "PERMISSION_DENIED");
  const identity::PeerIdentity any{
      .role = Role::kGateway, .fleet = "f", .gateway = {.subject = "CN=g"}};
  EXPECT_EQ(RuriOf(any, "8"), "rcan://local.rcan/uncrew/uav/8");
  EXPECT_EQ(RuriOf(any, "rcan://a/b"), "rcan://a/b");
  EXPECT_EQ(RuriOf(any, "a b"), "PERMISSION_DENIED");
}

TEST(Speaker, ARefusalSaysWhichRuriTheIdCameTo) {
  const identity::PeerIdentity named{
      .role = Role::kGateway,
      .fleet = "f",
      .gateway = {.subject = "CN=g", .ruris = {"rcan://local.rcan/uncrew/uav/7"}}};
  EXPECT_EQ(SpeakerOf(named, "8", Template()).status().message(),
            "the certificate of gateway CN=g may not speak for metadata.uav_id 8: "
            "uncrew.ruri_template makes it rcan://local.rcan/uncrew/uav/8");
  const auto flawed = SpeakerOf(named, "a b", Template());
  EXPECT_NE(flawed.status().message().find("which is no RURI: "), std::string::npos)
      << flawed.status();
}

}  // namespace
}  // namespace uplink::uncrew
