#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/raw_http.h"
#include "tests/support/test_agent.h"
#include "tests/support/uplinkd_folder.h"

namespace uplink::testing {

/// The value of a sample in the text of /metrics; -1 if it is not there.
[[nodiscard]] inline double SampleIn(const std::string& text, const std::string& name) {
  const std::size_t at = text.find("\n" + name + " ");
  return at == std::string::npos ? -1 : std::stod(text.substr(at + name.size() + 2));
}

/// The real program on a folder of its own, and what its robots and its operator ask it.
class UplinkdTest : public ::testing::Test {
 protected:
  void Serve(const std::vector<std::string>& environment = {}) {
    process_ = folder_.Start({}, environment);
    const auto ports = WaitForPorts(*process_);
    ASSERT_TRUE(ports) << process_->text();
    http_ = ports->http;
    relay_ = ports->relay;
  }
  [[nodiscard]] std::shared_ptr<grpc::Channel> Channel(const CertificateSpec& spec) const {
    return MakeChannel({.port = relay_,
                        .server_ca = folder_.authority().certificate(),
                        .identity = folder_.authority().Issue(spec)});
  }
  [[nodiscard]] double Sample(const std::string& name) const {
    return SampleIn(HttpGet(http_, "/metrics").body, name);
  }

  UplinkdFolder folder_;
  std::unique_ptr<ServerProcess> process_;
  std::uint16_t http_ = 0;
  std::uint16_t relay_ = 0;
};

}  // namespace uplink::testing
