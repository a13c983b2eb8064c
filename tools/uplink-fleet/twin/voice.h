#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <boost/json.hpp>

#include "tools/uplink-fleet/robot/behaviour/seeded.h"
#include "tools/uplink-fleet/twin/account.h"
#include "tools/uplink-fleet/twin/ids.h"

namespace uplink::synthetic {

/// How surely a message is to come to the broker, as MQTT numbers it.
enum class Qos : std::uint8_t { k0 = 0, k1 = 1 };

/// One message as it leaves for the broker. A value.
struct Publication {
  /// Within its twin, from 1. Names what is published at QoS 1 when it is acked.
  std::uint64_t number = 0;
  std::string topic;
  std::string payload;
  Qos qos = Qos::k0;
  bool retain = false;
};

/// Which client of a twin speaks; a worker behind a bridge says none.
enum class Speaker : std::uint8_t { kDriver, kSimulation, kViewer, kNone };
[[nodiscard]] inline Side SideOf(Speaker speaker) {
  return speaker == Speaker::kSimulation ? Side::kSim : Side::kReal;
}

/// What a message says of itself: speaker, source and time; the time of kLateUs ago; all but the
/// time; nothing.
enum class Head : std::uint8_t { kWhole, kLate, kTimeless, kNone };

/// How far behind its time a late message is.
inline constexpr std::int64_t kLateUs = 5'000'000;

/// What a message says, in the form in which tables of messages have it (Voice::Begin). A value.
struct Words {
  Speaker speaker = Speaker::kDriver;
  /// Empty: none is said.
  std::string_view source = "edge";
  /// What follows `cyberwave/`.
  std::string_view topic;
  /// An object of JSON.
  std::string_view body = "{}";
  Head head = Head::kWhole;
};

/// What its driver says of a twin, or its simulation.
constexpr Words FromDriver(std::string_view topic, std::string_view body,
                           std::string_view source = "edge") {
  return {.source = source, .topic = topic, .body = body};
}
constexpr Words FromSimulation(std::string_view topic, std::string_view body,
                               std::string_view source = "sim") {
  return {.speaker = Speaker::kSimulation, .source = source, .topic = topic, .body = body};
}
constexpr Words FromViewer(std::string_view topic, std::string_view body,
                           std::string_view source = "tele") {
  return {.speaker = Speaker::kViewer, .source = source, .topic = topic, .body = body};
}
/// The same words with another head.
constexpr Words With(Head head, Words words) {
  words.head = head;
  return words;
}

/// A message in the making. A value.
struct Draft {
  std::uint64_t number = 0;
  std::int64_t time_us = 0;
  /// Of the words alone.
  boost::json::object fields;
  /// With the head.
  boost::json::object body;

  [[nodiscard]] std::int64_t time_ms() const { return time_us / 1000; }
};

/// How a twin's messages begin and are addressed: numbers, marks, times, sessions, topics.
///
/// Units:  times are Unix microseconds; no two drafts have the same.
/// Thread: confined to one thread.
class Voice final {
 public:
  explicit Voice(const TwinOptions& options);

  /// Time never goes back, whatever the clock does.
  void SetNow(std::int64_t now_us);
  [[nodiscard]] std::int64_t now_us() const { return now_us_; }
  [[nodiscard]] Seeded& chance() { return chance_; }

  /// A draft of these words. In a text, `{twin}`, `{computer}`, `{environment}` and `{run}` become
  /// the twin's ids and `{mark}` the message's mark; `1..9` becomes a number between, `1..9#` a
  /// whole one, `a|b` one of both.
  [[nodiscard]] Draft Begin(const Words& words);
  /// A draft that says nothing yet.
  [[nodiscard]] Draft BeginBare();
  [[nodiscard]] std::string MarkOf(const Draft& draft) const {
    return synthetic::MarkOf(options_, draft.number);
  }
  [[nodiscard]] Publication To(const Words& words, const Draft& draft, Qos qos) const;
  /// The topic of `cyberwave/PATH`, with the twin's ids in it.
  [[nodiscard]] std::string Topic(std::string_view path) const;
  /// `text` with the twin's ids in it.
  [[nodiscard]] std::string WithIds(std::string_view text) const;

  [[nodiscard]] const TwinIds& ids() const { return ids_; }
  [[nodiscard]] const TwinOptions& options() const { return options_; }

 private:
  const TwinOptions options_;
  const TwinIds ids_;
  Seeded chance_;
  std::uint64_t last_number_ = 0;
  std::int64_t now_us_ = 0;
};

/// What the parts of a twin's script speak with; all of it outlives them.
struct Speech {
  Voice& voice;
  TwinAccount& account;
};

/// Microseconds as messages say them: seconds, a double.
[[nodiscard]] inline double SecondsOf(std::int64_t us) { return static_cast<double>(us) / 1e6; }

/// One of the rows, each as often as its weight says. There is one at least.
template <typename Rows>
[[nodiscard]] const auto& Choose(Seeded& chance, const Rows& rows) {
  std::size_t sum = 0;
  for (const auto& row : rows) sum += row.weight;
  std::size_t left = chance.Below(sum);
  for (const auto& row : rows) {
    if (left < row.weight) return row;
    left -= row.weight;
  }
  return rows.front();
}

}  // namespace uplink::synthetic
