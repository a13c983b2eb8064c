#include "server/uncrew/judged_sample.h"

#include <memory>
#include <string>
#include <utility>
#include <variant>

#include "server/uncrew/stored_samples.h"

namespace uplink::uncrew {

namespace {

constexpr std::int64_t kUsPerMs = 1000;

}  // namespace

ingest::Arrival Sample::arrival() const {
  return {.steady = arrived,
          .system = arrived_system,
          .payload = request,
          .payload_bytes = judged.payload_bytes,
          .waits = ingest::Waits::kStream,
          .is_counted = is_counted,
          .sampled_unix_ms = judged.metadata.sampled_at_us / kUsPerMs};
}

bool Sample::is_ordered() const {
  return !is_rejected() &&
         (IsSet(judged.type) || row().kind != model::uncrew::SampleKind::kDurable);
}

storage::SampleRef Sample::MarkUnder(storage::Epoch claim) const {
  using model::uncrew::SampleType;
  const SampleType type = is_rejected() ? SampleType::kRejected : judged.type;
  return std::make_shared<const storage::SampleMark>(storage::SampleMark{
      .claim = claim,
      .type = NumberOf(type),
      .digest = digest,
      .timed = judged.metadata.timed(),
      .last = is_rejected() ? std::string() : std::string(MemoryOf(type, request))});
}

LiveSamples::Sample Sample::live() const {
  return {.value = *judged.value(),
          .metadata = judged.metadata,
          .digest = digest,
          .received = arrived_system,
          .received_steady = arrived};
}

storage::CommitRecord QuestionOf(Questioner by) {
  return {.robot = std::move(by.robot),
          .session = by.session,
          .received_at = by.received_at,
          // A record needs some content; a question is never written.
          .content = model::OperatorRequest{},
          .payload = "",
          .payload_bytes = 0,
          .sample = std::make_shared<const storage::SampleMark>(
              storage::SampleMark{.claim = by.claim, .is_question = true})};
}

std::vector<storage::CommitRecord> Sample::RecordsOf(std::vector<DurableRecord> made) const {
  std::vector<storage::CommitRecord> records;
  records.reserve(made.size());
  for (DurableRecord& each : made) {
    records.push_back({.received_at = arrived_system,
                       .content = std::visit(
                           [](auto&& record) {
                             return storage::CommitContent(std::forward<decltype(record)>(record));
                           },
                           std::move(each)),
                       .payload = "",
                       .payload_bytes = judged.payload_bytes});
  }
  // The store may refuse a record, and quarantine then needs the payload. The first one carries it.
  if (!records.empty() && judged.may_be_kept) {
    records.front().payload = std::string(request);
  }
  return records;
}

Outcome OutcomeOf(metrics::Became became) {
  switch (became) {
    case metrics::Became::kApplied:
      return Outcome::kApplied;
    case metrics::Became::kSuperseded:
      return Outcome::kSuperseded;
    case metrics::Became::kDuplicate:
      return Outcome::kDuplicate;
    case metrics::Became::kStored:
      return Outcome::kStored;
    case metrics::Became::kRejected:
      return Outcome::kRejected;
    case metrics::Became::kRefused:
    case metrics::Became::kObserved:
    case metrics::Became::kIgnored:
    case metrics::Became::kBlocked:
      break;
  }
  return Outcome::kUnavailable;
}

}  // namespace uplink::uncrew
