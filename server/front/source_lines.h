#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <tuple>

#include "schema/base/clock.h"
#include "server/front/origin.h"
#include "server/log/logger.h"

namespace uplink::front {

/// Lines about what peers do, so many per source, robot and kind, and so many in all: a noisy peer
/// hides nobody else.
///
/// Limits: kLinesPerSource and kLinesMax in any kSpan; kSourcesMax of them are told apart, past
///         which the one that was written about least recently is forgotten.
/// Thread: thread-safe; no lock is held while a line is written.
class SourceLines final {
 public:
  static constexpr std::uint32_t kLinesPerSource = 2;
  static constexpr std::uint32_t kLinesMax = 50;
  static constexpr std::chrono::seconds kSpan{10};
  static constexpr std::size_t kSourcesMax = 1024;

  /// Null: no lines.
  explicit SourceLines(const log::Logger* logger) : logger_(logger) {}

  /// `kind` is a word of ours, which outlives this: lines of different kinds do not hide each
  /// other.
  void Write(std::string_view event, std::string_view kind, const std::string& why,
             const Origin& origin, SteadyTime now);

 private:
  /// Lines of one span.
  struct Window {
    SteadyTime start{};
    std::uint32_t lines = 0;
    std::uint64_t suppressed = 0;
  };
  /// Whom and what a line is about: a source, a robot or gateway behind it, a kind.
  using Key = std::tuple<SourceAddress, std::string, std::string_view>;
  struct Entry {
    Key key;
    Window window;
  };

  /// Whether one more line fits; begins a new span where the last is over.
  [[nodiscard]] static bool Take(Window& window, std::uint32_t lines_max, SteadyTime now);
  [[nodiscard]] Window& WindowOf(const Key& key);

  const log::Logger* const logger_;
  std::mutex mutex_;
  Window all_;
  /// From the most recent to the least.
  std::list<Entry> entries_;
  std::map<Key, std::list<Entry>::iterator> by_key_;
};

}  // namespace uplink::front
