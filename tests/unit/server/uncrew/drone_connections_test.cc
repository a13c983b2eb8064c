// A connection by which drones call, as it is reported.
#include "server/uncrew/drone_connections.h"

#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/kept_connections.h"
#include "tests/support/manual_clock.h"

namespace uplink::uncrew {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using transport::EndCause;

class DroneConnectionsTest : public ::testing::Test {
 protected:
  DroneConnectionsTest() {
    connection_.SetUser(std::make_unique<DroneConnections>(DroneConnections::Context{
        .clock = clock_, .reports = kept_.reports(), .connection = connection_}));
  }
  [[nodiscard]] fleet::RobotPtr Drone(const std::string& ruri) {
    return std::make_shared<robot::Robot>(
        std::make_shared<const model::RobotId>(model::RobotId{.ruri = ruri, .fleet = "f"}),
        clock_.Steady(), clock_, untold_);
  }
  void Call(const fleet::RobotPtr& drone) {
    static_cast<DroneConnections&>(*connection_.user()).Count(drone, "", 100);
  }

  testing::ManualClock clock_;
  testing::KeptConnections kept_{clock_};
  const robot::PresenceChanged untold_;
  const std::string address_ = "192.0.2.1:4711";
  const identity::ShownCertificate certificate_{.serial = "0A"};
  transport::PeerConnection connection_{address_, certificate_};
  const fleet::RobotPtr drone_ = Drone("rcan://local.rcan/uncrew/uav/1");
};

TEST_F(DroneConnectionsTest, BeginsWithTheFirstCallAndEndsWithTheConnection) {
  EXPECT_THAT(kept_.begun(), IsEmpty());
  Call(drone_);
  Call(drone_);
  ASSERT_THAT(kept_.begun(), SizeIs(1));
  EXPECT_EQ(kept_.begun()[0].source, model::MessageSource::kUncrew);
  EXPECT_EQ(kept_.begun()[0].address, address_);
  EXPECT_EQ(kept_.begun()[0].certificate.serial, "0A");
  connection_.NoteEnd(EndCause::kClosed);
  connection_.End();
  ASSERT_THAT(kept_.Ends(), ElementsAre("orderly"));
  EXPECT_EQ(kept_.ended()[0].messages, 2U);
  EXPECT_EQ(kept_.ended()[0].bytes, 200U);
  EXPECT_EQ(drone_->state.last_end(), model::ConnectionEnd::kOrderly);
  connection_.End();
  EXPECT_THAT(kept_.ended(), SizeIs(1)) << "once";
}

TEST_F(DroneConnectionsTest, IsKeptAgainWithWhatItBroughtNowAndThen) {
  Call(drone_);
  EXPECT_THAT(kept_.updated(), IsEmpty());
  clock_.Advance(robot::kConnectionUpdateEvery);
  Call(drone_);
  Call(drone_);
  ASSERT_THAT(kept_.updated(), SizeIs(1));
  EXPECT_EQ(kept_.updated()[0].messages, 2U);
  EXPECT_EQ(kept_.updated()[0].id, kept_.begun()[0].id);
}

TEST_F(DroneConnectionsTest, EachDroneOfAGatewayHasItsOwn) {
  Call(drone_);
  Call(Drone("rcan://local.rcan/uncrew/uav/2"));
  connection_.End();
  EXPECT_THAT(kept_.Ends(), ElementsAre("broken", "broken")) << "nothing was noted: it was cut";
}

TEST_F(DroneConnectionsTest, SoManyDronesOfAConnectionAreReported) {
  for (std::size_t i = 0; i <= kDronesPerConnectionMax; ++i) {
    Call(Drone("rcan://local.rcan/uncrew/uav/" + std::to_string(i)));
  }
  EXPECT_THAT(kept_.begun(), SizeIs(kDronesPerConnectionMax));
}

}  // namespace
}  // namespace uplink::uncrew
