#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <unordered_map>
#include <vector>

#include "server/front/call/call.h"
#include "server/transport/drain.h"

namespace uplink::front {

/// The calls of one connection, and the touched ones among them. Destroys a call once its stream is
/// gone, and only in Settle. Confined to its connection's thread.
class CallSet final {
 public:
  Call& Open(std::unique_ptr<Call> call);
  void Touch(Call& call);
  /// Settles touched calls, also those that settling touches; `settled` sees each before it may be
  /// destroyed.
  void Settle(const std::function<void(const Call&)>& settled);
  /// Tells all that the peer answered.
  void TellPeerAnswered();
  /// Ends all with a status of ours.
  void Fail(const absl::Status& status, transport::EndCause cause);
  /// Tells all that the connection is gone.
  void Break();
  /// Tells all calls to drain, one after the other, the first as number `first` of `spread`; they
  /// have until `end`.
  void Drain(const transport::DrainSpread& spread, std::size_t first, SteadyTime end);

  [[nodiscard]] std::size_t size() const { return calls_.size(); }
  [[nodiscard]] bool settled() const { return touched_.empty(); }

 private:
  std::unordered_map<std::int32_t, std::unique_ptr<Call>> calls_;
  std::vector<Call*> touched_;
};

}  // namespace uplink::front
