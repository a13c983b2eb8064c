#include "server/store/clock_judge.h"

#include <fmt/core.h>

namespace uplink::store {
namespace {

std::int64_t SecondsOf(milliseconds span) {
  return std::chrono::duration_cast<std::chrono::seconds>(span).count();
}

}  // namespace

bool ClockFacts::DatabaseAgrees() const {
  if (!database) return true;
  const milliseconds apart = *database - now;
  return apart <= kDatabaseAgreesWithin && -apart <= kDatabaseAgreesWithin;
}

Voucher VoucherOf(const ClockFacts& facts) {
  if (facts.mark && facts.now - *facts.mark <= kPastMarkMax) return Voucher::kMark;
  if (facts.kernel_synchronised && facts.DatabaseAgrees()) return Voucher::kKernel;
  return Voucher::kNobody;
}

bool MayMoveMark(const ClockFacts& facts) {
  if (VoucherOf(facts) == Voucher::kNobody) return false;
  return !facts.mark || facts.now >= *facts.mark || facts.DatabaseAgrees();
}

std::string WhyNobodyVouches(const ClockFacts& facts) {
  std::string why = facts.mark ? fmt::format("it is {} s past the mark in the store",
                                             SecondsOf(facts.now - *facts.mark))
                               : "the store has no mark";
  if (!facts.kernel_synchronised) return why + ", and the kernel does not call it synchronised";
  if (facts.DatabaseAgrees()) return why;
  return why + fmt::format(", and the database's clock differs by {} s",
                           SecondsOf(*facts.database - facts.now));
}

}  // namespace uplink::store
