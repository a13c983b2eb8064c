#include "server/config/relations.h"

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include <fmt/core.h>

#include "metrics/rcan/series.h"
#include "schema/base/utf8.h"
#include "server/config/address.h"
#include "server/config/broker_relations.h"
#include "server/config/http_relations.h"
#include "server/config/tls_groups.h"
#include "server/config/units.h"
#include "server/identity/uav_ruri.h"
#include "storage/postgres/link/url.h"

namespace uplink::config {
namespace {

constexpr std::string_view kSqliteScheme = "sqlite://";
/// A series name begins rcan_<subsystem>_; a longer word would only bloat each line of a scrape.
constexpr std::size_t kSubsystemBytesMax = 32;
/// Longest part of a wrong name that a problem repeats.
constexpr std::size_t kShownBytesMax = 100;

class Breaches {
 public:
  void Add(std::string_view section, std::string_view key, std::string text) {
    list_.push_back({section, key, std::move(text)});
  }
  void Add(Breach breach) { list_.push_back(std::move(breach)); }
  [[nodiscard]] std::vector<Breach> Take() { return std::move(list_); }

 private:
  std::vector<Breach> list_;
};

void CheckListen(const ListenConfig& listen, Breaches& breaches) {
  const auto collides = [&breaches](std::string_view key, const ListenAddress& address,
                                    std::string_view other_key, const ListenAddress& other) {
    if (!Collide(address, other)) return;
    breaches.Add("listen", key,
                 fmt::format("{} is taken by listen.{}, {}; give one of them another port",
                             ToText(address), other_key, ToText(other)));
  };
  collides("fleet", listen.fleet, "relay", listen.relay);
  collides("http", listen.http, "relay", listen.relay);
  collides("http", listen.http, "fleet", listen.fleet);
  collides("metrics", listen.metrics, "relay", listen.relay);
  collides("metrics", listen.metrics, "http", listen.http);
  collides("metrics", listen.metrics, "fleet", listen.fleet);
}

void CheckTls(const TlsConfig& tls, Breaches& breaches) {
  constexpr std::string_view kWhy =
      "it is required, since the relay serves mutual TLS only; "
      "name a PEM file (uplinkctl pki makes them)";
  if (tls.certificate_file.empty()) {
    breaches.Add("tls", "certificate_file", std::string(kWhy));
  }
  if (tls.key_file.empty()) {
    breaches.Add("tls", "key_file", std::string(kWhy));
  }
  if (tls.client_ca_file.empty()) {
    breaches.Add("tls", "client_ca_file", std::string(kWhy));
  }
  if (auto flaw = FlawOfGroups(tls.groups)) breaches.Add("tls", "groups", *std::move(flaw));
}

void CheckStore(const StoreConfig& store, Breaches& breaches) {
  if (IsPostgres(store)) {
    const absl::Status parsed = storage::postgres::ParseUrl(store.url).status();
    if (parsed.ok()) return;
    std::string_view text(parsed.message().data(), parsed.message().size());
    // The key stands before the text already.
    if (text.starts_with("store.url")) text.remove_prefix(text.find(' ') + 1);
    const bool says_remedy = text.find("; ") != std::string_view::npos;
    breaches.Add(
        "store", "url",
        fmt::format("{}{}", text, says_remedy ? "" : "; write postgresql://USER@HOST/DATABASE"));
  } else if (SqlitePath(store).empty()) {
    breaches.Add("store", "url",
                 "it names no store; write sqlite:/// and the absolute path of a file, or "
                 "postgresql://HOST/DATABASE");
  }
}

void CheckLimits(const LimitsConfig& limits, Breaches& breaches) {
  if (limits.message_bytes_max > limits.payload_bytes_max) {
    breaches.Add(
        "limits", "message_bytes_max",
        fmt::format("{} is over limits.payload_bytes_max, {}; lower it or raise that",
                    BytesText(limits.message_bytes_max), BytesText(limits.payload_bytes_max)));
  }
  if (limits.payload_bytes_max > limits.frame_bytes_max) {
    breaches.Add(
        "limits", "payload_bytes_max",
        fmt::format("{} is over limits.frame_bytes_max, {}; lower it or raise that",
                    BytesText(limits.payload_bytes_max), BytesText(limits.frame_bytes_max)));
  }
}

void CheckJournal(const JournalConfig& journal, Breaches& breaches) {
  if (journal.batch_records_max > journal.records_max) {
    breaches.Add("journal", "batch_records_max",
                 fmt::format("{} is over journal.records_max, {}; lower it or raise that",
                             journal.batch_records_max, journal.records_max));
  }
}

void CheckRcan(const RcanConfig& rcan, Breaches& breaches) {
  const std::string& word = rcan.subsystem;
  const bool letters = std::all_of(word.begin(), word.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  });
  if (word.empty() || word.size() > kSubsystemBytesMax || !letters) {
    breaches.Add("rcan", "subsystem",
                 fmt::format("\"{}\" cannot stand in a series' name; write 1 to {} lower-case "
                             "letters, digits and underscores",
                             PrintableUtf8(word, kShownBytesMax), kSubsystemBytesMax));
    return;
  }
  std::set<std::string> names;
  for (const auto& spec : metrics::rcan::AllSeries()) {
    const std::string name = metrics::rcan::ShortName(spec, word);
    if (names.insert(name).second) continue;
    breaches.Add(
        "rcan", "subsystem",
        fmt::format("\"{}\" would name two series rcan_{}; take another word", word, name));
  }
  for (const std::string& field : rcan.fields) {
    const bool known = std::ranges::any_of(metrics::rcan::AllSeries(), [&](const auto& spec) {
      return metrics::rcan::ShortName(spec, word) == field;
    });
    if (known) continue;
    breaches.Add("rcan", "fields",
                 fmt::format("\"{}\" is no series; names stand without rcan_, such as "
                             "\"robot_battery_pct\" or \"{}_position_rad\"",
                             PrintableUtf8(field, kShownBytesMax), word));
  }
}

}  // namespace

const std::string& OperatorCaFile(const TlsConfig& tls) {
  return tls.operator_ca_file.empty() ? tls.client_ca_file : tls.operator_ca_file;
}

bool IsPostgres(const StoreConfig& store) { return storage::postgres::IsPostgresUrl(store.url); }

std::string SqlitePath(const StoreConfig& store) {
  const std::string_view url = store.url;
  if (!url.starts_with(kSqliteScheme)) {
    return {};
  }
  const std::string_view path = url.substr(kSqliteScheme.size());
  return path.size() > 1 && path.front() == '/' && path.back() != '/' ? std::string(path)
                                                                      : std::string();
}

std::vector<Breach> CheckRelations(const Config& config) {
  Breaches breaches;
  CheckListen(config.listen, breaches);
  CheckTls(config.tls, breaches);
  CheckStore(config.store, breaches);
  CheckJournal(config.journal, breaches);
  CheckLimits(config.limits, breaches);
  CheckRcan(config.rcan, breaches);
  for (Breach& breach : CheckHttp(config)) breaches.Add(std::move(breach));
  for (Breach& breach : CheckBroker(config)) breaches.Add(std::move(breach));
  if (const auto flaw = identity::FlawOfUavTemplate(config.uncrew.ruri_template)) {
    breaches.Add(
        "uncrew", "ruri_template",
        fmt::format("it {}; write one such as \"{}\"", *flaw, UncrewConfig().ruri_template));
  }
  return breaches.Take();
}

}  // namespace uplink::config
