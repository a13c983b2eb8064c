#include "server/identity/uav_ruri.h"

#include <gtest/gtest.h>

#include "server/config/config.h"

namespace uplink::identity {
namespace {

TEST(UavRuri, PutsTheIdInItsPlace) {
  EXPECT_EQ(UavRuri("rcan://a/{uav_id}/b", "7"), "rcan://a/7/b");
  const std::string standard = config::UncrewConfig().ruri_template;
  EXPECT_EQ(FlawOfUavTemplate(standard), std::nullopt);
  EXPECT_EQ(UavRuri(standard, "uav-1"), "rcan://local.rcan/uncrew/uav/uav-1");
}

TEST(UavRuri, ATemplateIsARuriWithOnePlace) {
  EXPECT_EQ(FlawOfUavTemplate("rcan://a/b"), "names no {uav_id}");
  EXPECT_EQ(FlawOfUavTemplate("rcan://{uav_id}/{uav_id}"), "names {uav_id} twice");
  EXPECT_EQ(FlawOfUavTemplate("http://a/{uav_id}"), "does not begin rcan://");
  EXPECT_TRUE(FlawOfUavTemplate("rcan://a b/{uav_id}").has_value());
  EXPECT_EQ(FlawOfUavTemplate("rcan://{uav_id}"), std::nullopt);
}

}  // namespace
}  // namespace uplink::identity
