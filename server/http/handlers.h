#pragma once

#include <functional>
#include <string>
#include <variant>

#include "metrics/format.h"
#include "server/admin/commands.h"
#include "server/config/effective.h"
#include "server/health/monitor.h"
#include "server/http/listeners.h"
#include "server/http/message.h"
#include "server/http/probe.h"
#include "server/identity/caller.h"
#include "server/log/logger.h"
#include "server/rcan/scrape.h"
#include "server/view/form.h"
#include "server/view/queries.h"
#include "server/view/watches.h"

namespace uplink::http {

/// What the handlers answer from. The references outlive it; what it names is thread-safe, or used
/// on one lane alone.
struct Sources {
  view::Queries& queries;
  view::Watches& watches;
  admin::Commands& commands;
  health::Monitor& monitor;
  HttpProbe& probe;
  /// The text of our own scrape: every metric of the catalogue.
  std::function<std::string(metrics::Format)> metrics;
  /// On the lane of scrapes alone.
  rcan::RobotScrape& robots;
  /// Gets the details of a failure; clients get only its kind.
  const log::Logger& logger;
  const config::InEffect& in_effect;
};

/// A request whose path was found. A value.
struct RoutedRequest {
  /// The `{}` of the route's path, decoded.
  std::string segment;
  std::string query;
  metrics::Format format = metrics::Format::kText;
  metrics::Coding coding = metrics::Coding::kPlain;
  /// Of an answer that holds what was asked for. Errors are JSON; Response::code and why say the
  /// same.
  view::Form form = view::Form::kJson;
  /// Lists go as lines.
  bool lines = false;
  std::string if_none_match;
  ListenerId listener = ListenerId::kHttp;
  /// Answers show what is in its scope, as if there were nothing else.
  identity::Caller caller = identity::LocalCaller();
  /// Where it asks from.
  std::string from{};
  /// Of a command: its body, and the header Content-Type.
  std::string content_type{};
  std::string body{};
};

// The handlers of Routes(). Errors are answers too.

// monitoring.cc: what supervisors and Prometheus ask.
[[nodiscard]] Response GetLivez(const Sources& sources, const RoutedRequest& request);
[[nodiscard]] Response GetReadyz(const Sources& sources, const RoutedRequest& request);
[[nodiscard]] Response GetMetrics(const Sources& sources, const RoutedRequest& request);
[[nodiscard]] Response GetRobotMetrics(const Sources& sources, const RoutedRequest& request);

/// The two probes while the server starts: it lives, and is not ready. They take no parameters then
/// either.
[[nodiscard]] Response StartingLivez(const std::string& query);
[[nodiscard]] Response StartingReadyz(const std::string& query);

// api.cc: how the server does.
[[nodiscard]] Response GetStatus(const Sources& sources, const RoutedRequest& request);
[[nodiscard]] Response GetConfig(const Sources& sources, const RoutedRequest& request);
[[nodiscard]] Response GetOpenapi(const Sources& sources, const RoutedRequest& request);

// robots.cc: what is held in memory.
/// Whether the list wants parts that only the store has.
[[nodiscard]] bool RobotsReadStore(const RoutedRequest& request);
[[nodiscard]] Response GetRobots(const Sources& sources, const RoutedRequest& request);
/// Which robots a request watches, and for whom; or the answer for what is wrong with it.
[[nodiscard]] std::variant<view::WatchQuery, Response> WatchQueryOf(const RoutedRequest& request);
/// Robots as they change, until the client ends it.
[[nodiscard]] Response GetWatch(const Sources& sources, const RoutedRequest& request);
[[nodiscard]] Response GetFleets(const Sources& sources, const RoutedRequest& request);
[[nodiscard]] Response GetTop(const Sources& sources, const RoutedRequest& request);
[[nodiscard]] Response GetCandidates(const Sources& sources, const RoutedRequest& request);
/// By the path, or by the parameter `ruri`: proxies may decode a slash in a path.
[[nodiscard]] Response GetRobot(const Sources& sources, const RoutedRequest& request);

// lists.cc: rows of the store, over the whole fleet.
[[nodiscard]] Response GetEvents(const Sources& sources, const RoutedRequest& request);
[[nodiscard]] Response GetMessages(const Sources& sources, const RoutedRequest& request);
[[nodiscard]] Response GetPresence(const Sources& sources, const RoutedRequest& request);
/// What happened to one robot.
[[nodiscard]] Response GetStory(const Sources& sources, const RoutedRequest& request);
[[nodiscard]] Response GetConnections(const Sources& sources, const RoutedRequest& request);
[[nodiscard]] Response GetGaps(const Sources& sources, const RoutedRequest& request);
[[nodiscard]] Response GetQuarantine(const Sources& sources, const RoutedRequest& request);
[[nodiscard]] Response GetScopeUpdates(const Sources& sources, const RoutedRequest& request);
[[nodiscard]] Response GetFaults(const Sources& sources, const RoutedRequest& request);
[[nodiscard]] Response GetMissions(const Sources& sources, const RoutedRequest& request);
[[nodiscard]] Response GetMissionReports(const Sources& sources, const RoutedRequest& request);
[[nodiscard]] Response GetOperatorRequests(const Sources& sources, const RoutedRequest& request);
[[nodiscard]] Response GetShapes(const Sources& sources, const RoutedRequest& request);
[[nodiscard]] Response GetObjects(const Sources& sources, const RoutedRequest& request);

// commands.cc: what operators decide, and the audit of it.
[[nodiscard]] Response PostBlock(const Sources& sources, const RoutedRequest& request);
[[nodiscard]] Response PostUnblock(const Sources& sources, const RoutedRequest& request);
[[nodiscard]] Response PostDisconnect(const Sources& sources, const RoutedRequest& request);
[[nodiscard]] Response PostNote(const Sources& sources, const RoutedRequest& request);
[[nodiscard]] Response PostAdd(const Sources& sources, const RoutedRequest& request);
[[nodiscard]] Response PostAcknowledge(const Sources& sources, const RoutedRequest& request);
[[nodiscard]] Response PostRevoke(const Sources& sources, const RoutedRequest& request);
[[nodiscard]] Response PostUnrevoke(const Sources& sources, const RoutedRequest& request);
[[nodiscard]] Response PostReload(const Sources& sources, const RoutedRequest& request);
[[nodiscard]] Response GetRevocations(const Sources& sources, const RoutedRequest& request);
[[nodiscard]] Response GetAudit(const Sources& sources, const RoutedRequest& request);

}  // namespace uplink::http
