#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "schema/model/rcan.h"
#include "schema/model/record.h"
#include "schema/model/rejection.h"
#include "storage/live_parts.h"
#include "tools/uplink-fleet/robot/agent_model.h"
#include "uplink/v1/fleet.pb.h"

namespace uplink::synthetic {

/// Messages that one robot remembers for the comparison at the end; at it the robot only moves.
inline constexpr std::size_t kRememberedMax = 400'000;

/// What is kept of a message until the end: enough to find its row, and to name it if it is not
/// there.
struct SentMessage {
  /// Of the row that it must become (rows.h); 0 for what makes no row of its own.
  std::uint64_t row_hash = 0;
  model::Seq seq = 0;
  model::Variant variant = model::Variant::kFault;
  bool acked = false;
  /// A later one of the same took its place before it was sent, or once it was rate-limited.
  bool gave_way = false;
};

/// A message that is wrong on purpose, and what the server must say of it.
struct WrongReport {
  model::RejectReason reason = model::RejectReason::kMalformed;
  std::string field;
  model::Seq seq = 0;
  bool acked = false;
  /// The Reject that came before the Ack.
  std::optional<model::Rejection> told;
};

/// What the reports of one mission run must have become.
struct RunExpectation {
  std::string name;
  std::uint64_t updates = 0;
  model::MissionRunStatus latest;
};

/// What is remembered of one message: itself, but of extras their readings, with the time that the
/// message or the reading bore.
template <typename Message>
struct SentOf {
  using Type = Message;
};
template <>
struct SentOf<model::TelemetryExtras> {
  using Type = model::SensorReading;
};

/// The last of a live message, or of each of its keys.
template <typename Message, std::size_t kKeysMax>
using LastSent = std::conditional_t<kKeysMax == 1, std::optional<Message>,
                                    std::map<std::string, typename SentOf<Message>::Type>>;

/// The last of each live message, by its key where it has one.
struct LastLive {
#define UPLINK_PART(Part, column, view, Message, keys_max)                                \
  /* NOLINTNEXTLINE(bugprone-macro-parentheses): "column" is the name that is declared */ \
  LastSent<model::Message, keys_max> column;
  UPLINK_LIVE_PARTS(UPLINK_PART)
#undef UPLINK_PART
};

/// Everything that one robot sent and learned: what the server and its store are held against.
///
/// Thread: written by the robot's thread, read when that has ended.
class Account final {
 public:
  /// A good durable message; gives its tag.
  std::uint64_t Enter(const model::Body& body);
  void EnterLive(const model::Body& body);
  void EnterRcan(model::RcanState state) { live_.rcan = std::move(state); }
  std::uint64_t EnterWrong(model::RejectReason reason, std::string field);
  /// An Ack covered the message of that tag; true if good_acked counts it.
  bool Settle(Settled settled);
  /// The message of that tag gave way to a later one, and is not sent any more.
  void GiveWay(std::uint64_t tag);

  /// The robot has sent as much as is remembered.
  [[nodiscard]] bool full() const { return sent_.size() >= kRememberedMax; }

  /// Good durable messages and wrong ones, by tag less one.
  [[nodiscard]] const std::vector<SentMessage>& sent() const { return sent_; }
  [[nodiscard]] const std::map<std::uint64_t, WrongReport>& wrongs() const { return wrongs_; }
  [[nodiscard]] std::uint64_t good() const { return sent_.size() - wrongs_.size() - gave_way_; }
  [[nodiscard]] std::uint64_t good_acked() const;
  /// Upserts that name an expiry: the server may call them superseded if they come too late.
  [[nodiscard]] std::uint64_t expiring() const { return expiring_; }

  // What must be seen at the end, were all of it stored.
  /// (fault id, source) to the row of its latest raise.
  [[nodiscard]] const std::map<std::pair<std::string, std::string>, v1::Fault>& active() const {
    return active_;
  }
  /// By (mission id, run id).
  [[nodiscard]] const std::map<std::pair<std::string, std::string>, RunExpectation>& runs() const {
    return runs_;
  }
  [[nodiscard]] const std::map<std::string, v1::Shape>& shapes() const { return shapes_; }
  [[nodiscard]] const std::map<std::string, v1::TrackedObject>& objects() const { return objects_; }
  [[nodiscard]] const std::optional<model::AgentInfo>& agent_info() const { return agent_info_; }
  [[nodiscard]] const std::optional<model::CurrentSettings>& settings() const { return settings_; }
  [[nodiscard]] const std::optional<model::UiCapabilities>& ui_capabilities() const {
    return ui_capabilities_;
  }
  [[nodiscard]] const LastLive& live() const { return live_; }

  /// Good messages that were answered with a Reject; none should be.
  [[nodiscard]] std::uint64_t good_rejected() const { return good_rejected_; }
  [[nodiscard]] const std::string& first_good_rejection() const { return first_good_rejection_; }

 private:
  [[nodiscard]] std::uint64_t Expect(const model::Body& body);

  std::vector<SentMessage> sent_;
  std::map<std::uint64_t, WrongReport> wrongs_;
  std::uint64_t expiring_ = 0;
  std::map<std::pair<std::string, std::string>, v1::Fault> active_;
  std::map<std::pair<std::string, std::string>, RunExpectation> runs_;
  std::map<std::string, v1::Shape> shapes_;
  std::map<std::string, v1::TrackedObject> objects_;
  std::optional<model::AgentInfo> agent_info_;
  std::optional<model::CurrentSettings> settings_;
  std::optional<model::UiCapabilities> ui_capabilities_;
  LastLive live_;
  std::uint64_t gave_way_ = 0;
  std::uint64_t good_rejected_ = 0;
  std::string first_good_rejection_;
};

/// One robot's part of the run, after it has ended.
struct RobotOutcome {
  std::string ruri;
  std::string session_hex;
  /// What its ids of this run begin with.
  std::string mark;
  Account account;
  std::uint64_t last_seq = 0;
  std::uint64_t sent = 0;
  std::uint64_t resent = 0;
  /// Its messages that the server has judged, stored or rejected and said so.
  std::uint64_t judged = 0;
  std::uint64_t notices = 0;
  /// Times that the robot itself was silent for longer than 3 s while it ran: the server may
  /// have called it offline then.
  std::uint64_t silences = 0;
  /// It takes what others share.
  bool receives = false;
  /// Commands that came outside snapshots, and snapshots that were whole.
  std::uint64_t forwarded_changes = 0;
  std::uint64_t forwarded_snapshots = 0;
  /// What the server may not forward, or not so; and the first of it in words.
  std::uint64_t forward_violations = 0;
  std::string first_forward_violation;
  bool all_settled = false;
  bool ended_ok = false;
  /// As it said with its Goodbye; 0: it said none.
  std::int64_t parked_until_ms = 0;
};

}  // namespace uplink::synthetic
