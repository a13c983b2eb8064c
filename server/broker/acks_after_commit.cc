#include "server/broker/acks_after_commit.h"

#include <algorithm>

#include "schema/base/check.h"

namespace uplink::broker {

AcksAfterCommit::AcksAfterCommit(const journal::Shards& journals,
                                 std::function<void(std::size_t shard)> answered)
    : journals_(journals), inbox_(std::move(answered)), asked_(journals.all().size()) {}

std::size_t AcksAfterCommit::ShardOf(const journal::Journal& journal) const {
  const auto found = std::ranges::find(journals_.all(), &journal);
  UPLINK_CHECK(found != journals_.all().end(), "streams write to the journals of the server");
  return static_cast<std::size_t>(found - journals_.all().begin());
}

void AcksAfterCommit::Add(std::size_t shard, const mqtt::AckHandle& ack) {
  Asked& asked = asked_[shard];
  asked.next.push_back(ack);
  if (!asked.waits) Ask(shard);
}

std::vector<mqtt::AckHandle> AcksAfterCommit::Answered(std::size_t shard) {
  Asked& asked = asked_[shard];
  asked.waits = false;
  std::vector<mqtt::AckHandle> covered = std::exchange(asked.covered, {});
  if (!asked.next.empty()) Ask(shard);
  return covered;
}

void AcksAfterCommit::Clear() {
  for (Asked& asked : asked_) {
    asked.covered.clear();
    asked.next.clear();
  }
}

void AcksAfterCommit::Ask(std::size_t shard) {
  Asked& asked = asked_[shard];
  asked.waits = true;
  asked.covered = std::exchange(asked.next, {});
  journals_.all()[shard]->WhenCommitted({.inbox = &inbox_, .stream = shard});
}

}  // namespace uplink::broker
