#pragma once

#include <string_view>
#include <vector>

#include "metrics/ledger.h"
#include "schema/base/clock.h"
#include "schema/model/uncrew/types.h"
#include "schema/uncrew/judge.h"
#include "schema/uncrew/records.h"
#include "server/ingest/message.h"
#include "server/uncrew/answer.h"
#include "server/uncrew/live_samples.h"
#include "storage/commit_record.h"
#include "storage/samples.h"

namespace uplink::uncrew {

/// A judged request, as its call holds it. The references outlive the offer.
struct Sample {
  const Judgement& judged;
  std::string_view request;
  const storage::SampleDigest& digest;
  SteadyTime arrived;
  SystemTime arrived_system;
  /// It had to wait, and is counted as in flight.
  bool is_counted = false;

  [[nodiscard]] const model::uncrew::TypeRow& row() const {
    return model::uncrew::RowOf(judged.type);
  }
  [[nodiscard]] bool is_rejected() const { return judged.rejection() != nullptr; }
  /// A rejected sample of a live type. Like a good one it takes a token of the rate and is answered
  /// at once, even while the store is away: a bad sensor must not look like a lost link.
  [[nodiscard]] bool is_bad_live() const {
    return is_rejected() && row().kind == model::uncrew::SampleKind::kLive;
  }
  /// Whether an older sample of its type is worth nothing: of a set, or of a type that is shown.
  [[nodiscard]] bool is_ordered() const;
  /// The mark by which the store recognizes it.
  [[nodiscard]] storage::SampleRef MarkUnder(storage::Epoch claim) const;
  [[nodiscard]] ingest::Arrival arrival() const;
  /// As LiveSamples takes it; for a sample that is not rejected.
  [[nodiscard]] LiveSamples::Sample live() const;
  /// The records made of it, as the journal takes them.
  [[nodiscard]] std::vector<storage::CommitRecord> RecordsOf(std::vector<DurableRecord> made) const;
};

/// The claim that a question to the store is about.
struct Questioner {
  storage::RobotRef robot;
  model::SessionId session;
  SystemTime received_at;
  storage::Epoch claim = 0;
};
/// A record that asks whether the claim holds (storage::SampleMark::is_question).
[[nodiscard]] storage::CommitRecord QuestionOf(Questioner by);

/// Whether a sample of this type is the complete set of its kind, so that missing entries are over.
[[nodiscard]] constexpr bool IsSet(model::uncrew::SampleType type) {
  return type == model::uncrew::SampleType::kAlerts ||
         type == model::uncrew::SampleType::kOperatorRequests;
}

/// The outcome of a message that became this.
[[nodiscard]] Outcome OutcomeOf(metrics::Became became);

}  // namespace uplink::uncrew
