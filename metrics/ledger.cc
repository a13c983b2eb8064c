#include "metrics/ledger.h"

namespace uplink::metrics {
namespace {

/// Counts of skipped numbers may reach 2^63 in one message; they stop at the top instead of
/// wrapping.
std::uint64_t AddSaturating(std::uint64_t a, std::uint64_t b) {
  return a + b < a ? ~std::uint64_t{0} : a + b;
}

void AddPage(Ledger::Page& sum, const Ledger::Page& page) {
  sum.uplinks += page.uplinks;
  for (std::size_t v = 0; v < page.dropped.size(); ++v) {
    for (std::size_t r = 0; r < page.dropped[v].size(); ++r)
      sum.dropped[v][r] += page.dropped[v][r];
  }
  for (std::size_t k = 0; k < page.rejected_kinds.size(); ++k) {
    for (std::size_t r = 0; r < page.rejected_kinds[k].size(); ++r)
      sum.rejected_kinds[k][r] += page.rejected_kinds[k][r];
  }
  sum.odd += page.odd;
}

}  // namespace

UplinkCounts& UplinkCounts::operator+=(const UplinkCounts& other) {
  received += other.received;
  stored += other.stored;
  applied += other.applied;
  superseded += other.superseded;
  duplicate += other.duplicate;
  rejected += other.rejected;
  in_flight += other.in_flight;
  missing = AddSaturating(missing, other.missing);
  for (std::size_t i = 0; i < rejects.size(); ++i) rejects[i] += other.rejects[i];
  for (std::size_t i = 0; i < records.size(); ++i) records[i] += other.records[i];
  rcan_states += other.rcan_states;
  rcan_missing = AddSaturating(rcan_missing, other.rcan_missing);
  return *this;
}

bool UplinkCounts::Balanced() const {
  const auto settled = stored + applied + superseded + duplicate + rejected;
  return static_cast<std::int64_t>(received) == static_cast<std::int64_t>(settled) + in_flight;
}

OddCounts& OddCounts::operator+=(const OddCounts& other) {
  times_unknown += other.times_unknown;
  enumerants_unrecognized += other.enumerants_unrecognized;
  control_characters += other.control_characters;
  return *this;
}

void Ledger::Publish(const UplinkCounts& delta) {
  const std::lock_guard lock(mutex_);
  page_.uplinks += delta;
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

Ledger& LedgerBook::NewPage() {
  const std::lock_guard lock(mutex_);
  return *pages_.emplace_back(std::make_unique<Ledger>());
}

Ledger::Page LedgerBook::Sum() const {
  const std::lock_guard lock(mutex_);
  Ledger::Page sum;
  for (const auto& page : pages_) AddPage(sum, page->Read());
  return sum;
}

}  // namespace uplink::metrics
