#pragma once

#include <chrono>
#include <cstddef>
#include <memory>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/config/address.h"
#include "server/http/entrance.h"
#include "server/http/probe.h"
#include "server/log/logger.h"
#include "server/loop/read_thread.h"

namespace boost::asio {
class io_context;
}  // namespace boost::asio

namespace uplink::http {

/// Bytes of a request's line and headers together, and of a body, which is read and not looked at.
inline constexpr std::size_t kHeaderBytesMax = 16UL * 1024;
inline constexpr std::size_t kBodyBytesMax = 16UL * 1024;
/// Of what a client sends ahead of its answers we hold so much; the rest waits in the kernel. One
/// request of a connection is under way at most.
inline constexpr std::size_t kSentAheadBytesMax = kHeaderBytesMax + kBodyBytesMax;
/// A request must be whole within this of its first byte; so must the peer take a whole answer.
inline constexpr std::chrono::seconds kRequestWait{30};
inline constexpr std::chrono::seconds kAnswerWait{30};
/// A connection is kept so long without a request. Answers tell it as Keep-Alive; proxies that keep
/// theirs for 60 s (nginx's upstream, AWS's load balancers) end them first.
inline constexpr std::chrono::seconds kIdleWait{75};
/// Connections that are accepted in one turn of the loop, and at most half of all places, so that
/// each is read before it could give way to the next ones.
inline constexpr std::size_t kAcceptsPerTurn = 16;
/// After a failed accept (no descriptors) the listener rests for so long.
inline constexpr std::chrono::milliseconds kAcceptPause{100};

/// The threads on which requests are answered (HttpServer::Context).
inline constexpr loop::ThreadKind kMemoryThread{"http-memory", 0};
inline constexpr loop::ThreadKind kReadThread{"http-read", 0};
inline constexpr loop::ThreadKind kMetricsThread{"http-metrics", 0};
/// Scrapes of robots give way to the robots.
inline constexpr loop::ThreadKind kScrapeThread{"http-scrape", 10};

/// The HTTP/1.1 listener: bounded connections (Places) with keep-alive on one event loop.
///
/// Thread: made and destroyed by the loop's owner while the loop does not run.
class HttpServer final {
 public:
  struct Options {
    config::ListenAddress address;
    /// Over kMonitoringPlaces.
    std::size_t connections_max = 0;
    milliseconds request_wait = kRequestWait;
    milliseconds idle_wait = kIdleWait;
  };
  struct Context {
    /// One thread runs it: the loop.
    boost::asio::io_context& io;
    const Entrance& entrance;
    /// What is in memory, and waits for the store a moment at most.
    loop::ReadThread& memory;
    loop::ReadThread& reads;
    /// Where our own scrapes are written. Takes one job per connection.
    loop::ReadThread& metrics;
    /// Where the robots' scrapes are written.
    loop::ReadThread& scrapes;
    HttpProbe& probe;
    const Clock& clock;
    /// At level debug each answer is a line.
    const log::Logger& logger;
  };

  /// Binds and listens; answers once the loop runs. What the context names must outlive the loop.
  ///
  /// Errors: kUnavailable naming the address, if it cannot be bound.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<HttpServer>> Listen(const Context& context,
                                                                          const Options& options);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  /// The address with the port that was really bound. Any thread.
  [[nodiscard]] const config::ListenAddress& bound() const { return bound_; }

 private:
  class Listener;
  explicit HttpServer(std::shared_ptr<Listener> listener);
  std::shared_ptr<Listener> listener_;
  const config::ListenAddress bound_;
};

}  // namespace uplink::http
