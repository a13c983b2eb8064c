#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/bench/hostile/attack.h"
#include "tests/support/odd_certificates.h"
#include "tests/support/shown_chain.h"

namespace uplink::bench {
namespace {

namespace odd = testing::odd;
using testing::RawHttp2;
using testing::ShownChain;

constexpr std::size_t kConnections = 14;
constexpr std::size_t kExplicitCurves = 50;
constexpr milliseconds kLook{5};

/// Connections that show this behind a certificate without an authority; each that the server ends
/// is followed by another.
void Show(const AttackSite& site, const std::vector<std::string>& certificates) {
  const testing::TestAuthority stranger;
  RawHttp2::Options options = site.Nobody();
  options.identity = stranger.Issue(testing::RobotSpec(std::string(kAttackerRuri)));
  options.behind = std::make_shared<const ShownChain>(certificates);
  std::vector<std::unique_ptr<RawHttp2>> connections(kConnections);
  while (!site.Over()) {
    for (auto& connection : connections) {
      if (site.Over()) return;
      if (connection != nullptr && !connection->ReadUntilEnd(milliseconds(0))) continue;
      options.patience = site.Left();
      connection = std::make_unique<RawHttp2>(options);
    }
    static_cast<void>(connections.front()->ReadUntilEnd(kLook));
  }
}

}  // namespace

void ShowExplicitCurves(const AttackSite& site) {
  Show(site, {kExplicitCurves, odd::CertificateWith(odd::ExplicitCurveKey())});
}

void ShowDearCertificates(const AttackSite& site) { Show(site, odd::DearChain()); }

}  // namespace uplink::bench
