#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>

#include "schema/base/utf8.h"
#include "schema/model/rejection.h"
#include "tools/uplink-fleet/robot/forward_board.h"

namespace uplink::synthetic {

/// The first of many texts of one kind, for the report: the server may have worded it, so what
/// steers a terminal is escaped. Thread-safe.
class FirstText final {
 public:
  void Keep(const std::string& text) {
    const std::scoped_lock lock(mutex_);
    if (text_.empty()) text_ = PrintableUtf8(text, kBytesMax);
  }
  /// Empty: there was none.
  [[nodiscard]] std::string Read() const {
    const std::scoped_lock lock(mutex_);
    return text_;
  }

 private:
  static constexpr std::size_t kBytesMax = 4'096;

  mutable std::mutex mutex_;
  std::string text_;
};

/// What the robots are to do now; only ever moves forward.
enum class Stage : std::uint8_t {
  /// Live as the scenario says.
  kRun,
  /// Raise nothing new, keep moving, until every durable message is settled.
  kSettle,
  /// One last motion and status, settled too.
  kLast,
  /// Half-close and wait for OK.
  kClose,
};

/// gRPC's status codes, 0 to 16.
inline constexpr std::size_t kStatusCodes = 17;

/// What main and the robots' threads share. Thread-safe: counters are atomic and only grow.
struct Shared {
  std::atomic<Stage> stage{Stage::kRun};
  /// In kLast: which time the last messages are sent; more than once if the server was started anew
  /// before it could be looked at.
  std::atomic<std::size_t> last_round{0};
  /// Robots give up what they wait for.
  std::atomic<bool> abandon{false};

  std::atomic<std::int64_t> streams{0};
  std::atomic<std::uint64_t> welcomes{0};
  std::atomic<std::uint64_t> sent{0};
  /// Good durable messages that Acks covered; wrong ones count in `rejects` alone.
  std::atomic<std::uint64_t> acked_durable{0};
  /// Rejects that the robots were told, by reason; the last: of reasons that this program does not
  /// know.
  std::array<std::atomic<std::uint64_t>, model::kRejectReasons + 2> rejects{};
  /// Streams and connections that the scenario ended, in whatever way.
  std::atomic<std::uint64_t> breaks{0};
  /// Second connections that it opened beside the first.
  std::atomic<std::uint64_t> takeovers{0};
  /// Connections that were up, with their handshake done.
  std::atomic<std::uint64_t> connects{0};
  /// Ticks that this program could not keep up with: it was the limit, not the server.
  std::atomic<std::uint64_t> skipped_ticks{0};
  std::atomic<std::uint64_t> drains{0};
  /// Robots that remember, or have waiting, as much as they may: they only move since then.
  std::atomic<std::size_t> only_moving{0};
  /// Threads whose robots are all made and may connect.
  std::atomic<std::size_t> threads_ready{0};
  std::atomic<std::uint64_t> rules_broken{0};
  /// Ends of streams by status code.
  std::array<std::atomic<std::uint64_t>, kStatusCodes> ends{};
  /// Robots that have done what the stage asks for.
  std::atomic<std::size_t> settled_robots{0};
  /// Once for each round of kLast.
  std::atomic<std::size_t> last_robots{0};
  std::atomic<std::size_t> closed_robots{0};
  FirstText first_error;
  FirstText first_broken_rule;
  /// In kLast: what receivers hold.
  ForwardBoard forwards;

  void CountReject(int reason) {
    const auto index = reason > 0 ? static_cast<std::size_t>(reason) : rejects.size() - 1;
    rejects[std::min(index, rejects.size() - 1)].fetch_add(1, std::memory_order_relaxed);
  }
  void CountEnd(int code) {
    const auto index = static_cast<std::size_t>(code);
    if (index < kStatusCodes) ends[index].fetch_add(1, std::memory_order_relaxed);
  }

  [[nodiscard]] std::uint64_t RejectsInAll() const {
    std::uint64_t sum = 0;
    for (const auto& count : rejects) sum += count.load(std::memory_order_relaxed);
    return sum;
  }

  void CountBrokenRule(const std::string& text) {
    rules_broken.fetch_add(1, std::memory_order_relaxed);
    first_broken_rule.Keep(text);
  }
};

}  // namespace uplink::synthetic
