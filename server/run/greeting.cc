#include "server/run/greeting.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "schema/base/utf8.h"
#include "server/config/address.h"
#include "server/config/broker_url.h"
#include "server/config/version.h"
#include "server/identity/expiry.h"
#include "server/identity/pem_file.h"
#include "server/identity/server_names.h"
#include "server/store/open.h"

namespace uplink::run {
namespace {

/// Bytes that are shown of a path or a name.
constexpr std::size_t kShownBytesMax = 256;
/// The same of one line of an error.
constexpr std::size_t kErrorBytesMax = log::Field::kValueBytesMax;

std::string Counted(std::int64_t count, std::string_view one) {
  return fmt::format("{} {}{}", count, one, count == 1 ? "" : "s");
}

std::string HostsText(const std::vector<std::string>& hosts) {
  if (hosts.empty()) return "names no host, so no robot accepts it";
  std::string text;
  const std::size_t shown = std::min(hosts.size(), kHostsShownMax);
  for (std::size_t i = 0; i < shown; ++i) {
    text += (text.empty() ? "" : ", ") + PrintableUtf8(hosts[i], kShownBytesMax);
  }
  if (shown < hosts.size()) text += fmt::format(" and {} more", hosts.size() - shown);
  return text;
}

std::string LeftText(SystemTime expiry, SystemTime now) {
  if (expiry >= identity::kNoExpiry) return "never expires";
  if (expiry <= now) return fmt::format("EXPIRED at {}", identity::ExpiryText(expiry));
  const auto days = std::chrono::duration_cast<std::chrono::days>(expiry - now).count();
  const auto hours = std::chrono::duration_cast<std::chrono::hours>(expiry - now).count();
  return fmt::format("{} left, until {}", days > 0 ? Counted(days, "day") : Counted(hours, "hour"),
                     identity::ExpiryText(expiry));
}

std::string HttpText(const config::Config& config, const config::ListenAddress& http) {
  if (config::IsUnix(http)) return config::ToText(http);
  return (config::SpeaksTls(config.http) ? "https://" : "http://") + config::ToText(http);
}

std::string NextCommand(const config::Config& config, const config::ListenAddress& http) {
  if (!config.http.tokens_file.empty()) return "uplinkctl tokens new --help";
  if (config::AsksForProof(config.http)) return "uplinkctl pki operator --help";
  if (!config::IsUnix(http)) return fmt::format("curl {}/api/v1/robots", HttpText(config, http));
  return fmt::format("curl --unix-socket {} http://localhost/api/v1/robots", http.path);
}

std::string RobotsText(const Ready& ready) {
  if (ready.robots_unread) return "its robots are not read yet";
  return fmt::format("{} known", Counted(static_cast<std::int64_t>(ready.robots), "robot"));
}

/// The certificate on disk, or why it cannot be read.
std::string CertificateOnDisk(const std::string& path, SystemTime now) {
  const auto pem = identity::ReadPem(path);
  if (!pem.ok()) return std::string(pem.status().message());
  auto hosts = identity::ServerNamesOf(*pem);
  if (!hosts.ok()) return std::string(hosts.status().message());
  const auto expiry = identity::ExpiryOf(*pem);
  if (!expiry.ok()) return std::string(expiry.status().message());
  return CertificateText({*std::move(hosts), *expiry}, now);
}

bool IsForPeople(const config::LogConfig& log, int descriptor) {
  // Who sets another level or format reads events.
  return log.format == config::LogFormat::kText && log.level == config::LogLevel::kInfo &&
         isatty(descriptor) == 1;
}

}  // namespace

std::string CertificateText(const ShownCertificate& certificate, SystemTime now) {
  return fmt::format("{}; {}", HostsText(certificate.hosts), LeftText(certificate.expiry, now));
}

std::vector<std::string> ReadyLines(const config::Config& config, const Ready& ready,
                                    const std::string& certificate) {
  std::vector<std::string> lines = {
      fmt::format("  store   {}, {}", PrintableUtf8(ready.store, kShownBytesMax),
                  RobotsText(ready)),
      fmt::format("  robots  {}, gRPC with mutual TLS", config::ToText(ready.relay))};
  if (config.uncrew.avatar) lines.emplace_back("  drones  at the same address, AvatarService");
  if (!config.mqtt.url.empty()) {
    const auto broker = config::ParseBrokerUrl(config.mqtt.url);
    lines.push_back(fmt::format("  broker  {}, MQTT", broker.ok() ? broker->Text() : "?"));
  }
  lines.push_back(
      fmt::format("  http    {}: API, metrics, health{}", HttpText(config, ready.http),
                  config::AsksForProof(config.http) ? ", to those who show who they are" : ""));
  if (config::IsSet(ready.fleet)) {
    lines.push_back(fmt::format("  fleet   {}: gRPC for operators who show who they are",
                                config::ToText(ready.fleet)));
  }
  if (config::IsSet(ready.metrics)) {
    const bool asks = config::AsksForProof(config.http) || !config.http.metrics_token_file.empty();
    lines.push_back(fmt::format("  metrics http://{}: probes and scrapes, {} authentication",
                                config::ToText(ready.metrics), asks ? "with" : "without"));
  }
  lines.push_back(fmt::format("  TLS     {}", certificate));
  lines.push_back(
      fmt::format("  next    {}   (Ctrl-C drains and stops)", NextCommand(config, ready.http)));
  return lines;
}

Greeting::Greeting(Context context)
    : context_(std::move(context)),
      active_(IsForPeople(context_.config.log, context_.descriptor)) {}

void Greeting::Begin() {
  if (!active_) return;
  context_.logger.SetQuiet(log::Quiet::kWarnings);
  context_.logger.WritePlain(
      fmt::format("uplinkd {} starts with {}, store {}", config::VersionText(),
                  PrintableUtf8(context_.config_file, kShownBytesMax),
                  PrintableUtf8(store::NameOf(context_.config.store), kShownBytesMax)));
}

void Greeting::TellReady(const Ready& ready) {
  if (!active_) return;
  const std::string certificate =
      CertificateOnDisk(context_.config.tls.certificate_file, context_.clock.System());
  for (const std::string& line : ReadyLines(context_.config, ready, certificate)) {
    context_.logger.WritePlain(line);
  }
  context_.logger.SetQuiet(log::Quiet::kInfo);
}

void Greeting::TellFailed(const absl::Status& why) {
  const std::string text(why.message());
  if (!active_) {
    context_.logger.Error("start_failed", {{"error", text}});
    return;
  }
  context_.logger.SetQuiet(log::Quiet::kInfo);
  context_.logger.WritePlain("uplinkd: " + PrintableUtf8(text, kErrorBytesMax));
}

void Greeting::TellStopped(int signal) {
  if (!active_) {
    context_.logger.Info("stopped_while_starting", {{"signal", signal}});
    return;
  }
  context_.logger.SetQuiet(log::Quiet::kInfo);
  context_.logger.WritePlain("uplinkd: stopped before it was ready");
}

void Greeting::End() {
  if (active_) context_.logger.SetQuiet(log::Quiet::kNone);
}

}  // namespace uplink::run
