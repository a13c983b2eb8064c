#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "schema/model/ids.h"
#include "tests/simulation/forward_table.h"
#include "tests/simulation/payloads.h"
#include "tests/simulation/random.h"
#include "tests/simulation/recorder.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::simulation {

/// One numbering of the modelled agent, as it would lie on the robot's disk.
struct AgentSession {
  model::SessionId id;
  model::Seq next = 1;
  model::Seq settled = 0;
  model::Seq judged = 0;
  /// Durable messages that no Ack has let go yet, in order.
  std::map<model::Seq, Content> kept;
  /// Every number that must end in the store or in quarantine.
  std::set<model::Seq> durable_sent;
  /// Numbers whose Reject arrived; of these, for the rate of their kind.
  std::set<model::Seq> told;
  std::set<model::Seq> limited;
};

/// An agent that follows the protocol to the letter, and checks what the server promises it.
class SimAgent final {
 public:
  /// A robot, and whether it wants to be told what others share.
  struct Self {
    model::RobotId id;
    bool declines_forwards = false;
  };
  SimAgent(Self self, const Payloads& payloads, Recorder& recorder,
           const Recorder::Violation& violation)
      : self_(std::move(self)),
        payloads_(payloads),
        recorder_(recorder),
        violation_(violation),
        table_({.fleet = self_.id.fleet, .ruri = self_.id.ruri}, recorder.shared(), violation) {}

  /// From now on everything that it sends anew is large and durable.
  void BeGreedy() { greedy_ = true; }
  /// The server may reject shapes and objects for their rate.
  void BeLimited() { may_be_limited_ = true; }
  /// Shapes and objects alone are sent anew, until the next call.
  void FloodWithItems(bool floods) { floods_ = floods; }
  /// The store has lost what it took last: what was acked of it is gone.
  void OnStoreWentBack();

  [[nodiscard]] const model::RobotId& id() const { return self_.id; }
  [[nodiscard]] const std::string& ruri() const { return self_.id.ruri; }
  [[nodiscard]] bool declines_forwards() const { return self_.declines_forwards; }
  /// What it holds of the others' shapes and objects.
  [[nodiscard]] const ForwardTable& table() const { return table_; }
  [[nodiscard]] const std::deque<AgentSession>& sessions() const { return sessions_; }
  /// Something is kept that only an Ack ends.
  [[nodiscard]] bool HasKept() const { return SessionsWithKept() > 0; }
  [[nodiscard]] std::size_t SessionsWithKept() const;

  /// A new numbering; older ones with kept messages are finished first at the next connects.
  void NewSession(Random& random);
  /// The first frame of a new stream.
  [[nodiscard]] v1::RelayRequest Connect(Random& random);
  void Disconnected() { session_ = nullptr; }

  /// Welcome has come, so batches may be sent.
  [[nodiscard]] bool Ready() const { return session_ != nullptr && welcomed_; }
  [[nodiscard]] bool HasResends() const { return !resend_.empty() || HasLimited(); }
  /// Something was rejected for its rate, and must be sent again.
  [[nodiscard]] bool HasLimited() const { return !limited_.empty(); }
  enum class Fresh : std::uint8_t { kNo, kYes };
  /// Up to `messages_max` messages: what is sent again first, then fresh ones.
  [[nodiscard]] v1::RelayRequest Batch(Random& random, std::size_t messages_max, Fresh fresh);

  void OnFrame(const v1::RelayResponse& frame);

 private:
  void OnWelcome(const v1::Welcome& welcome);
  void OnAck(const v1::Ack& ack);
  void OnForward(const v1::Forward& forward);
  void OnReject(const v1::Reject& reject);
  void OnLimited(model::Seq seq);
  [[nodiscard]] Content NextContent(Random& random) const;
  void AddFresh(v1::UplinkBatch& batch, Content content);
  void AddUplink(v1::UplinkBatch& batch, model::Seq seq, Content content) const;
  void CheckRejected(model::Seq judged);
  enum class When : std::uint8_t { kWelcome, kAck };
  void CheckDurable(model::Seq seq, Content content, When when);

  const Self self_;
  const Payloads& payloads_;
  Recorder& recorder_;
  const Recorder::Violation violation_;

  std::deque<AgentSession> sessions_;
  AgentSession* session_ = nullptr;
  bool welcomed_ = false;
  bool resends_all_ = false;
  bool greedy_ = false;
  bool may_be_limited_ = false;
  bool floods_ = false;
  /// By item: what was rejected for its rate while nothing newer names the item.
  std::map<std::size_t, Content> limited_;
  /// Of each item, the message that names it last.
  std::map<std::size_t, std::pair<model::SessionId, model::Seq>> newest_;
  std::deque<model::Seq> resend_;
  model::Seq stream_through_ = 0;
  model::Seq stream_judged_ = 0;
  /// Bad content that was sent for the first time on this stream and whose Reject has not come.
  std::set<model::Seq> unrejected_;
  ForwardTable table_;
};

}  // namespace uplink::simulation
