#include "metrics/ledger.h"

namespace uplink::metrics {
namespace {

/// Counts of skipped numbers may reach 2^63 in one message; they stop at the top instead of
/// wrapping.
std::uint64_t AddSaturating(std::uint64_t a, std::uint64_t b) {
  return a + b < a ? ~std::uint64_t{0} : a + b;
}

void AddTo(ReasonCounts& sum, const ReasonCounts& counts) {
  for (std::size_t kind = 0; kind < counts.size(); ++kind) {
    for (std::size_t r = 0; r < counts[kind].size(); ++r) sum[kind][r] += counts[kind][r];
  }
}

void AddTo(MessageAges& sum, const MessageAges& ages) {
  for (std::size_t kind = 0; kind < ages.size(); ++kind) sum[kind] += ages[kind];
}

void AddPage(Ledger::Page& sum, const Ledger::Page& page) {
  sum.messages += page.messages;
  AddTo(sum.dropped, page.dropped);
  AddTo(sum.rejected_kinds, page.rejected_kinds);
  sum.odd += page.odd;
  AddTo(sum.ages, page.ages);
}

}  // namespace

MessageCounts& MessageCounts::operator+=(const MessageCounts& other) {
  received += other.received;
  for (const BecameColumn& column : kBecame) this->*column.count += other.*column.count;
  in_flight += other.in_flight;
  missing = AddSaturating(missing, other.missing);
  for (std::size_t i = 0; i < rejects.size(); ++i) rejects[i] += other.rejects[i];
  for (std::size_t i = 0; i < records.size(); ++i) records[i] += other.records[i];
  rcan_states += other.rcan_states;
  rcan_missing = AddSaturating(rcan_missing, other.rcan_missing);
  return *this;
}

bool MessageCounts::Balanced() const {
  std::uint64_t settled = 0;
  for (const BecameColumn& column : kBecame) settled += this->*column.count;
  return static_cast<std::int64_t>(received) == static_cast<std::int64_t>(settled) + in_flight;
}

OddCounts& OddCounts::operator+=(const OddCounts& other) {
  times_unknown += other.times_unknown;
  enumerants_unrecognized += other.enumerants_unrecognized;
  control_characters += other.control_characters;
  return *this;
}

void Ledger::Publish(const MessageCounts& delta) {
  const std::lock_guard lock(mutex_);
  page_.messages += delta;
}

void Ledger::Publish(const MessageCounts& delta, const MessageAges& ages) {
  const std::lock_guard lock(mutex_);
  page_.messages += delta;
  AddTo(page_.ages, ages);
}

void Ledger::CountDropped(std::size_t kind, model::RejectReason reason, std::size_t fields) {
  const std::lock_guard lock(mutex_);
  page_.dropped.at(kind)[static_cast<std::size_t>(reason)] += fields;
}

void Ledger::CountRejected(std::size_t kind, model::RejectReason reason) {
  const std::lock_guard lock(mutex_);
  ++page_.rejected_kinds.at(kind)[static_cast<std::size_t>(reason)];
}

void Ledger::CountOdd(const OddCounts& delta) {
  const std::lock_guard lock(mutex_);
  page_.odd += delta;
}

Ledger::Page Ledger::Read() const {
  const std::lock_guard lock(mutex_);
  return page_;
}

Ledger& LedgerBook::NewPage(model::MessageSource source) {
  const std::lock_guard lock(mutex_);
  return *pages_.emplace_back(SourcePage{source, std::make_unique<Ledger>()}).ledger;
}

Ledger::Page LedgerBook::Sum(std::optional<model::MessageSource> source) const {
  const std::lock_guard lock(mutex_);
  Ledger::Page sum;
  for (const SourcePage& page : pages_) {
    if (!source || page.source == *source) AddPage(sum, page.ledger->Read());
  }
  return sum;
}

}  // namespace uplink::metrics
