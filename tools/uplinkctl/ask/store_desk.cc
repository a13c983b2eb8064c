#include "tools/uplinkctl/ask/store_desk.h"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/core.h>
#include <google/protobuf/util/json_util.h>

#include "schema/base/rfc3339.h"
#include "server/admin/command_code.h"
#include "server/admin/commands.h"
#include "server/config/load.h"
#include "server/view/error_json.h"
#include "server/view/message_printer.h"
#include "server/view/timestamps.h"
#include "storage/reader.h"
#include "tools/uplinkctl/store_access.h"

namespace uplink::ctl {
namespace {

using admin::Commands;

constexpr admin::CommandCode kStoreFails{503, "UNAVAILABLE"};

/// Its lines are the server's matter.
class NoLines final : public log::LineSink {
 public:
  void Write(log::Level /*level*/, std::string_view /*line*/) override {}
};

/// What the store said of itself is shown too: it is the user's own.
link::HttpAnswer ErrorOf(const absl::Status& status) {
  const auto code = admin::CommandCodeOf(status).value_or(kStoreFails);
  const std::string message(status.message());
  return {static_cast<unsigned>(code.http), view::ErrorJson({code.name, message})};
}

template <typename Answer>
link::HttpAnswer AnswerOf(const absl::StatusOr<Answer>& answer) {
  if (!answer.ok()) return ErrorOf(answer.status());
  const absl::StatusOr<std::string> json = view::MessagePrinter().Print(*answer);
  if (!json.ok()) return ErrorOf(json.status());
  return {200, *json};
}

template <typename Question, typename Answer>
link::HttpAnswer Do(Commands& commands, const std::string& json,
                    absl::StatusOr<Answer> (Commands::*command)(const admin::Asker&,
                                                                const Question&)) {
  Question question;
  const auto read = google::protobuf::util::JsonStringToMessage(json, &question);
  if (!read.ok()) return ErrorOf(absl::InvalidArgumentError(std::string(read.message())));
  return AnswerOf((commands.*command)(ThisUser(), question));
}

/// The value of one parameter; empty if it is not there.
std::string ValueIn(const std::string& target, std::string_view name) {
  std::string_view query =
      std::string_view(target).substr(std::min(target.find('?'), target.size()));
  while (!query.empty()) {
    query.remove_prefix(1);
    const std::string_view item = query.substr(0, query.find('&'));
    query.remove_prefix(item.size());
    if (item.starts_with(name) && item.substr(name.size()).starts_with('=')) {
      return link::PercentDecoded(item.substr(name.size() + 1));
    }
  }
  return {};
}

/// Its size is ours; nothing for one that is no number.
std::int32_t PageSizeIn(const std::string& target) {
  const std::string text = ValueIn(target, "pageSize");
  std::int32_t size = 0;
  std::from_chars(text.data(), text.data() + text.size(), size);
  return size;
}

v1::ListAuditRequest AuditQuestion(const std::string& target) {
  v1::ListAuditRequest request;
  if (const auto from = FromRfc3339(ValueIn(target, "from"))) {
    *request.mutable_from() = view::ToTimestamp(*from);
  }
  if (const auto until = FromRfc3339(ValueIn(target, "to"))) {
    *request.mutable_to() = view::ToTimestamp(*until);
  }
  request.set_order_by(ValueIn(target, "orderBy"));
  request.set_page_size(PageSizeIn(target));
  request.set_page_token(ValueIn(target, "pageToken"));
  request.set_who(ValueIn(target, "who"));
  request.set_action(ValueIn(target, "action"));
  request.set_target(ValueIn(target, "target"));
  return request;
}

}  // namespace

struct StoreDesk::Parts {
  SystemClock clock;
  log::Logger logger{std::make_unique<NoLines>(), clock, log::Format::kText, log::Level::kError};
  std::unique_ptr<storage::AccessStore> store;
  std::unique_ptr<storage::Reader> reader;
  std::unique_ptr<admin::SharedStore> shared;
  admin::AuditTrail audit{logger};
  std::unique_ptr<Commands> commands;
};

StoreDesk::StoreDesk(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
StoreDesk::~StoreDesk() = default;

absl::StatusOr<std::unique_ptr<StoreDesk>> StoreDesk::Open(const std::string& config) {
  const config::LoadResult read = config::LoadConfig(config, config::ProcessEnvironment());
  if (!read.readable) {
    return absl::InvalidArgumentError(
        read.problems.empty() ? config + " cannot be read" : config::ToText(read.problems.front()));
  }
  auto parts = std::make_unique<Parts>();
  auto store =
      OpenAccess(read.readable->store.url, read.readable->store.password_file, parts->clock);
  if (!store.ok()) return store.status();
  parts->store = *std::move(store);
  auto reader =
      OpenReader(read.readable->store.url, read.readable->store.password_file, parts->clock);
  if (!reader.ok()) return reader.status();
  parts->reader = *std::move(reader);
  parts->shared = std::make_unique<admin::SharedStore>(*parts->store);
  parts->commands = std::make_unique<Commands>(Commands::Context{
      .clock = parts->clock,
      .store = *parts->shared,
      .audit = parts->audit,
      .rows_of_audit = [&rows = *parts->reader](const storage::AuditQuery& query) {
        return rows.Audit(query);
      }});
  return std::unique_ptr<StoreDesk>(new StoreDesk(std::move(parts)));
}

std::optional<link::HttpAnswer> StoreDesk::Answer(const std::string& target,
                                                  const std::string* json) {
  Commands& commands = *parts_->commands;
  const std::string path = target.substr(0, target.find('?'));
  std::optional<link::HttpAnswer> answer;
  if (json == nullptr) {
    if (path == "/api/v1/audit") return AnswerOf(commands.ListAudit(AuditQuestion(target)));
    if (path != "/api/v1/certificates/revocations") return std::nullopt;
    v1::ListRevocationsRequest request;
    request.set_page_size(PageSizeIn(target));
    request.set_page_token(ValueIn(target, "pageToken"));
    return AnswerOf(commands.ListRevocations(request));
  }
  if (path == "/api/v1/robot/block") answer = Do(commands, *json, &Commands::BlockRobot);
  if (path == "/api/v1/robot/unblock") answer = Do(commands, *json, &Commands::UnblockRobot);
  if (path == "/api/v1/robot/disconnect") answer = Do(commands, *json, &Commands::DisconnectRobot);
  if (path == "/api/v1/robot/note") answer = Do(commands, *json, &Commands::NoteRobot);
  if (path == "/api/v1/robot/add") answer = Do(commands, *json, &Commands::AddRobot);
  if (path == "/api/v1/faults/acknowledge") {
    answer = Do(commands, *json, &Commands::AcknowledgeFault);
  }
  if (path == "/api/v1/certificates/revoke") {
    answer = Do(commands, *json, &Commands::RevokeCertificate);
  }
  if (path == "/api/v1/certificates/unrevoke") {
    answer = Do(commands, *json, &Commands::UnrevokeCertificate);
  }
  // What was refused.
  parts_->audit.Flush(*parts_->shared);
  return answer;
}

}  // namespace uplink::ctl
