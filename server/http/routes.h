#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "server/http/message.h"

namespace uplink::http {

struct RoutedRequest;
struct Sources;

/// Which thread answers: probes at once, on the thread `io`; what is in memory on a thread that
/// waits for the store a moment at most; what may wait for it on the thread that reads; our own
/// scrape on a thread for each listener; the robots' scrape on one thread for all.
enum class Lane : std::uint8_t { kIo, kMemory, kRead, kMetrics, kScrape };

/// What a caller needs to ask for a path. Closed; rights.cc says which roles have which.
enum class Right : std::uint8_t {
  /// Nothing: probes.
  kAnyone,
  /// Scrapes.
  kScrape,
  /// Data.
  kRead,
  /// How the server is set up.
  kOperate,
  /// What is decided about robots.
  kCommand,
  /// What is decided about certificates and the server, and who decided what.
  kAdminister,
};

/// What a path needs of its caller. A value.
struct Needs {
  Right right = Right::kRead;
  /// It speaks of the whole server, so a scope of all fleets, too.
  bool whole = false;
};

/// A path and what answers it. Immutable.
struct Route {
  /// As MatchPath takes it: `{}` stands for one segment.
  std::string_view pattern;
  /// The label of its requests in the metrics.
  std::string_view name;
  Lane lane;
  Needs needs;
  Response (*handler)(const Sources&, const RoutedRequest&);
  /// Of Lane::kMemory: whether this request is one of Lane::kRead; null: none is.
  bool (*reads_store)(const RoutedRequest&) = nullptr;
  /// Answers have an ETag, since clients ask again and again for what often has not changed.
  bool tagged = false;
  /// It changes something: it takes POST alone. The audit knows it by this word; empty: it takes
  /// GET and HEAD.
  std::string_view action{};
};

/// All paths: the only list of them.
[[nodiscard]] std::span<const Route> Routes();

/// What a request asked for, for counting: a place in Routes(), or the one after the last for
/// every other path. A value.
struct RouteId {
  std::size_t index = 0;
};
[[nodiscard]] RouteId OtherRoute();
/// The number of ids: one per route, and one for all other paths together.
[[nodiscard]] std::size_t RouteIds();
/// The route of an encoded path, and its decoded `{}` segment. A value.
struct FoundRoute {
  RouteId id = OtherRoute();
  std::string segment;
};
/// OtherRoute() for a path that is none of ours.
[[nodiscard]] FoundRoute FindRoute(std::string_view path);
/// Whether a path takes the method.
[[nodiscard]] bool Takes(const Route& route, Method method);
/// A probe or a scrape: it shows no data of the store, and is answered under any name.
[[nodiscard]] bool IsMonitoring(RouteId route);
/// Whether requests of this lane are scrapes.
[[nodiscard]] bool IsScrape(Lane lane);
/// The label of a route's requests in the metrics.
[[nodiscard]] std::string_view RouteName(RouteId route);

}  // namespace uplink::http
