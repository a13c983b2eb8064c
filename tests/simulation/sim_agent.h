#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "schema/model/ids.h"
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
  /// Numbers whose Reject arrived.
  std::set<model::Seq> told;
};

/// An agent that follows the protocol to the letter, and checks what the server promises it.
class SimAgent final {
 public:
  SimAgent(std::string ruri, const Payloads& payloads, Recorder& recorder,
           Recorder::Violation violation)
      : ruri_(std::move(ruri)),
        payloads_(payloads),
        recorder_(recorder),
        violation_(std::move(violation)) {}

  /// From now on everything that it sends anew is large and durable.
  void BeGreedy() { greedy_ = true; }

  [[nodiscard]] const std::string& ruri() const { return ruri_; }
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
  [[nodiscard]] bool HasResends() const { return !resend_.empty(); }
  enum class Fresh : std::uint8_t { kNo, kYes };
  /// Up to `messages_max` messages: what is sent again first, then fresh ones.
  [[nodiscard]] v1::RelayRequest Batch(Random& random, std::size_t messages_max, Fresh fresh);

  void OnFrame(const v1::RelayResponse& frame);

 private:
  void OnWelcome(const v1::Welcome& welcome);
  void OnAck(const v1::Ack& ack);
  void AddUplink(v1::UplinkBatch& batch, model::Seq seq, Content content) const;
  void CheckRejected(model::Seq judged);
  void CheckDurable(model::Seq seq, const char* when);

  const std::string ruri_;
  const Payloads& payloads_;
  Recorder& recorder_;
  const Recorder::Violation violation_;

  std::deque<AgentSession> sessions_;
  AgentSession* session_ = nullptr;
  bool welcomed_ = false;
  bool resends_all_ = false;
  bool greedy_ = false;
  std::deque<model::Seq> resend_;
  model::Seq stream_through_ = 0;
  model::Seq stream_judged_ = 0;
  /// Bad content that was sent for the first time on this stream and whose Reject has not come.
  std::set<model::Seq> unrejected_;
};

}  // namespace uplink::simulation
