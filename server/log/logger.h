#pragma once

#include <atomic>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

#include "schema/base/clock.h"
#include "server/log/held_lines.h"

namespace uplink::log {

/// Error: a person should look. Warn: degraded, handled. Info: lifecycle. Debug: each connection,
/// stream and request. Never a line per message.
enum class Level : std::uint8_t { kDebug, kInfo, kWarn, kError };

/// How long the end of the process waits for a reader of the log.
inline constexpr milliseconds kFlushWait{1000};

/// What waits or is left out while a person reads other lines, whatever the level is meanwhile.
enum class Quiet : std::uint8_t {
  kNone,
  kInfo,      // events below warn are left out
  kWarnings,  // they are, and warnings wait for another Quiet, for an error, or until many wait
};

enum class Format : std::uint8_t {
  kText,  // 2025-11-21T00:00:00.000Z warn store_away path=/x error="disk full"
  kJson,  // one object a line, the same keys
};

/// One `key=value` of a line. Made in place by the caller; holds no reference. A value is cut at
/// kValueBytesMax; a line shows those of its bytes that are not text as hex.
class Field {
 public:
  static constexpr std::size_t kValueBytesMax = 1024;

  Field(std::string_view key, std::string_view text);
  Field(std::string_view key, const std::string& text) : Field(key, std::string_view(text)) {}
  Field(std::string_view key, const char* text) : Field(key, std::string_view(text)) {}
  template <typename T>
  requires std::is_arithmetic_v<T> Field(std::string_view key, T number)
      : Field(key, ToText(number), Bare{}) {}

  [[nodiscard]] const std::string& key() const { return key_; }
  /// The value as given: any bytes, at most kValueBytesMax of them.
  [[nodiscard]] const std::string& text() const { return text_; }
  /// A number or switch, which JSON shows without quotes.
  [[nodiscard]] bool bare() const { return bare_; }

 private:
  struct Bare {};
  Field(std::string_view key, std::string text, Bare /*tag*/)
      : key_(key), text_(std::move(text)), bare_(true) {}

  static std::string ToText(bool value) { return value ? "true" : "false"; }
  static std::string ToText(double value);
  template <typename T>
  static std::string ToText(T value) {
    return std::to_string(value);
  }

  std::string key_;
  std::string text_;
  bool bare_ = false;
};

using Fields = std::initializer_list<Field>;

/// How many finished lines wait to be written, and how many were dropped since the start. A value.
struct LineCounts {
  std::size_t waiting = 0;
  std::uint64_t dropped = 0;
};

/// Where finished lines go. An implementation is thread-safe and does not throw.
class LineSink {
 public:
  virtual ~LineSink() = default;
  /// `line` ends without a newline.
  virtual void Write(Level level, std::string_view line) = 0;
  /// Waits until all lines written so far have reached the reader, `wait` at most.
  virtual void Flush(milliseconds /*wait*/) {}
  [[nodiscard]] virtual LineCounts counts() const { return {}; }
};

/// Writes one line per event. Made once by the composition root and passed by reference. No
/// payloads, tokens or keys are ever logged.
///
/// Thread: thread-safe; writing a line waits for no reader. Events that an outsider can trigger go
/// through RateLimited, unless they are of level debug.
class Logger final {
 public:
  /// `clock` stamps the lines and outlives the logger.
  Logger(std::unique_ptr<LineSink> sink, const Clock& clock, Format format, Level level);
  Logger(const Logger&) = delete;
  Logger& operator=(const Logger&) = delete;

  /// `event` is snake_case: store_away.
  void Write(Level level, std::string_view event, std::span<const Field> fields) const;
  void Write(Level level, std::string_view event, Fields fields = {}) const {
    Write(level, event, std::span<const Field>(fields.begin(), fields.size()));
  }

  void Debug(std::string_view event, Fields fields = {}) const {
    Write(Level::kDebug, event, fields);
  }
  void Info(std::string_view event, Fields fields = {}) const {
    Write(Level::kInfo, event, fields);
  }
  void Warn(std::string_view event, Fields fields = {}) const {
    Write(Level::kWarn, event, fields);
  }
  void Error(std::string_view event, Fields fields = {}) const {
    Write(Level::kError, event, fields);
  }

  /// Writes a line as it is, whatever the level: for a person at a terminal.
  void WritePlain(std::string_view line) const { sink_->Write(Level::kInfo, line); }

  /// To be asked before a line of level debug, so that its fields cost nothing while that is off.
  [[nodiscard]] bool Enabled(Level level) const { return level >= level_.load(); }
  /// Lines below `level` are left out from now on.
  void SetLevel(Level level) { level_.store(level); }
  /// Writes the warnings that waited, unless they go on waiting. Called by one thread at a time.
  void SetQuiet(Quiet quiet);
  /// Before the process ends: waits until all lines are written, kFlushWait at most.
  void Flush() const { sink_->Flush(kFlushWait); }
  [[nodiscard]] LineCounts counts() const { return sink_->counts(); }
  [[nodiscard]] const Clock& clock() const { return clock_; }

 private:
  void WriteHeld() const;

  std::unique_ptr<LineSink> sink_;
  const Clock& clock_;
  Format format_;
  std::atomic<Level> level_;
  std::atomic<Quiet> quiet_{Quiet::kNone};
  mutable HeldLines held_;
};

}  // namespace uplink::log
