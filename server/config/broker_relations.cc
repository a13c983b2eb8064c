#include "server/config/broker_relations.h"

#include <string>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "schema/base/utf8.h"
#include "schema/cyberwave/prefix.h"
#include "server/config/address.h"
#include "server/config/broker_url.h"
#include "server/identity/fleet_name.h"

namespace uplink::config {
namespace {

/// Longest part of a wrong text that a problem repeats.
constexpr std::size_t kShownBytesMax = 100;

/// Why a text cannot stand in a field of CONNECT, as the end of a sentence; empty if it can.
std::string FlawOfField(std::string_view text, std::size_t bytes_max) {
  if (text.size() > bytes_max) {
    return fmt::format("it has {} bytes; it must have at most {}", text.size(), bytes_max);
  }
  const bool one_line = text.find_first_of("\t\r\n") == std::string_view::npos;
  if (!one_line || CountControls(text) != std::size_t{0})
    return "it holds control characters; remove them";
  return {};
}

void CheckUrl(const MqttConfig& mqtt, std::vector<Breach>& breaches) {
  if (mqtt.url.empty()) return;
  const auto url = ParseBrokerUrl(mqtt.url);
  if (!url.ok()) {
    std::string_view text(url.status().message().data(), url.status().message().size());
    // The key stands before the text already.
    if (text.starts_with("mqtt.url")) text.remove_prefix(text.find(' ') + 1);
    const bool says_remedy = text.find(": ") != std::string_view::npos;
    breaches.push_back(
        {"mqtt", "url",
         fmt::format("it {}{}", text,
                     says_remedy ? "" : "; write mqtts://HOST or mqtts://HOST:PORT")});
    return;
  }
  const bool has_files = !mqtt.ca_file.empty() || !mqtt.client_certificate_file.empty() ||
                         !mqtt.client_key_file.empty();
  if (has_files && !url->tls) {
    breaches.push_back({"mqtt", "url",
                        "it is mqtt://, which has no TLS, and mqtt.ca_file or a client certificate "
                        "is set; write mqtts://, or let those be empty"});
  }
}

void CheckLogin(const MqttConfig& mqtt, std::vector<Breach>& breaches) {
  if (mqtt.client_id.empty()) {
    breaches.push_back(
        {"mqtt", "client_id",
         fmt::format("it is empty; it must be 1 to {} bytes", kMqttClientIdBytesMax)});
  }
  const std::string client_id = FlawOfField(mqtt.client_id, kMqttClientIdBytesMax);
  if (!client_id.empty()) breaches.push_back({"mqtt", "client_id", client_id});
  const std::string username = FlawOfField(mqtt.username, kMqttUsernameBytesMax);
  if (!username.empty()) breaches.push_back({"mqtt", "username", username});
  if (mqtt.username.empty() && !mqtt.password_file.empty()) {
    breaches.push_back({"mqtt", "password_file", "a password needs a user; set mqtt.username too"});
  }
  if (mqtt.client_certificate_file.empty() != mqtt.client_key_file.empty()) {
    const bool key = mqtt.client_key_file.empty();
    breaches.push_back({"mqtt", key ? "client_key_file" : "client_certificate_file",
                        fmt::format("it is required where mqtt.{} is set; set both or none",
                                    key ? "client_certificate_file" : "client_key_file")});
  }
}

void CheckPrefixes(const std::vector<std::string>& prefixes, std::vector<Breach>& breaches) {
  if (prefixes.empty() || prefixes.size() > kTopicPrefixesMax) {
    breaches.push_back({"cyberwave", "topic_prefixes",
                        fmt::format("it has {} prefixes; it must have 1 to {}, [\"\"] for none",
                                    prefixes.size(), kTopicPrefixesMax)});
  }
  for (const std::string& prefix : prefixes) {
    const std::string_view flaw = cyberwave::PrefixError(prefix);
    if (flaw.empty()) continue;
    breaches.push_back({"cyberwave", "topic_prefixes",
                        fmt::format("\"{}\": {}; write what stands before cyberwave/ in topics",
                                    PrintableUtf8(prefix, kShownBytesMax), flaw)});
  }
}

void CheckFleet(const std::string& fleet, std::vector<Breach>& breaches) {
  if (const auto flaw = identity::FlawOfNewFleet(fleet)) {
    breaches.push_back({"cyberwave", "fleet", fmt::format("it {}", *flaw)});
  } else if (fleet == identity::kAllFleets) {
    breaches.push_back({"cyberwave", "fleet", "it is *, which means all fleets; name one"});
  }
}

}  // namespace

std::vector<Breach> CheckBroker(const Config& config) {
  std::vector<Breach> breaches;
  CheckUrl(config.mqtt, breaches);
  CheckLogin(config.mqtt, breaches);
  CheckPrefixes(config.cyberwave.topic_prefixes, breaches);
  if (config.cyberwave.robots_max > config.limits.robots_max) {
    breaches.push_back({"cyberwave", "robots_max",
                        fmt::format("{} is over limits.robots_max, {}; lower it or raise that",
                                    config.cyberwave.robots_max, config.limits.robots_max)});
  }
  CheckFleet(config.cyberwave.fleet, breaches);
  return breaches;
}

std::optional<std::string> UnverifiedBrokerText(const MqttConfig& mqtt) {
  if (mqtt.url.empty()) return std::nullopt;
  const auto url = ParseBrokerUrl(mqtt.url);
  if (!url.ok() || url->tls || IsLoopbackHost(url->host)) return std::nullopt;
  return fmt::format(
      "it is mqtt://, which has no TLS: {} need not prove that it is the broker, and others on the "
      "network can read {} and what twins say; write mqtts://",
      PrintableUtf8(url->host, kBrokerHostBytesMax),
      mqtt.password_file.empty() ? "all topics" : "the password");
}

}  // namespace uplink::config
