#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/eventually.h"
#include "tests/support/mosquitto.h"
#include "tests/support/mqtt_publisher.h"
#include "tests/support/raw_http.h"
#include "tests/support/uplinkd_folder.h"

// A server that reads a broker, both real.
namespace uplink::testing {

/// A twin's id that a number tells apart.
[[nodiscard]] inline std::string TwinId(int number) {
  std::string digits = std::to_string(number);
  return std::string(8 - digits.size(), '0') + digits + "-2222-4333-8444-555555555555";
}
[[nodiscard]] inline std::string TwinTopic(int twin, const std::string& tail) {
  return "cyberwave/twin/" + TwinId(twin) + "/" + tail;
}
[[nodiscard]] inline std::string NumberedEvent(int number) {
  return R"({"event_type":"bench","number":)" + std::to_string(number) + "}";
}

/// One uplinkd, and what it says over HTTP. Confined to one thread.
class ReadingServer final {
 public:
  ReadingServer(const UplinkdFolder& folder, std::uint16_t broker,
                std::vector<std::string> environment = {}) {
    environment.push_back("UPLINKD_MQTT_URL=mqtt://127.0.0.1:" + std::to_string(broker));
    process_ = folder.Start({}, environment);
    const auto ports = WaitForPorts(*process_);
    if (ports) http_ = ports->http;
  }

  [[nodiscard]] ServerProcess& process() { return *process_; }
  [[nodiscard]] std::string Get(const std::string& target) const {
    return HttpGet(http_, target).body;
  }
  /// A sample of /metrics; -1 if there is none.
  [[nodiscard]] double Sample(const std::string& name) const {
    const std::string text = Get("/metrics");
    const std::size_t at = text.find("\n" + name + " ");
    return at == std::string::npos ? -1 : std::stod(text.substr(at + name.size() + 2));
  }
  [[nodiscard]] double Settled(const std::string& outcome) const {
    return Sample("uplinkd_mqtt_messages_settled_total{outcome=\"" + outcome + "\"}");
  }
  [[nodiscard]] bool Subscribed() const {
    return Eventually([this] {
      const std::string degraded = Get("/readyz");
      return degraded.find("degraded") != std::string::npos &&
             degraded.find("mqtt_away") == std::string::npos;
    });
  }
  [[nodiscard]] bool Degraded(const std::string& word) const {
    return Get("/readyz").find("\"" + word + "\"") != std::string::npos;
  }
  /// As /api/v1/robots has it.
  [[nodiscard]] std::string PresenceOf(int twin) const {
    const std::string robot =
        Get("/api/v1/robots/rcan%3A%2F%2Flocal.rcan%2Fcyberwave%2Ftwin%2F" + TwinId(twin));
    constexpr std::string_view kMember = R"("presence":")";
    const std::size_t at = robot.find(kMember);
    if (at == std::string::npos) return "";
    const std::size_t begin = at + kMember.size();
    return robot.substr(begin, robot.find('"', begin) - begin);
  }

 private:
  std::unique_ptr<ServerProcess> process_;
  std::uint16_t http_ = 0;
};

}  // namespace uplink::testing
