#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include <boost/json.hpp>

#include "tools/uplink-fleet/drone/call.h"

namespace uplink::synthetic {

/// Where the server lists a row.
enum class DroneList : std::uint8_t { kMessages, kEvents, kFaults, kQuarantine };

/// A row that one call must leave. A value.
struct DroneRow {
  DroneList list = DroneList::kEvents;
  /// Tells it apart within its list.
  std::string key;
  /// All that it must say (the functions below); empty: that is not known.
  std::string content;
  /// False: it may be there, since nothing is known of what an earlier run left.
  bool sure = true;
};

/// A request to operators. A value.
struct SentRequest {
  /// All that its row must say, but for whether it is open.
  std::string content;
  /// By which call it was opened, and closed; 0: it is open.
  std::uint64_t opened = 0;
  std::uint64_t closed = 0;
};

/// Calls that are remembered of one drone; past it nothing is said that is stored.
inline constexpr std::size_t kDroneRowsMax = 50'000;

/// What a drone has said, and what the server must make of it by the rules of
/// docs/integrate/uncrew.md; a second reading of them, which shares nothing with the server's.
///
/// Thread: confined to one thread at a time.
class DroneAccount final {
 public:
  // The script notes what a call must become.
  void Row(std::uint64_t number, DroneRow row) { rows_.emplace(number, std::move(row)); }
  void Opened(std::uint64_t number, const std::string& id, std::string content) {
    requests_[id] = {.content = std::move(content), .opened = number, .closed = 0};
  }
  void Closed(std::uint64_t number, const std::string& id) { requests_.at(id).closed = number; }
  void Raised(const std::string& id, bool active) {
    if (active) {
      active_.insert(id);
    } else {
      active_.erase(id);
    }
  }
  /// `path` as compare/compare_drones makes it of the server's answer; a part that is known goes.
  void Live(const std::string& path, const boost::json::object& shown);
  void NoLongerLive(const std::string& path) { live_.erase(path); }

  // The connection notes what became of calls.
  void Sends(std::uint64_t number) { waiting_.insert(number); }
  /// An answer that counts: the `tries`th, at that time of the drone's clock. One that is not due
  /// is remembered.
  void Answered(const AvatarCall& call, const ::uncrew::v1::PublishResponse& answer,
                std::size_t tries, std::int64_t now_us);

  [[nodiscard]] const std::multimap<std::uint64_t, DroneRow>& rows() const { return rows_; }
  [[nodiscard]] const std::map<std::string, SentRequest>& requests() const { return requests_; }
  /// Alerts that are active.
  [[nodiscard]] const std::set<std::string>& active() const { return active_; }
  /// The last value of each live part, as CanonicalText.
  [[nodiscard]] const std::map<std::string, std::string>& live() const { return live_; }
  [[nodiscard]] bool Waits(std::uint64_t number) const { return waiting_.contains(number); }
  [[nodiscard]] std::size_t waiting() const { return waiting_.size(); }
  [[nodiscard]] std::uint64_t answered() const { return answered_; }
  [[nodiscard]] std::uint64_t undue_answers() const { return undue_answers_; }
  /// What was due and what came instead, in words; empty: nothing.
  [[nodiscard]] const std::string& first_due() const { return first_due_; }
  [[nodiscard]] const std::string& first_undue() const { return first_undue_; }
  [[nodiscard]] std::uint64_t wrongs() const;
  [[nodiscard]] std::int64_t longest_silence_us() const { return longest_silence_us_; }
  /// True if no more may be remembered.
  [[nodiscard]] bool Full() const { return rows_.size() + requests_.size() >= kDroneRowsMax; }

 private:
  std::multimap<std::uint64_t, DroneRow> rows_;
  std::map<std::string, SentRequest> requests_;
  std::set<std::string> active_;
  std::map<std::string, std::string> live_;
  /// Not answered yet.
  std::set<std::uint64_t> waiting_;
  std::uint64_t answered_ = 0;
  std::uint64_t undue_answers_ = 0;
  std::string first_due_;
  std::string first_undue_;
  std::int64_t last_answer_us_ = 0;
  std::int64_t longest_silence_us_ = 0;
};

/// What a row of quarantine must say.
[[nodiscard]] std::string QuarantineContent(std::string_view reason, std::string_view field,
                                            std::int64_t bytes, std::string_view source,
                                            std::string_view method);
/// What a fault's row must say.
struct FaultWords {
  std::string_view id;
  bool active = false;
  std::string_view source;
  std::string_view severity;
  std::string_view category;
  std::string_view description;
  std::int64_t sampled_ms = 0;
};
[[nodiscard]] std::string FaultContent(const FaultWords& words);
[[nodiscard]] std::string FaultKey(std::string_view id, bool active);
[[nodiscard]] std::string RequestContent(std::string_view kind, std::string_view text,
                                         std::int64_t requested_ms);

}  // namespace uplink::synthetic
