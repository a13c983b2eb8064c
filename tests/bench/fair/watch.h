#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <set>
#include <string>
#include <thread>

#include "schema/base/clock.h"
#include "tests/bench/fair/misbehaviour.h"
#include "tools/link/http_client.h"

namespace uplink::bench {

/// What an operator saw of the server in one window. A value.
struct WatchFigures {
  std::uint64_t scrapes = 0;
  /// Requests that failed or took longer than the client waits.
  std::uint64_t failed = 0;
  std::string last_failure;
  double slowest_ms = 0;
  /// Scrapes that broke the conservation law, and the figures of the first.
  std::uint64_t law_broken = 0;
  std::string law_example;
  /// RURIs of well-behaved robots that were ever shown so.
  std::set<std::string> unknown;
  std::set<std::string> offline;
  /// The most that was seen.
  double held_back = 0;
  double journal_bytes = 0;
};

/// Looks at a server over HTTP twice per second, from a thread of its own with the lowest priority.
/// Every request has a deadline.
///
/// Thread: thread-safe.
class Watch final {
 public:
  enum class Window : std::uint8_t { kNone, kWithout, kWith };

  /// `bad_ruri`, and what begins so, is left out of what is counted; some misdeeds are looked at
  /// more closely.
  Watch(std::uint16_t http_port, std::string bad_ruri, const Misdeed& misdeed);
  /// Waits for the request that is under way.
  ~Watch() = default;
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  /// What is seen from now on belongs to this window.
  void Enter(Window window);
  [[nodiscard]] WatchFigures Of(Window window) const;

 private:
  void Run(const std::stop_token& stop);
  void Look(const std::stop_token& stop);
  void Scrape();
  void LookForPresence(const char* presence, std::set<std::string> WatchFigures::*seen);
  /// The body; empty if the request failed.
  [[nodiscard]] std::string Get(const std::string& target);
  [[nodiscard]] WatchFigures& Present();

  const std::string bad_ruri_;
  const Misdeed& misdeed_;
  const SystemClock clock_{};
  link::HttpClient client_;
  mutable std::mutex mutex_;
  Window window_ = Window::kNone;
  std::array<WatchFigures, 3> figures_;
  std::jthread thread_;
};

}  // namespace uplink::bench
