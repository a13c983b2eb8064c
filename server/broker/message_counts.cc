#include "server/broker/message_counts.h"

#include <numeric>

namespace uplink::broker {
namespace {

template <typename Array>
void AddTo(Array& sum, const Array& other) {
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += other[i];
}

}  // namespace

MessageCounts& MessageCounts::operator+=(const MessageCounts& other) {
  received += other.received;
  in_flight += other.in_flight;
  AddTo(became, other.became);
  AddTo(rejects, other.rejects);
  AddTo(dropped, other.dropped);
  return *this;
}

bool MessageCounts::Balanced() const {
  const std::uint64_t settled = std::accumulate(became.begin(), became.end(), std::uint64_t{0});
  return in_flight >= 0 && received == settled + static_cast<std::uint64_t>(in_flight);
}

void MessageLedger::Publish(const MessageCounts& delta) {
  const std::lock_guard lock(mutex_);
  counts_ += delta;
}

MessageCounts MessageLedger::Read() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

}  // namespace uplink::broker
