#include "server/mqtt/settings.h"

#include <string_view>

#include <fmt/core.h>

#include "schema/base/utf8.h"
#include "server/mqtt/limits.h"
#include "storage/deliveries.h"

namespace uplink::mqtt {
namespace {

static_assert(kUnackedMaxMax == storage::kUnackedMaxMax);

constexpr std::size_t kShownBytesMax = 128;
constexpr std::chrono::seconds kKeepaliveMax{65'535};
/// The largest number means that a session never ends, which no one asks for by accident.
constexpr std::chrono::seconds kSessionExpiryMax{0xFFFF'FFFE};

absl::Status Invalid(std::string_view key, std::string_view text) {
  return absl::InvalidArgumentError(fmt::format("mqtt.{} {}", key, text));
}

absl::Status CheckText(std::string_view key, const std::string& text, std::size_t bytes_max) {
  if (text.size() > bytes_max) {
    return Invalid(key, fmt::format("has {} bytes, at most {}", text.size(), bytes_max));
  }
  const auto controls = CountControls(text);
  const bool one_line = text.find_first_of("\t\r\n") == std::string::npos;
  if (!one_line || !controls || *controls > 0) return Invalid(key, "holds what is not text");
  return absl::OkStatus();
}

absl::Status CheckNames(const ClientSettings& settings) {
  if (settings.client_id.empty()) return Invalid("client_id", "is empty");
  if (absl::Status good = CheckText("client_id", settings.client_id, kClientIdBytesMax);
      !good.ok()) {
    return good;
  }
  if (absl::Status good = CheckText("username", settings.username, kUsernameBytesMax); !good.ok()) {
    return good;
  }
  if (settings.username.empty() && !settings.password_file.empty()) {
    return Invalid("password_file", "needs mqtt.username");
  }
  if (settings.certificate_file.empty() != settings.key_file.empty()) {
    return Invalid("client_certificate_file",
                   "and mqtt.client_key_file are set together or not at all");
  }
  const bool any_tls = !settings.ca_file.empty() || !settings.certificate_file.empty();
  if (any_tls && !settings.url.tls) {
    return Invalid("url", "is mqtt://, which has no TLS: take mqtts://, or no files of TLS");
  }
  return absl::OkStatus();
}

/// A `#` is the last level, and each wildcard a level by itself.
bool HasGoodWildcards(std::string_view topic) {
  while (true) {
    const std::size_t slash = topic.find('/');
    const std::string_view level = topic.substr(0, slash);
    const bool last = slash == std::string_view::npos;
    const bool wild = level.find_first_of("+#") != std::string_view::npos;
    if (wild && level != "+" && (level != "#" || !last)) return false;
    if (last) return true;
    topic.remove_prefix(slash + 1);
  }
}

}  // namespace

Waits::Waits()
    : resolve(kResolveWait),
      connect(kConnectWait),
      tls(kTlsWait),
      answer(kAnswerWait),
      ping(kPingWait),
      write(kWriteWait),
      refused(kRefusedPause) {}

absl::Status CheckSettings(const ClientSettings& settings) {
  if (settings.url.host.empty() || settings.url.port == 0) {
    return Invalid("url", "names no host and port");
  }
  if (absl::Status good = CheckNames(settings); !good.ok()) return good;
  if (settings.keepalive < kKeepaliveMin || settings.keepalive > kKeepaliveMax) {
    return Invalid("keepalive", fmt::format("is {} s, from {} to {}", settings.keepalive.count(),
                                            kKeepaliveMin.count(), kKeepaliveMax.count()));
  }
  if (settings.kept_session && (settings.session_expiry < std::chrono::seconds(1) ||
                                settings.session_expiry > kSessionExpiryMax)) {
    return Invalid("session_expiry",
                   fmt::format("is {} s, from 1 to {}", settings.session_expiry.count(),
                               kSessionExpiryMax.count()));
  }
  if (settings.unacked_max < 1 || settings.unacked_max > kUnackedMaxMax) {
    return Invalid("unacked_max",
                   fmt::format("is {}, from 1 to {}", settings.unacked_max, kUnackedMaxMax));
  }
  if (settings.payload_bytes_max > kRemainingLengthMax) {
    return absl::InvalidArgumentError("payload_bytes_max is more than MQTT can send");
  }
  return absl::OkStatus();
}

absl::Status CheckFilters(const std::vector<Filter>& filters) {
  if (filters.size() > kFiltersMax) {
    return absl::InvalidArgumentError(
        fmt::format("{} topic filters, at most {}", filters.size(), kFiltersMax));
  }
  for (const Filter& filter : filters) {
    const std::string& topic = filter.topic;
    const char* problem = topic.empty()                    ? "is empty"
                          : topic.size() > kFilterBytesMax ? "has over 1024 bytes"
                          : !IsCleanUtf8(topic)            ? "is not UTF-8"
                          : !HasGoodWildcards(topic)       ? "has a wildcard where none can be"
                                                           : nullptr;
    if (problem == nullptr) continue;
    return absl::InvalidArgumentError(
        fmt::format("topic filter \"{}\" {}", PrintableUtf8(topic, kShownBytesMax), problem));
  }
  return absl::OkStatus();
}

}  // namespace uplink::mqtt
