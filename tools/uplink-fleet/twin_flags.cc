#include "tools/uplink-fleet/twin_flags.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>

#include <absl/status/status.h>
#include <fmt/core.h>

#include "server/config/broker_url.h"

namespace uplink::synthetic {
namespace {

constexpr double kTwinRateMin = 0.1;
constexpr double kTwinRateMax = 200;
/// A broker's topic is not longer than that with what follows a prefix.
constexpr std::size_t kPrefixBytesMax = 100;

/// From what the server says of its key mqtt.url, without the keys.
std::string WhyNoUrl(std::string_view server_says) {
  std::string_view why = server_says;
  why.remove_prefix(std::min(why.find(' '), why.size()));
  why = why.substr(0, why.find(": set mqtt."));
  return fmt::format("--cyberwave: the URL{}", why);
}

config::FlagForm IsFile() {
  return {"FILE", [](const std::string& text) {
            std::error_code error;
            const std::filesystem::file_status status = std::filesystem::status(text, error);
            if (!std::filesystem::exists(status)) return "File does not exist: " + text;
            return std::filesystem::is_directory(status) ? "File is actually a directory: " + text
                                                         : std::string();
          }};
}

}  // namespace

TwinFlags::TwinFlags(config::Flags& flags) {
  flags.Add({"--cyberwave",
             "Twins behind the MQTT broker at this URL, mqtt:// or mqtts://HOST[:PORT], in "
             "place of robots; of the other flags --http*, --robots, --for, --settle-for, "
             "--seed and --report count"},
            url_);
  flags.Add({"--mqtt-username", "The twins' user at the broker"}, options_.broker.username);
  flags.Add({"--mqtt-password-file", "File with that user's password"}, password_file_, IsFile());
  flags.Add({"--mqtt-ca", "PEM of who vouches for the broker"}, options_.broker.ca_file, IsFile());
  flags.Add({"--cyberwave-prefix", "What stands before cyberwave/ in topics"}, options_.prefix);
  flags.Add({"--twin-rate", "Messages per second and twin"}, options_.rate_hz,
            {kTwinRateMin, kTwinRateMax});
}

absl::StatusOr<std::optional<TwinSwarmOptions>> TwinFlags::Read(std::size_t twins) const {
  if (url_.empty()) return std::nullopt;
  absl::StatusOr<config::BrokerUrl> url = config::ParseBrokerUrl(url_);
  if (!url.ok()) return absl::InvalidArgumentError(WhyNoUrl(std::string(url.status().message())));
  if (url->tls && options_.broker.ca_file.empty()) {
    return absl::InvalidArgumentError("--cyberwave: mqtts:// needs --mqtt-ca");
  }
  TwinSwarmOptions options = options_;
  if (options.prefix.size() > kPrefixBytesMax ||
      options.prefix.find_first_of("+#") != std::string::npos) {
    return absl::InvalidArgumentError(
        fmt::format("--cyberwave-prefix: at most {} bytes without + and #", kPrefixBytesMax));
  }
  if (!password_file_.empty()) {
    std::ifstream file(password_file_);
    std::getline(file, options.broker.password);
    if (options.broker.password.empty()) {
      return absl::InvalidArgumentError("--mqtt-password-file: its first line is empty");
    }
  }
  options.broker.url = *std::move(url);
  options.twins = twins;
  return options;
}

}  // namespace uplink::synthetic
