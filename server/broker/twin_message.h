#pragma once

#include <optional>
#include <vector>

#include "schema/cyberwave/judge.h"
#include "server/broker/commits.h"
#include "server/broker/message_limits.h"
#include "server/broker/probe.h"
#include "server/broker/twin_stream.h"
#include "server/cyberwave/held.h"
#include "server/cyberwave/twins.h"
#include "server/ingest/message.h"
#include "server/mqtt/listener.h"

namespace uplink::broker {

/// What the messages of one broker have in common. The references outlive them.
struct TwinSources {
  cyberwave::Twins& twins;
  Commits& commits;
  MessageLimits& limits;
  metrics::Ledger& ledger;
  BrokerProbe& probe;
};

/// A judged message of a broker, with the stream it belongs to, as it is offered to the port.
///
/// Thread: confined to the broker's.
class TwinMessage final : public ingest::Message {
 public:
  /// What is known of it. The references outlive the message.
  struct Known {
    const mqtt::Publish& publish;
    cyberwave::Arrival arrived;
    /// It waited for room, and is counted as in flight.
    bool is_counted = false;
    const Commits::Delivered& delivered;
    cyberwave::Judgement& judgement;
    TwinStream& stream;
    /// Its twin exceeds the bound: it is rejected for that, whatever the rates of the stand-in.
    bool exceeds_robots_max = false;
  };
  TwinMessage(const TwinSources& sources, const Known& known);

  [[nodiscard]] const ingest::Arrival& arrival() const override { return arrival_; }
  [[nodiscard]] std::optional<ingest::RecordCost> Cost() override;
  void Begin() override;
  [[nodiscard]] std::optional<model::Rejection> TakeRate() override;
  [[nodiscard]] ingest::Numbered RejectLimited(const model::Rejection& rejection) override;
  [[nodiscard]] const model::Rejection* FindRejection() override {
    return known_.judgement.rejection();
  }
  [[nodiscard]] ingest::Quarantined Reject(const model::Rejection& rejection) override;
  [[nodiscard]] ingest::Brought Take() override;
  [[nodiscard]] ingest::Numbered Number(std::vector<storage::CommitRecord>& records,
                                        std::optional<model::RejectReason> rejected) override;
  void Settle(metrics::Became became) override;

 private:
  [[nodiscard]] MessageLimits::Message judged() const {
    return {
        .judgement = known_.judgement, .publish = known_.publish, .arrived = known_.arrived.steady};
  }

  const TwinSources& sources_;
  const Known known_;
  const ingest::Arrival arrival_;
  /// Kept, since the judgement is moved away.
  const cyberwave::Topic topic_;
  std::size_t records_max_ = 0;
  /// It brings no record only because of the faults that the store has, as remembered here.
  bool rests_on_store_ = false;
};

}  // namespace uplink::broker
