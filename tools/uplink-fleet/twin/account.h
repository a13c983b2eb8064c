#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <boost/json.hpp>

#include "schema/model/rejection.h"
#include "tools/uplink-fleet/twin/ids.h"

namespace uplink::synthetic {

/// How often what one publication makes may be there.
enum class Delivery : std::uint8_t {
  /// Acked by the broker: once.
  kOnce,
  /// Acked, but its connection broke before: the broker may have got it twice.
  kOnceOrMore,
  /// Acked, and on a topic that the server reads at QoS 0: once at most.
  kAtMostOnce,
  /// Not acked: anything.
  kUnknown,
};

enum class RowKind : std::uint8_t { kEvent, kMessage, kScope };

/// Rows, and what else must be found again, of one twin; past it only live messages are sent.
inline constexpr std::size_t kTwinRowsMax = 50'000;

/// A durable message and the row that it must become. A value.
struct SentRow {
  Side side = Side::kReal;
  RowKind kind = RowKind::kEvent;
  /// What people are shown of it.
  std::string type;
  /// Of everything that the row must say (robot/rows.h: HashOf).
  std::uint64_t content = 0;
};

/// A message that is wrong on purpose. A value.
struct SentWrong {
  model::RejectReason reason = model::RejectReason::kMalformed;
  std::string topic;
  std::size_t bytes = 0;
  /// Which quarantine it is in: the real robot's, or that of no robot.
  bool of_no_robot = false;
  /// Published on a topic that the server reads at QoS 1.
  bool sure = true;
};

/// What one mission run was reported as. A value.
struct SentRun {
  Side side = Side::kReal;
  std::vector<std::uint64_t> updates;
  /// As the contract spells it.
  std::string status;
  std::string message;
  std::optional<std::int64_t> progress_x100;
  std::optional<std::int64_t> current_step;
};

/// A fault's raise or clear: by which publication.
struct SentFaultChange {
  std::string fault_id;
  bool active = false;
};

/// What a session's marks come to. A value.
struct SentSession {
  Side side = Side::kReal;
  std::optional<bool> connected;
  std::optional<bool> telemetry;
};

/// The last value of each live part, as CanonicalText, by its path.
using SentParts = std::map<std::string, std::string>;

/// What a twin has published, and what the server must make of it by the rules of
/// docs/integrate/cyberwave.md; a second reading of them, which shares nothing with the server's.
///
/// Thread: confined to one thread at a time.
class TwinAccount final {
 public:
  // The script notes what a publication must become; each number is one publication.
  void Row(std::uint64_t number, SentRow row) { rows_[number] = std::move(row); }
  void Wrong(std::uint64_t number, SentWrong wrong) { wrongs_[number] = std::move(wrong); }
  void FaultChange(std::uint64_t number, SentFaultChange change) {
    fault_changes_[number].push_back(std::move(change));
  }
  SentRun& Run(const std::string& run_id) { return runs_[run_id]; }
  SentSession& Session(const std::string& session_id) { return sessions_[session_id]; }
  /// `path` as `compare/compare_twin_live` makes it of the server's answer.
  void Live(Side side, const std::string& path, const boost::json::value& value);
  /// A sign of life of that robot left at that time.
  void SignOfLife(Side side, std::int64_t now_us);

  // The connection notes what became of publications at QoS 1.
  void Published(std::uint64_t number) { waiting_.insert(number); }
  void Acked(std::uint64_t number);
  void Refused(std::uint64_t number);
  /// The connection broke: what waits is published again.
  void Broke() { unsure_.insert(waiting_.begin(), waiting_.end()); }

  [[nodiscard]] const std::map<std::uint64_t, SentRow>& rows() const { return rows_; }
  [[nodiscard]] const std::map<std::uint64_t, SentWrong>& wrongs() const { return wrongs_; }
  [[nodiscard]] const std::map<std::uint64_t, std::vector<SentFaultChange>>& fault_changes() const {
    return fault_changes_;
  }
  [[nodiscard]] const std::map<std::string, SentRun>& runs() const { return runs_; }
  [[nodiscard]] const std::map<std::string, SentSession>& sessions() const { return sessions_; }
  [[nodiscard]] const SentParts& live(Side side) const {
    return live_.at(static_cast<std::size_t>(side));
  }
  [[nodiscard]] std::int64_t longest_silence_us(Side side) const {
    return silences_.at(static_cast<std::size_t>(side)).longest_us;
  }
  [[nodiscard]] std::size_t waiting() const { return waiting_.size(); }
  [[nodiscard]] std::uint64_t acked() const { return acked_; }
  [[nodiscard]] std::uint64_t refused() const { return refused_.size(); }
  [[nodiscard]] Delivery DeliveryOf(std::uint64_t number) const;
  /// True if no more may be remembered.
  [[nodiscard]] bool Full() const {
    return rows_.size() + wrongs_.size() + fault_changes_.size() + runs_.size() >= kTwinRowsMax;
  }

 private:
  struct Silence {
    std::int64_t last_us = 0;
    std::int64_t longest_us = 0;
  };

  std::map<std::uint64_t, SentRow> rows_;
  std::map<std::uint64_t, SentWrong> wrongs_;
  std::map<std::uint64_t, std::vector<SentFaultChange>> fault_changes_;
  std::map<std::string, SentRun> runs_;
  std::map<std::string, SentSession> sessions_;
  std::array<SentParts, kSides> live_;
  std::array<Silence, kSides> silences_;
  /// At QoS 1: not acked yet; on their way when a connection broke.
  std::set<std::uint64_t> waiting_;
  std::set<std::uint64_t> unsure_;
  /// At QoS 1, and the broker did not take them.
  std::set<std::uint64_t> refused_;
  std::uint64_t acked_ = 0;
};

/// All that a row must say, as one text; the comparison makes it of what the server has.
[[nodiscard]] std::string EventContent(std::string_view kind, const boost::json::object& detail,
                                       std::int64_t sampled_ms);
[[nodiscard]] std::string MessageContent(std::string_view level, std::string_view message,
                                         const boost::json::object& detail,
                                         std::int64_t sampled_ms);
[[nodiscard]] std::string ScopeContent(std::string_view scope, std::string_view id,
                                       std::string_view type, const boost::json::object& detail,
                                       std::int64_t sampled_ms);

}  // namespace uplink::synthetic
