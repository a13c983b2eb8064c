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

/// A request that was judged, as its call holds it. The references outlive the look.
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
  /// Rejected, of a live type: it takes the same tokens as a good one, and like that it is answered
  /// at once, whatever the store does. A bad sensor is no lost link.
  [[nodiscard]] bool is_bad_live() const {
    return is_rejected() && row().kind == model::uncrew::SampleKind::kLive;
  }
  /// An older one says nothing any more: it is of a set, or of a type that is shown.
  [[nodiscard]] bool is_ordered() const;
  /// How the store knows it again.
  [[nodiscard]] storage::SampleRef MarkUnder(storage::Epoch claim) const;
  [[nodiscard]] ingest::Arrival arrival() const;
  /// As what is held of it; of one that is not rejected.
  [[nodiscard]] LiveSamples::Sample live() const;
  /// What was made of it, as the journal takes it.
  [[nodiscard]] std::vector<storage::CommitRecord> RecordsOf(std::vector<DurableRecord> made) const;
};

/// What a question to the store is of.
struct Questioner {
  storage::RobotRef robot;
  model::SessionId session;
  SystemTime received_at;
  storage::Epoch claim = 0;
};
/// A record that asks whether the claim holds (storage::SampleMark::is_question).
[[nodiscard]] storage::CommitRecord QuestionOf(Questioner by);

/// Whether a sample of this type is all of its kind that there is, and what is not in it is over.
[[nodiscard]] constexpr bool IsSet(model::uncrew::SampleType type) {
  return type == model::uncrew::SampleType::kAlerts ||
         type == model::uncrew::SampleType::kOperatorRequests;
}

/// What a drone is told of a message that became this.
[[nodiscard]] Outcome OutcomeOf(metrics::Became became);

}  // namespace uplink::uncrew
