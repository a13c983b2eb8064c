#include <memory>
#include <string>
#include <utility>

#include <fmt/core.h>

#include "tools/uplinkctl/ask/robot_names.h"
#include "tools/uplinkctl/verbs/records.h"

namespace uplink::ctl {
namespace {

namespace json = boost::json;

/// Reports of one run that are shown.
constexpr std::size_t kReportsMax = 10'000;

Columns ReportColumns() {
  return {{"TIME", "receivedAt", Kind::kTime},
          {"AGO", "receivedAt", Kind::kAge, Fit::kDrop},
          {"STATUS", "status", Kind::kWord},
          {"PROGRESS", "report.progressX100", Kind::kHundredths, Fit::kDrop},
          {"MESSAGE", "report.statusMessage", Kind::kText, Fit::kShrink},
          {"REPORT", "report", Kind::kText, Fit::kShrink}};
}

absl::Status Several(const std::string& run, const json::array& runs) {
  std::string robots;
  for (const json::value& each : runs) {
    if (!each.is_object()) continue;
    robots += (robots.empty() ? "" : ", ") + TextAt(each.get_object(), "ruri");
  }
  return absl::InvalidArgumentError(
      fmt::format("the run {} is of several robots; choose one by --robot: {}", run, robots));
}

}  // namespace

absl::StatusOr<std::string> MissionText(const std::string& run, const std::string& robot,
                                        Format format, Api& api, const Screen& screen) {
  Query query = {{"runId", run}};
  if (!robot.empty()) {
    absl::StatusOr<std::string> ruri = ResolveRobot(api, robot);
    if (!ruri.ok()) return ruri.status();
    query.emplace_back("ruri", *std::move(ruri));
  }
  absl::StatusOr<Rows> runs = api.List("/api/v1/missions", "missions", query, kCandidatesShown);
  if (!runs.ok()) return runs.status();
  if (runs->rows.empty()) {
    return absl::NotFoundError(fmt::format(
        "the store has no run {}; uplinkctl missions list --since 24h shows the latest", run));
  }
  if (runs->rows.size() > 1) return Several(run, runs->rows);
  json::object shown =
      runs->rows.front().is_object() ? runs->rows.front().get_object() : json::object();
  query.emplace_back("orderBy", "oldest");
  absl::StatusOr<Rows> reports =
      api.List("/api/v1/mission-reports", "missionReports", query, kReportsMax);
  if (!reports.ok()) return reports.status();
  if (format == Format::kCsv) return CsvOf(ReportColumns(), reports->rows, true);
  if (format == Format::kJson) {
    shown.emplace("missionReports", std::move(reports->rows));
    return DocumentText(shown, false);
  }
  // The reports below say it.
  shown.erase("latest");
  return FieldsOf(shown, screen.Terms()) + "\n" +
         TableOf(ReportColumns(), reports->rows, screen.Terms());
}

void AddMissionsShow(config::Flags& noun) {
  struct Request {
    CommonFlags common;
    std::string run;
    std::string robot;
  };
  const auto request = std::make_shared<Request>();
  const auto work = [request](Api& api, const Screen& screen) {
    return ShowAgain(screen, request->common.follow, [&] {
      return MissionText(request->run, request->robot, request->common.format(), api, screen);
    });
  };
  config::Flags& verb =
      noun.AddCommand("show", "Show one run, and every report of it",
                      [request, work] { return WithServer(request->common.server, work); });
  verb.Add({"RUN", "The id of the run, as missions list shows it", config::Flag::Need::kRequired},
           request->run);
  verb.Add({"--robot", "Of this robot, if several have such a run: its RURI, or the end of it"},
           request->robot);
  AddOutputFlags(verb, request->common, true);
  AddServerFlags(verb, request->common.server);
  verb.Example("uplinkctl missions show run-4711");
}

}  // namespace uplink::ctl
