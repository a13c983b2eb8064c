#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <boost/json.hpp>

#include "tools/uplink-fleet/twin/account.h"
#include "tools/uplink-fleet/twin/ids.h"
#include "tools/uplink-fleet/twin/publication.h"

namespace uplink::synthetic {

/// Which client of a twin speaks; a worker behind a bridge says none.
enum class Speaker : std::uint8_t { kDriver, kSimulation, kViewer, kNone };

/// How far behind its time a late message is.
inline constexpr std::int64_t kLateUs = 5'000'000;

/// A message in the making. A value.
struct Draft {
  std::uint64_t number = 0;
  std::int64_t time_us = 0;
  boost::json::object body;

  [[nodiscard]] std::int64_t time_ms() const { return time_us / 1000; }
};

/// How a twin's messages begin and are addressed: numbers, marks, times, sessions, topics.
///
/// Units:  times are Unix microseconds; no two drafts have the same.
/// Thread: confined to one thread.
class Voice final {
 public:
  explicit Voice(const TwinOptions& options) : options_(options), ids_(IdsOf(options)) {}

  /// Time never goes back, whatever the clock does.
  void SetNow(std::int64_t now_us);
  [[nodiscard]] std::int64_t now_us() const { return now_us_; }

  /// A draft with session, source (if `source` is not empty) and time.
  [[nodiscard]] Draft Begin(Speaker speaker, std::string_view source);
  /// The same with a time of kLateUs ago.
  [[nodiscard]] Draft BeginLate(Speaker speaker, std::string_view source);
  /// A draft of which nothing is said yet.
  [[nodiscard]] Draft BeginBare();
  [[nodiscard]] std::string MarkOf(const Draft& draft) const {
    return synthetic::MarkOf(options_, draft.number);
  }

  /// `tail` is what follows the twin's id.
  [[nodiscard]] Publication ToTwin(const Draft& draft, std::string_view tail, Qos qos) const;
  [[nodiscard]] Publication ToJoints(const Draft& draft) const;
  /// `path` is what follows `cyberwave/`.
  [[nodiscard]] Publication To(const std::string& path, const Draft& draft, Qos qos) const;
  [[nodiscard]] std::string Topic(const std::string& path) const {
    return options_.prefix + "cyberwave/" + path;
  }

  [[nodiscard]] const TwinIds& ids() const { return ids_; }
  [[nodiscard]] const TwinOptions& options() const { return options_; }

 private:
  const TwinOptions options_;
  const TwinIds ids_;
  std::uint64_t last_number_ = 0;
  std::int64_t now_us_ = 0;
};

/// Microseconds as messages say them: seconds, a double.
[[nodiscard]] inline double SecondsOf(std::int64_t us) { return static_cast<double>(us) / 1e6; }

/// `fields` as the server shows a live value: with the source and the time that the draft says.
[[nodiscard]] boost::json::object AsShown(const Draft& draft, boost::json::object fields,
                                          std::string_view source);

}  // namespace uplink::synthetic
