#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "schema/uncrew/judge.h"
#include "server/ingest/message.h"
#include "server/limits/token_bucket.h"
#include "server/uncrew/answer.h"
#include "server/uncrew/waiting_samples.h"
#include "storage/origin.h"
#include "storage/samples.h"

namespace uplink::uncrew {

/// A call's sample as its drone offers it to the port: with the records to store, or with its
/// result without any.
///
/// Thread: that of the port, under the drone's lock.
class DroneMessage final : public ingest::Message {
 public:
  /// The references outlive it.
  struct Plan {
    const Judgement& judged;
    ingest::Arrival arrival;
    /// The mark of a stored sample; null for a live one.
    storage::SampleRef mark{};
    std::vector<storage::CommitRecord> records{};
    /// The result if there are no records.
    metrics::Became became = metrics::Became::kApplied;
    /// The drone's bucket, for samples with a rate; otherwise null.
    limits::TokenBucket* rate = nullptr;
    SteadyTime now;
    WaitingSamples& waiting;
    metrics::Ledger& ledger;
  };
  explicit DroneMessage(Plan plan) : plan_(std::move(plan)) {}

  [[nodiscard]] const ingest::Arrival& arrival() const override { return plan_.arrival; }
  [[nodiscard]] std::optional<ingest::RecordCost> Cost() override;
  void Begin() override {}
  [[nodiscard]] std::optional<model::Rejection> TakeRate() override;
  [[nodiscard]] ingest::Numbered RejectLimited(const model::Rejection& rejection) override;
  [[nodiscard]] const model::Rejection* FindRejection() override {
    return plan_.judged.rejection();
  }
  [[nodiscard]] ingest::Quarantined Reject(const model::Rejection& rejection) override;
  [[nodiscard]] ingest::Brought Take() override;
  [[nodiscard]] ingest::Numbered Number(std::vector<storage::CommitRecord>& records,
                                        std::optional<model::RejectReason> rejected) override;
  void Settle(metrics::Became /*became*/) override {}

  /// The ticket of the records, once they are numbered; null before.
  [[nodiscard]] const TicketRef& ticket() const { return ticket_; }
  /// Why it was over its rate.
  [[nodiscard]] const std::optional<model::Rejection>& limited() const { return limited_; }
  /// The drone's answer for that.
  [[nodiscard]] Answer LimitedAnswer() const {
    return {.outcome = Outcome::kRejected, .rejection = limited_, .retry_after = retry_after_};
  }

 private:
  Plan plan_;
  TicketRef ticket_;
  std::optional<model::Rejection> limited_;
  milliseconds retry_after_{0};
};

}  // namespace uplink::uncrew
