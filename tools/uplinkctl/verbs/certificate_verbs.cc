#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include <fmt/core.h>

#include "schema/base/rfc3339.h"
#include "server/config/units.h"
#include "tools/uplinkctl/ask/robot_names.h"
#include "tools/uplinkctl/verbs/command_verbs.h"
#include "tools/uplinkctl/verbs/common.h"
#include "tools/uplinkctl/verbs/list_text.h"
#include "tools/uplinkctl/verbs/lists.h"

namespace uplink::ctl {
namespace {

namespace json = boost::json;

/// Connections that are looked at: as many as robots of a server by default.
constexpr std::size_t kConnectionsMax = 20'000;

struct Request {
  CommonFlags common;
  std::string fleet;
  std::string expires_in;
  std::string serial;
  std::string issuer;
  std::string sha256;
  std::string key_sha256;
  std::string reason;
};
using Shared = std::shared_ptr<Request>;

/// Certificates of connections as a list shows them.
List CertificateList() {
  return {.noun = "certificates",
          .verb = "list",
          .about = "",
          .path = "/api/v1/connections",
          .member = "certificates",
          .columns = {{"ROBOT", "ruri", Kind::kRobot},
                      {"EXPIRES", "notAfter", Kind::kAge},
                      {"SERIAL", "serial", Kind::kText},
                      {"KEY SHA-256", "keySha256", Kind::kText},
                      {"GATEWAY", "gateway", Kind::kText, Fit::kDrop},
                      {"SHA-256", "sha256", Kind::kText, Fit::kDrop}},
          .examples = {}};
}

/// The certificates of the connections that expire by `until`, the first to expire first.
json::array CertificatesIn(const json::array& connections, std::optional<SystemTime> until) {
  json::array found;
  std::set<std::string> seen;
  for (const json::value& each : connections) {
    const auto* connection = each.if_object();
    const auto* certificate =
        connection == nullptr ? nullptr : MemberAt(*connection, "certificate");
    if (certificate == nullptr || !certificate->is_object()) continue;
    json::object row = certificate->get_object();
    const std::optional<SystemTime> expires = FromRfc3339(TextAt(row, "notAfter"));
    if (until && (!expires || *expires > *until)) continue;
    row["ruri"] = TextAt(*connection, "ruri");
    row["gateway"] = TextAt(*connection, "gateway");
    if (seen.insert(TextAt(row, "ruri") + ' ' + TextAt(row, "sha256")).second) {
      found.emplace_back(std::move(row));
    }
  }
  std::ranges::stable_sort(
      found, {}, [](const json::value& row) { return TextAt(row.get_object(), "notAfter"); });
  return found;
}

absl::Status ShowCertificates(const Request& request, Api& api, const Screen& screen) {
  std::optional<SystemTime> until;
  if (!request.expires_in.empty()) {
    const auto length = config::ParseDuration(request.expires_in);
    if (!length) {
      return absl::InvalidArgumentError(fmt::format(
          "--expires-in {}: it is no length of time; write 14d, 12h or 30m", request.expires_in));
    }
    until = screen.clock.System() + *length;
  }
  Query query{{"open", "true"}};
  if (!request.fleet.empty()) query.emplace_back("fleet", request.fleet);
  absl::StatusOr<Rows> rows =
      api.List("/api/v1/connections", "connections", query, kConnectionsMax);
  if (!rows.ok()) return rows.status();
  rows->rows = CertificatesIn(rows->rows, until);
  NoteRows(*rows, screen);
  RowTerms terms = screen.Terms();
  if (request.common.format() == Format::kTable) terms.robots = RobotsOf(api);
  screen.print(ListText(CertificateList(), request.common, *std::move(rows), terms));
  return absl::OkStatus();
}

void AddShow(config::Flags& noun) {
  const auto request = std::make_shared<Request>();
  const auto work = [request](Api& api, const Screen& screen) {
    return ShowCertificates(*request, api, screen);
  };
  config::Flags& verb = noun.AddCommand(
      "list", "List the certificates of robots that are connected, the first to expire first",
      [request, work] { return WithServer(request->common.server, work); });
  verb.Add({"--fleet", "Only this fleet's"}, request->fleet, NotEmpty());
  verb.Add({"--expires-in", "Only those that expire within this time: 14d"}, request->expires_in,
           NotEmpty());
  AddOutputFlags(verb, request->common, false);
  AddServerFlags(verb, request->common.server);
  verb.Example("uplinkctl certificates list --expires-in 14d");
}

void AddChange(config::Flags& noun, const char* name, const char* about, bool revokes,
               const char* example) {
  const auto request = std::make_shared<Request>();
  const std::string path = std::string("/api/v1/certificates/") + name;
  const auto work = [request, path, revokes](Api& api, const Screen& screen) -> absl::Status {
    json::object body;
    const auto add = [&body](const char* field, const std::string& value) {
      if (!value.empty()) body[field] = value;
    };
    add("serial", request->serial);
    add("issuer", request->issuer);
    add("sha256", request->sha256);
    add("keySha256", request->key_sha256);
    if (revokes) add("reason", request->reason);
    const absl::StatusOr<json::object> answer = api.Post(path, body);
    if (!answer.ok()) return answer.status();
    screen.print(ObjectText(*answer, request->common.format(), screen));
    return absl::OkStatus();
  };
  config::Flags& verb = noun.AddCommand(
      name, about, [request, work] { return WithServer(request->common.server, work); });
  verb.Add({"--key-sha256", "By its public key, so that no renewed certificate helps a thief"},
           request->key_sha256);
  verb.Add({"--sha256", "By the certificate itself"}, request->sha256);
  verb.Add({"--serial", "By its serial number, with --issuer"}, request->serial);
  verb.Add(
      {"--issuer",
       "Who signed it, as in openssl x509 -issuer -nameopt RFC2253: every authority of that name"},
      request->issuer);
  if (revokes) verb.Add({"--reason", "Why, for operators"}, request->reason);
  AddOutputFlags(verb, request->common, false);
  AddServerFlags(verb, request->common.server,
                 "Which server: by its configuration file. If none answers, this is done on its "
                 "store");
  verb.Example(example);
}

}  // namespace

void AddCertificateCommands(config::Flags& noun) {
  AddShow(noun);
  AddChange(noun, "revoke", "End the streams of a certificate or key, and refuse new ones", true,
            "uplinkctl certificates revoke --key-sha256 5f0c... --reason stolen");
  AddChange(noun, "unrevoke", "Take that back", false,
            "uplinkctl certificates unrevoke --key-sha256 5f0c...");
}

}  // namespace uplink::ctl
