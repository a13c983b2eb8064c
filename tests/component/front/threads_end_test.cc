#include <filesystem>
#include <fstream>
#include <string>

#include "tests/component/front/front_threads.h"
#include "tests/support/temp_folder.h"

// The end of connections and of the listener while robots stream.
namespace uplink::testing {
namespace {

constexpr milliseconds kGrace{1'000};

class FrontThreadsAging : public FrontThreads {
 protected:
  static ListenerWorld::Options Options() {
    ListenerWorld::Options options = ManyThreads();
    options.connection_age_max = milliseconds(30);
    return options;
  }
  FrontThreadsAging() : FrontThreads(Options()) {}
};

TEST_F(FrontThreadsAging, RobotsComeBackOnNewConnections) {
  ForEachRobot([](RawRobot& robot) {
    for (int connections = 0; connections < kBatches; ++connections) {
      ASSERT_TRUE(Eventually([&robot] { return robot.Connect(); }));
      while (robot.StreamBatch()) {
      }
    }
  });
}

TEST_F(FrontThreads, ADrainUnderLoadSettlesEveryStream) {
  std::atomic<int> batches{0};
  std::jthread drainer([&] {
    EXPECT_TRUE(Eventually([&] { return batches > 2 * kRobots; }));
    world_.server().Drain(kGrace);
    EXPECT_TRUE(world_.server().WaitForStreams(kPatience));
  });
  ForEachRobot([&](RawRobot& robot) { StreamToTheEnd(robot, batches); });
}

TEST_F(FrontThreads, AShutdownUnderLoadEndsAtOnce) {
  std::atomic<int> batches{0};
  std::jthread stopper([&] {
    EXPECT_TRUE(Eventually([&] { return batches > 2 * kRobots; }));
    world_.server().Shutdown();
    EXPECT_EQ(world_.server().streams(), 0U);
  });
  std::jthread stranger([&] {
    while (RawHttp2(ClientOf(world_, {}, "127.0.0.66")).end() != RawTcp::End::kReset) {
    }
  });
  ForEachRobot([&](RawRobot& robot) { StreamToTheEnd(robot, batches); });
}

/// Replaces a file as an operator should: by its name.
void Replace(const std::string& path, const std::string& text) {
  std::ofstream(path + ".new") << text;
  std::filesystem::rename(path + ".new", path);
}

TEST_F(FrontThreads, CertificatesReloadWhileRobotsComeAndGo) {
  const TempFolder folder;
  const transport::PemFiles files{folder.File("crt"), folder.File("key"), folder.File("ca")};
  const auto write = [&](const KeyPair& keys) {
    Replace(files.certificate, keys.certificate);
    Replace(files.key, keys.key);
    Replace(files.client_ca, world_.authority.certificate());
  };
  write(world_.authority.Issue(ServerSpec()));
  auto other = world_.StartAnother({"127.0.0.1", 0}, files, kThreads);
  ASSERT_TRUE(other.ok()) << other.status();
  robots_.clear();
  for (int i = 0; i < kRobots; ++i) AddRobot(i, 2, (*other)->port());

  std::jthread reloader([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      write(world_.authority.Issue(ServerSpec()));
      EXPECT_TRUE((*other)->RefreshFiles().status.ok());
    }
  });
  ForEachRobot([](RawRobot& robot) {
    for (int round = 0; round < kRounds; ++round) {
      ASSERT_TRUE(robot.Connect());
      ASSERT_TRUE(robot.StreamBatch());
      ASSERT_TRUE(robot.HalfClose());
    }
  });
}

}  // namespace
}  // namespace uplink::testing
