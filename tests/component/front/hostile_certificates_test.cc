// Certificates that cost much to look into, shown by strangers and by robots of ours.
#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openssl/ssl.h>

#include "tests/component/front/hostile.h"
#include "tests/component/front/shared_lines.h"
#include "tests/support/odd_certificates.h"
#include "tests/support/shown_chain.h"

namespace uplink::testing {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using transport::TurnedAway;

class HostileCertificates : public Hostile, public ::testing::WithParamInterface<int> {
 protected:
  static constexpr std::size_t kConnections = 14;

  HostileCertificates() : Hostile(With12()) {}

  /// So many connections that show this behind a robot's certificate, one after the other without a
  /// wait for the server.
  void Show(const std::string& certificate, std::size_t count) {
    RawHttp2::Options options = Attacker();
    options.tls_max = GetParam();
    options.behind = std::make_shared<ShownChain>(std::vector<std::string>(count, certificate));
    std::vector<std::unique_ptr<RawHttp2>> clients;
    while (clients.size() < kConnections) clients.push_back(std::make_unique<RawHttp2>(options));
    for (const auto& client : clients) {
      EXPECT_TRUE(client->ReadUntilEnd());
      EXPECT_EQ(client->alert(), SSL_AD_DECODE_ERROR);
    }
  }
};

TEST_P(HostileCertificates, FiftyCurvesThatAreWrittenOutAreNotLookedInto) {
  Show(odd::CertificateWith(odd::ExplicitCurveKey()), 50);
  EXPECT_EQ(TurnedAwayFor(world_, TurnedAway::kCertificate), kConnections);
}

TEST_P(HostileCertificates, ALongRsaKeyIsNotLookedInto) {
  Show(odd::CertificateWith(odd::RsaKey(16'384, 16'384)), 1);
  EXPECT_EQ(TurnedAwayFor(world_, TurnedAway::kCertificate), kConnections);
}

INSTANTIATE_TEST_SUITE_P(Versions, HostileCertificates,
                         ::testing::Values(TLS1_2_VERSION, TLS1_3_VERSION));

TEST(CertificateNaming, SourceAndReasonAreInTheLog) {
  SharedLines::Lines lines;
  SystemClock clock;
  const log::Logger logger(std::make_unique<SharedLines>(lines), clock, log::Format::kText,
                           log::Level::kDebug);
  RelayWorld::Options of_world;
  of_world.logger = &logger;
  RelayWorld world(of_world);
  RawHttp2::Options options = ClientOf(world, RobotKeys(world, 1), "127.0.0.66");
  options.behind = std::make_shared<ShownChain>(
      std::vector<std::string>{odd::CertificateWith(odd::RsaKey(4097, 17))});
  RawHttp2 client(options);
  EXPECT_TRUE(client.ReadUntilEnd());
  EXPECT_TRUE(Eventually([&] { return TurnedAwayFor(world, TurnedAway::kCertificate) == 1; }));
  EXPECT_EQ(world.relay_probe.handshakes_failed_total.value(), 1);
  const auto told = [&] {
    const std::vector<std::string> all = lines.All();
    return std::ranges::any_of(all, [](const std::string& line) {
      return line.find("connection_turned_away") != std::string::npos;
    });
  };
  EXPECT_TRUE(Eventually(told));
  EXPECT_THAT(lines.All(),
              Contains(AllOf(HasSubstr("connection_turned_away source=127.0.0.66 "),
                             HasSubstr("certificate: an RSA key of over 4,096 bits"))));
}

}  // namespace
}  // namespace uplink::testing
