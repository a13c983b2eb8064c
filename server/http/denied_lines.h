#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

#include "schema/base/clock.h"
#include "server/http/denied.h"
#include "server/http/source.h"
#include "server/limits/recent_keys.h"
#include "server/log/logger.h"

namespace uplink::http {

/// Lines about who was not served, bounded per source and cause and in all, so that a noisy source
/// does not hide another, nor a scraper without a token who guesses at its address. They hold no
/// token.
///
/// Limits: kLinesPerSource of a source and cause, and kLinesMax, in any kSpan; kSourcesMax sources
///         with a cause, past which the one that was denied least recently is forgotten.
/// Thread: thread-safe; no lock is held while a line is written.
class DeniedLines final {
 public:
  static constexpr std::uint32_t kLinesPerSource = 2;
  static constexpr std::uint32_t kLinesMax = 20;
  static constexpr std::chrono::seconds kSpan{10};
  static constexpr std::size_t kSourcesMax = 1'024;

  struct Line {
    Denied why = Denied::kNoProof;
    /// Of a request.
    std::string_view route{};
    /// Who asks, if it has shown that.
    std::string name{};
    std::string from{};
  };

  explicit DeniedLines(const log::Logger& logger) : logger_(logger) {}

  void Write(const Line& line, const Source& source, SteadyTime now);

 private:
  /// Lines of one span.
  struct Window {
    void Turn(SteadyTime now);

    SteadyTime start{};
    std::uint32_t lines = 0;
    std::uint64_t suppressed = 0;
  };

  const log::Logger& logger_;
  std::mutex mutex_;
  Window all_;
  limits::RecentKeys<std::pair<Source, Denied>, Window, kSourcesMax> sources_;
};

}  // namespace uplink::http
