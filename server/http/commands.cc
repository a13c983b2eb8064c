// The handlers of /api/v1 that change what operators decide, or show it.
#include "server/admin/commands.h"

#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>

#include <absl/status/statusor.h>
#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <google/protobuf/util/json_util.h>

#include "server/admin/command_rate.h"
#include "server/http/denied.h"
#include "server/http/errors.h"
#include "server/http/handlers.h"
#include "server/http/header_text.h"
#include "server/http/parameters.h"
#include "server/http/probe.h"
#include "server/http/rows.h"
#include "server/view/json.h"
#include "server/view/timestamps.h"

namespace uplink::http {
namespace {

using admin::Commands;

/// `application/json; charset=utf-8` too.
bool IsJson(std::string_view content_type) {
  std::string_view type = content_type.substr(0, content_type.find(';'));
  while (type.ends_with(' ')) type.remove_suffix(1);
  return SameWord(type, kJson);
}

/// The body of a command, which may be empty. Errors: kInvalidArgument, as protobuf words it.
absl::Status ReadBody(const std::string& body, google::protobuf::Message& message) {
  if (body.empty()) return absl::OkStatus();
  const auto read = google::protobuf::util::JsonStringToMessage(body, &message);
  if (read.ok()) return absl::OkStatus();
  return absl::InvalidArgumentError(std::string(read.message()));
}

/// Takes the text fields `names` from the parameters where they are given, as well as from the
/// body.
void ReadNames(Parameters& parameters, std::initializer_list<std::string_view> names,
               google::protobuf::Message& message) {
  const google::protobuf::Reflection& fields = *message.GetReflection();
  for (const std::string_view name : names) {
    const std::string value = parameters.Text(name);
    if (value.empty()) continue;
    const auto* const field = message.GetDescriptor()->FindFieldByCamelcaseName(std::string(name));
    const std::string of_body = fields.GetString(message, field);
    if (!of_body.empty() && of_body != value) {
      parameters.Reject(name, "is another in the body");
    }
    fields.SetString(&message, field, value);
  }
}

template <typename Answer>
Response AnswerOf(const Sources& sources, const RoutedRequest& request,
                  const absl::StatusOr<Answer>& answer) {
  if (!answer.ok()) {
    if (admin::RetryAfterOf(answer.status())) {
      sources.probe.denied[static_cast<std::size_t>(Denied::kRate)].Add();
    }
    return CommandError(answer.status());
  }
  return JsonResponse(view::Encode(request.form, *answer, {}));
}

/// The answer of a command, whose request is the body; `names` may be parameters too.
template <typename Question, typename Answer>
Response Command(const Sources& sources, const RoutedRequest& request,
                 absl::StatusOr<Answer> (Commands::*command)(const admin::Asker&, const Question&),
                 std::initializer_list<std::string_view> names) {
  // Without a type any page may ask; with this one the browser asks us first. So a request without
  // a body needs it too.
  if (!IsJson(request.content_type)) return NotJson();
  Question question;
  if (const absl::Status read = ReadBody(request.body, question); !read.ok()) {
    return ErrorResponse(BadParameter{"body", std::string(read.message())});
  }
  Parameters parameters(request.query);
  ReadNames(parameters, names, question);
  if (const auto problem = parameters.Problem()) return ErrorResponse(*problem);
  return AnswerOf(
      sources, request,
      (sources.commands.*command)(admin::AskerOf(request.caller, request.from), question));
}

}  // namespace

Response PostBlock(const Sources& sources, const RoutedRequest& request) {
  return Command(sources, request, &Commands::BlockRobot, {"ruri", "reason"});
}

Response PostUnblock(const Sources& sources, const RoutedRequest& request) {
  return Command(sources, request, &Commands::UnblockRobot, {"ruri"});
}

Response PostDisconnect(const Sources& sources, const RoutedRequest& request) {
  return Command(sources, request, &Commands::DisconnectRobot, {"ruri"});
}

Response PostNote(const Sources& sources, const RoutedRequest& request) {
  return Command(sources, request, &Commands::NoteRobot, {"ruri"});
}

Response PostAdd(const Sources& sources, const RoutedRequest& request) {
  return Command(sources, request, &Commands::AddRobot, {"ruri"});
}

Response PostAcknowledge(const Sources& sources, const RoutedRequest& request) {
  return Command(sources, request, &Commands::AcknowledgeFault, {"ruri", "faultId"});
}

Response PostRevoke(const Sources& sources, const RoutedRequest& request) {
  return Command(sources, request, &Commands::RevokeCertificate, {});
}

Response PostUnrevoke(const Sources& sources, const RoutedRequest& request) {
  return Command(sources, request, &Commands::UnrevokeCertificate, {});
}

Response PostReload(const Sources& sources, const RoutedRequest& request) {
  return Command(sources, request, &Commands::Reload, {});
}

Response GetRevocations(const Sources& sources, const RoutedRequest& request) {
  Parameters parameters(request.query);
  v1::ListRevocationsRequest question;
  question.set_page_size(static_cast<std::int32_t>(ReadPageSize(parameters)));
  question.set_page_token(parameters.TextOrEmpty("pageToken"));
  if (const auto problem = parameters.Problem()) return ErrorResponse(*problem);
  return AnswerOf(sources, request, sources.commands.ListRevocations(question));
}

Response GetAudit(const Sources& sources, const RoutedRequest& request) {
  Parameters parameters(request.query);
  storage::HistoryQuery rows;
  ReadTimes(parameters, rows);
  ReadPage(parameters, rows);
  v1::ListAuditRequest question;
  if (rows.from) *question.mutable_from() = view::ToTimestamp(*rows.from);
  if (rows.to) *question.mutable_to() = view::ToTimestamp(*rows.to);
  if (rows.order == storage::ListOrder::kOldestFirst) question.set_order_by("oldest");
  question.set_page_size(static_cast<std::int32_t>(rows.page_size));
  question.set_page_token(rows.page_token);
  question.set_who(parameters.Text("who"));
  question.set_action(parameters.Text("action"));
  question.set_target(parameters.Text("target"));
  if (const auto problem = parameters.Problem()) return ErrorResponse(*problem);
  return AnswerOf(sources, request, sources.commands.ListAudit(question));
}

}  // namespace uplink::http
