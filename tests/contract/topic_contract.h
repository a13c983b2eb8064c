#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "tests/contract/store_contract.h"

namespace uplink::testing {

/// Processes that share leases on topics. One client id and one prefix if a test names no other.
class TopicContract : public StoreContract {
 protected:
  storage::TopicLeases& Leases(std::uint8_t process = kProcess) {
    return store_->TopicLeasesOf(process);
  }
  static storage::TakeRequest Wants(std::vector<std::string> prefixes = {""},
                                    std::string client_id = "uplinkd") {
    storage::TakeRequest request;
    request.client_id = std::move(client_id);
    request.prefixes = std::move(prefixes);
    request.at = Time();
    return request;
  }
  /// The same of a process that judged another to be over.
  static storage::TakeRequest After(std::uint8_t process, storage::TakeRequest request,
                                    std::uint64_t counter = 0) {
    request.over.push_back({storage::ProcessId{process}, counter});
    return request;
  }
  std::optional<storage::Epoch> Take(const storage::TakeRequest& request,
                                     std::uint8_t process = kProcess) {
    const auto epoch = Leases(process).Take(request);
    EXPECT_TRUE(epoch.ok()) << epoch.status();
    return epoch.ok() ? *epoch : std::nullopt;
  }
  std::vector<storage::TopicLease> Read() {
    auto leases = Leases().Read();
    EXPECT_TRUE(leases.ok()) << leases.status();
    return leases.value_or(std::vector<storage::TopicLease>());
  }
  storage::DeliveryMemory Memory(const std::string& client_id = "uplinkd",
                                 std::uint8_t process = kProcess) {
    auto memory = Leases(process).MemoryOf(client_id);
    EXPECT_TRUE(memory.ok()) << memory.status();
    return memory.value_or(storage::DeliveryMemory());
  }

  static storage::TopicHoldRef Hold(std::optional<storage::Epoch> epoch,
                                    std::string client_id = "uplinkd") {
    return std::make_shared<const storage::TopicHold>(
        storage::TopicHold{std::move(client_id), epoch.value_or(0)});
  }
  static storage::CommitRecord Under(const storage::TopicHoldRef& hold,
                                     storage::CommitRecord record) {
    record.origin =
        storage::OriginOf(model::MessageSource::kCyberwave, "cyberwave/twin/T/event", hold);
    return record;
  }
};

}  // namespace uplink::testing
