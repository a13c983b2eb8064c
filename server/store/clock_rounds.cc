#include "server/store/clock_rounds.h"

#include <string>
#include <utility>

namespace uplink::store {
namespace {

const char* NameOf(Voucher voucher) {
  switch (voucher) {
    case Voucher::kNone:
      return "none";
    case Voucher::kMark:
      return "mark";
    case Voucher::kKernel:
      return "kernel";
    case Voucher::kMonotonic:
      return "monotonic";
  }
  return "";
}

/// Whether civil and monotonic time advanced alike from `before` to `now`.
bool GoTogether(const ClockPair& before, const ClockPair& now) {
  const milliseconds ahead = now.AheadSince(before);
  return ahead <= kAdvanceTolerance && -ahead <= kAdvanceTolerance;
}

}  // namespace

ClockRounds::ClockRounds(Context context)
    : context_(std::move(context)), mark_from_(ClockPair::Of(context_.clock.machine())) {}

void ClockRounds::Round() {
  Read();
  const ClockPair now = ClockPair::Of(context_.clock.machine());
  NoteJump(now);
  const ClockFacts facts = FactsAt(now);
  const Voucher voucher = reading_ ? VoucherOf(facts) : Voucher::kNone;
  const bool vouched = voucher != Voucher::kNone;
  // Not by itself: small steps would add up.
  if (vouched && voucher != Voucher::kMonotonic) {
    vouched_at_ = now;
    jumped_at_.reset();
  }
  context_.trust.Note(vouched, now);
  TellMark(voucher, facts);
  Tell(voucher, facts);
  MoveMark(facts, now);
}

void ClockRounds::TellMark(Voucher voucher, const ClockFacts& facts) {
  // A clock that the database or the kernel confirms stamps by itself: the mark may be of a server
  // whose clock is ahead.
  const bool confirmed = voucher == Voucher::kKernel || facts.Confirmed();
  const std::optional<SystemTime> mark = confirmed ? std::optional<SystemTime>() : facts.mark;
  // An unchanged mark advances by the monotonic clock.
  if (mark == told_mark_) return;
  told_mark_ = mark;
  if (mark) {
    context_.clock.NoteMark(*mark, read_at_);
  } else {
    context_.clock.ForgetMark();
  }
}

void ClockRounds::NoteJump(const ClockPair& now) {
  if (!vouched_at_ || now.AheadSince(*vouched_at_) <= kAdvanceTolerance) {
    jumped_at_.reset();
  } else if (!jumped_at_) {
    jumped_at_ = now.steady;
  }
}

void ClockRounds::Read() {
  auto reading = context_.marks.Read();
  if (reading.ok() && !reading_ && !reading->mark) {
    // The database's time, if it has one: the first server's clock may be the one that is wrong.
    const ClockFacts facts{.now = context_.clock.machine().System(),
                           .kernel_synchronised = context_.kernel_synchronised(),
                           .database = reading->database};
    const SystemTime first = facts.database.value_or(facts.now);
    // If the kernel confirms ours, it is unknown which of the two is right.
    const bool disputed = facts.kernel_synchronised && !facts.DatabaseAgrees();
    if (!disputed && !context_.marks.SetIfEmpty(first).ok()) return;
    reading = context_.marks.Read();
  }
  if (!reading.ok()) return;
  reading_ = *std::move(reading);
  read_at_ = context_.clock.Steady();
}

ClockFacts ClockRounds::FactsAt(const ClockPair& now) const {
  ClockFacts facts{.now = now.system, .kernel_synchronised = context_.kernel_synchronised()};
  facts.advanced_together = vouched_at_ && GoTogether(*vouched_at_, now);
  if (jumped_at_) {
    facts.since_jump = std::chrono::duration_cast<milliseconds>(now.steady - *jumped_at_);
  }
  if (!reading_) return facts;
  facts.mark = reading_->mark;
  if (reading_->database) {
    facts.database =
        *reading_->database + std::chrono::duration_cast<milliseconds>(now.steady - read_at_);
  }
  return facts;
}

void ClockRounds::MoveMark(const ClockFacts& facts, const ClockPair& now) {
  if (now.steady - mark_from_.steady < kMarkEvery) return;
  const bool together = GoTogether(mark_from_, now);
  mark_from_ = now;
  if (!reading_ || !together || !MayMoveMark(facts)) return;
  // If it fails, the next one comes in a minute.
  static_cast<void>(context_.marks.Set(MarkToSet(facts)));
}

void ClockRounds::Tell(Voucher voucher, const ClockFacts& facts) {
  const bool was_vouched = told_.value_or(Voucher::kMark) != Voucher::kNone;
  told_ = voucher;
  if ((voucher != Voucher::kNone) == was_vouched) return;
  if (voucher != Voucher::kNone) {
    context_.logger.Info("clock_vouched", {{"by", NameOf(voucher)}});
    return;
  }
  if (!reading_) {
    context_.logger.Warn("clock_not_vouched", {{"why", "the store has not been read yet"},
                                               {"effect", "nothing is deleted until then"}});
    return;
  }
  context_.logger.Warn("clock_not_vouched",
                       {{"why", WhyNotVouched(facts)},
                        {"effect",
                         "nothing is deleted until it is; if it is right, confirm it: "
                         "uplinkctl store clock --config FILE --confirm"}});
}

}  // namespace uplink::store
