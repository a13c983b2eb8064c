#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "storage/claim.h"
#include "storage/samples.h"
#include "tests/contract/store_contract.h"

namespace uplink::testing {

/// Drones that call. The fixture's claim is that of its last Claim.
class ClaimContract : public StoreContract {
 protected:
  storage::ClaimRequest Asked(std::int64_t after_ms = 0) const { return {robot_, Time(after_ms)}; }
  std::vector<storage::ClaimResult> ClaimEach(const std::vector<storage::ClaimRequest>& requests,
                                              std::uint8_t process = kProcess) {
    auto results = store_->Process(process).ClaimDrones(requests);
    EXPECT_TRUE(results.ok()) << results.status();
    if (!results.ok() || results->size() != requests.size()) {
      return std::vector<storage::ClaimResult>(requests.size());
    }
    return *std::move(results);
  }
  /// Makes the claim that of the samples that follow.
  storage::ClaimResult Claim(std::uint8_t process = kProcess, std::int64_t after_ms = 0) {
    storage::ClaimResult result = ClaimEach({Asked(after_ms)}, process).front();
    claim_ = result.claim;
    return result;
  }

  /// Of a sample that says `content` and names a time, under the fixture's claim.
  storage::SampleMark Mark(std::uint8_t content, std::uint32_t type = 1) const {
    return {claim_, type, {content, 0xFF, 0, '\''}, true, {}};
  }
  static storage::SampleMark Untimed(storage::SampleMark mark) {
    mark.timed = false;
    return mark;
  }

  /// The records of one sample. They have numbers of their own.
  std::vector<storage::CommitRecord> Sample(storage::SampleMark mark,
                                            std::vector<storage::CommitContent> contents) {
    const auto shared = std::make_shared<const storage::SampleMark>(std::move(mark));
    std::vector<storage::CommitRecord> records;
    for (storage::CommitContent& content : contents) {
      storage::CommitRecord& record = records.emplace_back(Good(++number_));
      record.session = Session(77);
      record.held_since = 0;
      record.content = std::move(content);
      record.origin = storage::OriginOf(model::MessageSource::kUncrew, "");
      record.sample = shared;
    }
    return records;
  }
  std::vector<storage::CommitRecord> Sample(storage::SampleMark mark) {
    return Sample(std::move(mark), {Durable(Note())});
  }
  static storage::CommitContent Durable(const model::Body& body) { return test::RecordOf(body); }

  static std::vector<storage::CommitRecord> Join(std::vector<storage::CommitRecord> first,
                                                 std::vector<storage::CommitRecord> second) {
    for (storage::CommitRecord& record : second) first.push_back(std::move(record));
    return first;
  }

  storage::Epoch claim_ = 0;
  model::Seq number_ = 0;
};

}  // namespace uplink::testing
