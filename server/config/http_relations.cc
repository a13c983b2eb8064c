#include "server/config/http_relations.h"

#include <algorithm>
#include <cstddef>
#include <string>

#include <fmt/core.h>

#include "schema/base/utf8.h"
#include "server/config/address.h"

namespace uplink::config {
namespace {

/// Of a name in the DNS.
constexpr std::size_t kHostBytesMax = 253;
/// Longest part of a wrong text that a problem repeats.
constexpr std::size_t kShownBytesMax = 100;
constexpr mode_t kModeMax = 0777;

void CheckAddress(const Config& config, std::vector<Breach>& breaches) {
  const ListenAddress& address = config.listen.http;
  if (IsLoopback(address) || AsksForProof(config.http)) return;
  breaches.push_back(
      {"listen", "http",
       fmt::format("{} is not a loopback address, and nothing asks callers who they are; set "
                   "http.tls.certificate_file and http.tls.key_file with http.tokens_file or "
                   "tls.operator_ca_file; set http.tokens_file with http.plain_from if a proxy in "
                   "front speaks TLS; or listen on 127.0.0.1, on [::1] or on a Unix socket, such "
                   "as \"unix:/run/uplinkd/http.sock\"",
                   ToText(address))});
}

/// Without TLS somebody beyond this machine must be able to speak plain HTTP if others may connect.
void CheckPlain(const Config& config, std::vector<Breach>& breaches) {
  const ListenAddress& address = config.listen.http;
  const HttpConfig& http = config.http;
  if (SpeaksTls(http) || IsUnix(address)) return;
  // One problem is enough for an address without authentication.
  if (!IsLoopback(address) && !AsksForProof(http)) return;
  const bool here_alone = http.plain_from.empty() || http.plain_from == LoopbackNetworks();
  if (IsLoopback(address) || !here_alone) return;
  breaches.push_back(
      {"http", "plain_from",
       fmt::format("listen.http, {}, speaks no TLS, and this machine alone may speak plain HTTP; "
                   "set http.tls.certificate_file and http.tls.key_file, or name here the proxies "
                   "or networks that may do without TLS",
                   ToText(address))});
}

void CheckPair(const HttpConfig& http, std::vector<Breach>& breaches) {
  if (http.tls_certificate_file.empty() == http.tls_key_file.empty()) return;
  const bool key = http.tls_key_file.empty();
  breaches.push_back({"http", key ? "tls.key_file" : "tls.certificate_file",
                      fmt::format("it is required where http.tls.{} is set; set both or none",
                                  key ? "certificate_file" : "key_file")});
}

void CheckMode(const std::string& mode, std::vector<Breach>& breaches) {
  if (ParseSocketMode(mode)) return;
  breaches.push_back({"http", "socket_mode",
                      fmt::format("\"{}\" is no mode; write three or four octal digits up to "
                                  "\"0777\", such as \"{}\"",
                                  PrintableUtf8(mode, kShownBytesMax), HttpConfig().socket_mode)});
}

void CheckHosts(const std::vector<std::string>& hosts, std::vector<Breach>& breaches) {
  for (const std::string& host : hosts) {
    const bool name = std::ranges::all_of(host, [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
             c == '-' || c == '.' || c == '_';
    });
    if (name && !host.empty() && host.size() <= kHostBytesMax) continue;
    breaches.push_back({"http", "hosts",
                        fmt::format("\"{}\" is no host name; names stand without scheme and port, "
                                    "such as \"uplink.example.org\"",
                                    PrintableUtf8(host, kShownBytesMax))});
  }
}

}  // namespace

std::optional<mode_t> ParseSocketMode(std::string_view text) {
  constexpr std::size_t kDigitsMin = 3;
  constexpr std::size_t kDigitsMax = 4;
  if (text.size() < kDigitsMin || text.size() > kDigitsMax) return std::nullopt;
  mode_t mode = 0;
  for (const char c : text) {
    if (c < '0' || c > '7') return std::nullopt;
    mode = mode * 8 + static_cast<mode_t>(c - '0');
  }
  return mode <= kModeMax ? std::optional(mode) : std::nullopt;
}

bool SpeaksTls(const HttpConfig& http) { return !http.tls_certificate_file.empty(); }

std::vector<Network> PlainFrom(const HttpConfig& http) {
  std::vector<Network> networks = http.plain_from;
  if (SpeaksTls(http)) return networks;
  const std::vector<Network> loopback = LoopbackNetworks();
  networks.insert(networks.end(), loopback.begin(), loopback.end());
  return networks;
}

bool AsksForProof(const HttpConfig& http) { return SpeaksTls(http) || !http.tokens_file.empty(); }

std::vector<Breach> CheckHttp(const Config& config) {
  std::vector<Breach> breaches;
  CheckAddress(config, breaches);
  CheckPlain(config, breaches);
  CheckPair(config.http, breaches);
  CheckMode(config.http.socket_mode, breaches);
  CheckHosts(config.http.hosts, breaches);
  return breaches;
}

}  // namespace uplink::config
