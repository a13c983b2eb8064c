#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>
#include <tuple>

#include "schema/base/clock.h"
#include "server/front/door/origin.h"
#include "server/limits/recent_keys.h"
#include "server/log/logger.h"

namespace uplink::front {

/// Lines about what peers do, bounded per kind, per source and in all. A part of all lines is kept
/// for sources that have had none yet, and a part of a source's lines for its robots that have had
/// none. So a noisy peer cannot hide another.
///
/// Limits: kLinesPerKind (of a source's robot), kLinesPerSource and kLinesMax in any kSpan;
///         kEntriesMax entries, past which the one that was written about least recently is
///         forgotten.
/// Thread: thread-safe; no lock is held while a line is written.
class SourceLines final {
 public:
  static constexpr std::uint32_t kLinesPerKind = 2;
  static constexpr std::uint32_t kLinesPerSource = 12;
  static constexpr std::uint32_t kLinesMax = 50;
  /// One in so many lines of a source, and of all, is for those that have had one already.
  static constexpr std::uint32_t kRepeatsPart = 2;
  static constexpr std::chrono::seconds kSpan{10};
  static constexpr std::size_t kEntriesMax = 2048;

  /// Null: no lines.
  explicit SourceLines(const log::Logger* logger) : logger_(logger) {}

  /// `kind` is a literal and not empty; lines of different kinds do not hide each other.
  void Write(std::string_view event, std::string_view kind, const std::string& why,
             const Origin& origin, SteadyTime now);

 private:
  /// Lines of one span.
  struct Window {
    SteadyTime start{};
    std::uint32_t lines = 0;
    std::uint64_t suppressed = 0;
  };
  /// What a line is about: a source, the robot behind it, a kind; or a word for all kinds.
  using Key = std::tuple<SourceAddress, std::string, std::string_view>;

  /// Takes a line from every window that it counts in, if it fits into all of them.
  [[nodiscard]] bool Take(Window& of_kind, const Origin& origin, SteadyTime now);
  /// The window of this key, in the span of `now`.
  [[nodiscard]] Window& WindowOf(const Key& key, SteadyTime now);
  static void Turn(Window& window, SteadyTime now);

  const log::Logger* const logger_;
  std::mutex mutex_;
  Window all_;
  limits::RecentKeys<Key, Window, kEntriesMax> windows_;
};

}  // namespace uplink::front
