#include "server/store/clock_judge.h"

#include <algorithm>

#include <fmt/core.h>
#include <sys/syscall.h>
#include <sys/timex.h>
#include <unistd.h>

namespace uplink::store {
namespace {

std::int64_t SecondsOf(milliseconds span) {
  return std::chrono::duration_cast<std::chrono::seconds>(span).count();
}

bool FarAheadOfDatabase(const ClockFacts& facts) {
  return facts.database && facts.now - *facts.database > kAheadOfDatabaseMax;
}

bool BeforeMark(const ClockFacts& facts) {
  return facts.mark && *facts.mark - facts.now > kBeforeMarkTrusted;
}

bool NearMark(const ClockFacts& facts) {
  if (!facts.mark) return false;
  const milliseconds past = facts.now - *facts.mark;
  const bool doubtful = facts.since_jump || FarAheadOfDatabase(facts);
  const milliseconds past_max = doubtful ? milliseconds(kPastMarkDoubtful) : kPastMarkMax;
  return past <= past_max && !BeforeMark(facts);
}

std::string WhyNotTheMark(const ClockFacts& facts) {
  if (!facts.mark) return "the store has no mark";
  const milliseconds past = facts.now - *facts.mark;
  if (past.count() < 0)
    return fmt::format("it is {} s before the mark in the store", SecondsOf(-past));
  return fmt::format("it {}is {} s past the mark in the store",
                     facts.since_jump ? "jumped ahead, and " : "", SecondsOf(past));
}

}  // namespace

bool ClockFacts::DatabaseAgrees() const {
  if (!database) return true;
  const milliseconds apart = *database - now;
  return apart <= kDatabaseAgreesWithin && -apart <= kDatabaseAgreesWithin;
}

Voucher VoucherOf(const ClockFacts& facts) {
  if (NearMark(facts)) return Voucher::kMark;
  const bool kernel_knows =
      !facts.since_jump || facts.database || *facts.since_jump > kKernelNotices;
  if (facts.kernel_synchronised && kernel_knows && facts.DatabaseAgrees()) return Voucher::kKernel;
  if (facts.advanced_together && !BeforeMark(facts)) return Voucher::kMonotonic;
  return Voucher::kNone;
}

bool MayMoveMark(const ClockFacts& facts) {
  if (VoucherOf(facts) == Voucher::kNone) return false;
  return !facts.mark || facts.now >= *facts.mark || facts.Confirmed();
}

SystemTime MarkToSet(const ClockFacts& facts) {
  if (!facts.database || FarAheadOfDatabase(facts)) return facts.now;
  return std::min(facts.now, *facts.database);
}

std::string WhyNotVouched(const ClockFacts& facts) {
  std::string why = WhyNotTheMark(facts);
  if (!facts.kernel_synchronised) return why + ", and the kernel does not call it synchronised";
  if (facts.DatabaseAgrees()) return why;
  return why + fmt::format(", and the database's clock differs by {} s",
                           SecondsOf(*facts.database - facts.now));
}

bool KernelClockSynchronised() {
  timex state{};  // modes 0: nothing is set, and no right is needed
  // A direct system call: the C library's adjtimex calls clock_adjtime, which containers forbid.
  const long answer = ::syscall(SYS_adjtimex, &state);
  return answer != -1 && answer != TIME_ERROR && (state.status & STA_UNSYNC) == 0;
}

}  // namespace uplink::store
