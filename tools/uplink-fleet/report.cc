#include "tools/uplink-fleet/report.h"

#include <algorithm>

#include <fmt/core.h>
#include <google/protobuf/struct.pb.h>
#include <google/protobuf/util/json_util.h>

namespace uplink::synthetic {
namespace {

using google::protobuf::Struct;

void Put(Struct& object, const std::string& name, const std::string& text) {
  (*object.mutable_fields())[name].set_string_value(text);
}

void Put(Struct& object, const std::string& name, double number) {
  (*object.mutable_fields())[name].set_number_value(number);
}

void PutCount(Struct& object, const std::string& name, std::uint64_t count) {
  Put(object, name, static_cast<double>(count));
}

void PutBool(Struct& object, const std::string& name, bool value) {
  (*object.mutable_fields())[name].set_bool_value(value);
}

/// What differs, robot by robot.
std::string Differences(const Findings& findings) {
  if (findings.differences().empty()) return {};
  std::string text = "\nrobot | thing | expected | found\n";
  for (std::size_t i = 0; i < findings.differences().size() && i < kDifferencesShown; ++i) {
    const Difference& difference = findings.differences()[i];
    text += fmt::format("{} | {} | {} | {}\n", difference.ruri, TextOf(difference.thing).name,
                        difference.expected, difference.found);
  }
  const std::uint64_t all = findings.differences_in_all();
  if (all > kDifferencesShown) text += fmt::format("and {} more\n", all - kDifferencesShown);
  return text;
}

}  // namespace

bool AllOk(const std::vector<CheckRow>& rows) {
  return std::all_of(rows.begin(), rows.end(), [](const CheckRow& row) { return row.ok; });
}

std::string TextReport(const RunFigures& figures, const std::vector<CheckRow>& rows,
                       const Findings& findings) {
  std::string text = fmt::format(
      "\n{} robots, {:.0f} s, seed {}, run {}: {} messages sent ({} again), {} durable acked, "
      "{} rejects, {} breaks, {} drains{}\n",
      figures.robots, figures.seconds, figures.seed, figures.run, figures.sent, figures.resent,
      figures.acked_durable, figures.rejects, figures.breaks, figures.drains,
      figures.restarted ? ", server restarted: its counters are left out" : "");
  for (const auto& [name, count] : figures.ends) {
    text += fmt::format("streams ended {}: {}\n", name, count);
  }
  std::size_t widest = 0;
  for (const CheckRow& row : rows) {
    widest = std::max(widest, row.what.size());
  }
  text += fmt::format("\n{:<{}} | {:>10} | {:>21} | {:>10} |\n", "what", widest, "fleet", "server",
                      "store");
  text += fmt::format("{:-<{}}-+-{:-<10}-+-{:-<21}-+-{:-<10}-+---------\n", "", widest, "", "", "");
  for (const CheckRow& row : rows) {
    text += fmt::format("{:<{}} | {:>10} | {:>21} | {:>10} | {}\n", row.what, widest, row.fleet,
                        row.server, row.store, row.ok ? "ok" : "MISMATCH");
    if (!row.ok && !row.note.empty()) text += fmt::format("    {}\n", row.note);
  }
  text += Differences(findings);
  text += AllOk(rows) ? "\nverification: all agree\n" : "\nverification: MISMATCH\n";
  if (!AllOk(rows) && !figures.first_error.empty()) {
    text += fmt::format("first trouble: {}\n", figures.first_error);
  }
  return text;
}

std::string JsonReport(const RunFigures& figures, const std::vector<CheckRow>& rows,
                       const Findings& findings) {
  Struct root;
  PutBool(root, "ok", AllOk(rows));
  Struct& run = *(*root.mutable_fields())["run"].mutable_struct_value();
  Put(run, "id", figures.run);
  PutCount(run, "robots", figures.robots);
  PutCount(run, "seed", figures.seed);
  Put(run, "seconds", figures.seconds);
  PutCount(run, "sent", figures.sent);
  PutCount(run, "resent", figures.resent);
  PutCount(run, "ackedDurable", figures.acked_durable);
  PutCount(run, "rejects", figures.rejects);
  PutCount(run, "notices", figures.notices);
  PutCount(run, "welcomes", figures.welcomes);
  PutCount(run, "breaks", figures.breaks);
  PutCount(run, "drains", figures.drains);
  PutBool(run, "serverRestarted", figures.restarted);
  Put(run, "firstError", figures.first_error);
  Struct& ends = *(*run.mutable_fields())["ends"].mutable_struct_value();
  for (const auto& [name, count] : figures.ends) {
    PutCount(ends, name, count);
  }
  auto& checks = *(*root.mutable_fields())["checks"].mutable_list_value();
  for (const CheckRow& row : rows) {
    Struct& check = *checks.add_values()->mutable_struct_value();
    Put(check, "what", row.what);
    Put(check, "fleet", row.fleet);
    Put(check, "server", row.server);
    Put(check, "store", row.store);
    PutBool(check, "ok", row.ok);
    Put(check, "note", row.note);
  }
  auto& differences = *(*root.mutable_fields())["differences"].mutable_list_value();
  for (const Difference& each : findings.differences()) {
    Struct& difference = *differences.add_values()->mutable_struct_value();
    Put(difference, "ruri", each.ruri);
    Put(difference, "what", std::string(TextOf(each.thing).name));
    Put(difference, "expected", each.expected);
    Put(difference, "found", each.found);
  }
  std::string json;
  const auto status = google::protobuf::util::MessageToJsonString(root, &json);
  return status.ok() ? json + "\n" : "{\"ok\":false}\n";
}

}  // namespace uplink::synthetic
