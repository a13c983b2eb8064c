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

/// Lines about what peers do, so many per kind, per source and in all. Of the lines of all a part
/// is kept for sources that have had none yet, and of a source's for its robots that have had none:
/// a noisy peer hides nobody else, whatever it does and behind whichever address.
///
/// Limits: kLinesPerKind (of a source's robot), kLinesPerSource and kLinesMax in any kSpan;
///         kEntriesMax of these are told apart, past which the one that was written about least
///         recently is forgotten.
/// Thread: thread-safe; no lock is held while a line is written.
class SourceLines final {
 public:
  static constexpr std::uint32_t kLinesPerKind = 2;
  static constexpr std::uint32_t kLinesPerSource = 12;
  static constexpr std::uint32_t kLinesMax = 50;
  /// One in so many of a source's lines, and of all, is for those that have had one.
  static constexpr std::uint32_t kRepeatsPart = 2;
  static constexpr std::chrono::seconds kSpan{10};
  static constexpr std::size_t kEntriesMax = 2048;

  /// Null: no lines.
  explicit SourceLines(const log::Logger* logger) : logger_(logger) {}

  /// `kind` is a word of ours, which outlives this and is not empty: lines of different kinds do
  /// not hide each other.
  void Write(std::string_view event, std::string_view kind, const std::string& why,
             const Origin& origin, SteadyTime now);

 private:
  /// Lines of one span.
  struct Window {
    SteadyTime start{};
    std::uint32_t lines = 0;
    std::uint64_t suppressed = 0;
  };
  /// Whom and what a line is about: a source, who is behind it, a kind; or a word for all kinds.
  using Key = std::tuple<SourceAddress, std::string, std::string_view>;

  /// Takes a line of every window that it counts in, if it fits into all.
  [[nodiscard]] bool Take(Window& of_kind, const Origin& origin, SteadyTime now);
  /// The window of this, in the span of `now`.
  [[nodiscard]] Window& WindowOf(const Key& key, SteadyTime now);
  static void Turn(Window& window, SteadyTime now);

  const log::Logger* const logger_;
  std::mutex mutex_;
  Window all_;
  limits::RecentKeys<Key, Window, kEntriesMax> windows_;
};

}  // namespace uplink::front
