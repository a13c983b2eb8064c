#include <algorithm>
#include <cstdlib>
#include <memory>
#include <string_view>
#include <vector>

#include <fmt/core.h>

#include "schema/base/rfc3339.h"
#include "tools/uplinkctl/show/ages.h"
#include "tools/uplinkctl/show/json_text.h"
#include "tools/uplinkctl/show/one_line.h"
#include "tools/uplinkctl/verbs/records.h"

namespace uplink::ctl {
namespace {

namespace json = boost::json;

/// `2 offline, 198 online`; counts of 0 are left out.
std::string CountsText(const json::value* counts, std::string_view without) {
  std::string text;
  const auto* object = counts == nullptr ? nullptr : counts->if_object();
  if (object == nullptr) return std::string(without);
  for (const auto& [name, value] : *object) {
    const std::string count = ScalarText(value);
    if (count.empty() || count == "0") continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", CountText(count),
                        std::string_view(name.data(), name.size()));
  }
  return text.empty() ? std::string(without) : text;
}

std::string UpText(const json::object& status, SystemTime now) {
  const auto started = FromRfc3339(TextAt(status, "startedAt"));
  const auto at = FromRfc3339(TextAt(status, "now"));
  return started ? LengthText(std::max(at.value_or(now) - *started, milliseconds(0))) : "unknown";
}

std::string ScalarAt(const json::object& object, std::string_view path) {
  const json::value* value = MemberAt(object, path);
  return value == nullptr ? std::string("0") : ScalarText(*value);
}

std::string JournalText(const json::object& status) {
  const std::string records = ScalarAt(status, "journalRecords");
  if (records == "0") return "empty";
  const double bytes = std::strtod(ScalarAt(status, "journalBytes").c_str(), nullptr);
  const long long oldest = std::strtoll(ScalarAt(status, "journalOldestMs").c_str(), nullptr, 10);
  return fmt::format("{} records, {}, the oldest waits for {}", CountText(records), SizeText(bytes),
                     LengthText(milliseconds(oldest)));
}

Cell DegradedCell(const json::object& status) {
  const json::value* words = MemberAt(status, "degraded");
  std::string text;
  if (words != nullptr && words->is_array()) {
    for (const json::value& word : words->get_array()) {
      text += (text.empty() ? "" : ", ") + ScalarText(word);
    }
  }
  return text.empty() ? Cell{"nothing", Tone::kGood} : Cell{OneLine(text), Tone::kBad};
}

std::string BrokerText(const json::object& status) {
  if (!status.contains("mqtt")) return {};
  std::string text = TextAt(status, "mqtt.url");
  const json::value* connections = MemberAt(status, "mqtt.connections");
  if (connections == nullptr || !connections->is_array()) return OneLine(text);
  for (const json::value& each : connections->get_array()) {
    if (!each.is_object()) continue;
    text += fmt::format(", {} {}", TextAt(each.get_object(), "name"),
                        TextAt(each.get_object(), "state"));
  }
  return OneLine(text);
}

}  // namespace

std::string StatusText(const json::object& status, const RowTerms& terms) {
  Table table({{"", Fit::kKeep}, {"", Fit::kKeep}});
  const auto add = [&table](const char* name, Cell cell) {
    if (!cell.text.empty()) table.Add({{name}, std::move(cell)});
  };
  add("version", {OneLine(TextAt(status, "version"))});
  add("up for", {UpText(status, terms.now)});
  add("does not work", DegradedCell(status));
  add("robots", {CountsText(MemberAt(status, "robots"), "none")});
  add("streams", {CountText(ScalarAt(status, "streams"))});
  add("messages", {CountsText(MemberAt(status, "messages.counts"), "none")});
  add("rejected", {CountsText(MemberAt(status, "messages.rejectsByReason"), "none")});
  add("journal", {JournalText(status)});
  add("broker", {BrokerText(status)});
  TableTerms without = terms.table;
  without.headings = false;
  // Counts wrap rather than end early.
  without.columns = 0;
  return table.Text(without);
}

void AddStatus(config::Flags& program) {
  const auto flags = std::make_shared<CommonFlags>();
  const auto work = [flags](Api& api, const Screen& screen) {
    return ShowAgain(screen, flags->follow, [&]() -> absl::StatusOr<std::string> {
      const absl::StatusOr<json::object> status = api.Get("/api/v1/status");
      if (!status.ok()) return status.status();
      if (flags->format() == Format::kTable) return StatusText(*status, screen.Terms());
      if (flags->format() == Format::kJson) return DocumentText(*status, flags->follow);
      return FieldsCsvOf(*status);
    });
  };
  config::Flags& noun =
      program.AddCommand("status", "Show a running server in figures, and what does not work",
                         [flags, work] { return WithServer(flags->server, work); });
  AddOutputFlags(noun, *flags, true);
  AddServerFlags(noun, flags->server);
  noun.Example("uplinkctl status");
  noun.Example("uplinkctl status --server http://192.0.2.7:7480 --follow");
}

}  // namespace uplink::ctl
