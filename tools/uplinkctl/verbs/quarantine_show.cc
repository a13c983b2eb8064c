#include <memory>
#include <string>
#include <utility>

#include <absl/strings/escaping.h>
#include <fmt/core.h>

#include "tools/uplinkctl/ask/robot_names.h"
#include "tools/uplinkctl/show/json_text.h"
#include "tools/uplinkctl/verbs/payload_text.h"
#include "tools/uplinkctl/verbs/records.h"

namespace uplink::ctl {
namespace {

namespace json = boost::json;

struct Request {
  CommonFlags common;
  std::string robot;
  std::string seq;
  std::string at;
  std::string reason;
};

/// Rows among which the message is looked for: the server's own bound for a robot.
constexpr std::size_t kLookedThroughMax = 10'000;

bool Matches(const json::object& row, const Request& request) {
  const json::value* seq = MemberAt(row, "seq");
  return (request.seq.empty() || (seq != nullptr && ScalarText(*seq) == request.seq)) &&
         (request.at.empty() || TextAt(row, "receivedAt") == request.at);
}

/// The newest row that the request names.
absl::StatusOr<json::object> Find(const Request& request, Api& api) {
  Query query;
  if (!request.robot.empty()) {
    absl::StatusOr<std::string> ruri = ResolveRobot(api, request.robot);
    if (!ruri.ok()) return ruri.status();
    query.emplace_back("ruri", *std::move(ruri));
  }
  if (!request.reason.empty()) query.emplace_back("reason", request.reason);
  if (!request.at.empty()) {
    query.emplace_back("from", request.at);
    query.emplace_back("to", request.at);
  }
  const std::size_t limit = request.seq.empty() && request.at.empty() ? 1 : kLookedThroughMax;
  absl::StatusOr<Rows> rows = api.List("/api/v1/quarantine", "quarantined", query, limit);
  if (!rows.ok()) return rows.status();
  for (json::value& row : rows->rows) {
    if (row.is_object() && Matches(row.get_object(), request)) return std::move(row.get_object());
  }
  return absl::NotFoundError(
      "no rejected message is like that; uplinkctl quarantine list shows seq and time of each");
}

std::string Text(json::object row, const Screen& screen) {
  std::string payload;
  const bool is_base64 = absl::Base64Unescape(TextAt(row, "payload"), &payload);
  row.erase("payload");
  std::string text = FieldsOf(row, screen.Terms());
  if (!is_base64) return text + "\nthe payload is no base64\n";
  return text + "\n" + HexText(payload) + "\n" + DecodedText(TextAt(row, "source"), payload);
}

}  // namespace

void AddQuarantineShow(config::Flags& noun) {
  const auto request = std::make_shared<Request>();
  const auto work = [request](Api& api, const Screen& screen) -> absl::Status {
    absl::StatusOr<json::object> row = Find(*request, api);
    if (!row.ok()) return row.status();
    const Format format = request->common.format();
    screen.print(format == Format::kTable ? Text(*std::move(row), screen)
                                          : ObjectText(*row, format, screen));
    return absl::OkStatus();
  };
  config::Flags& verb =
      noun.AddCommand("show", "Show the newest rejected message that matches, in hex and decoded",
                      [request, work] { return WithServer(request->common.server, work); });
  verb.Add({"ROBOT", "The robot that sent it: its RURI, or the end of it"}, request->robot,
           NotEmpty());
  verb.Add({"--seq", "With this number"}, request->seq, NotEmpty());
  verb.Add({"--at", "That arrived at this time, as receivedAt of -o json has it"}, request->at,
           NotEmpty());
  verb.Add({"--reason", "That was rejected for this reason"}, request->reason, NotEmpty());
  AddOutputFlags(verb, request->common, false);
  AddServerFlags(verb, request->common.server);
  verb.Example("uplinkctl quarantine show r17 --seq 4711");
  verb.Example("uplinkctl quarantine show --reason decode_failed");
}

}  // namespace uplink::ctl
