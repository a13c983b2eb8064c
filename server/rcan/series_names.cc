#include "server/rcan/series_names.h"

#include <algorithm>
#include <bit>
#include <chrono>

namespace uplink::rcan {
namespace {

/// A bucket fills per second: with so many tokens for a name, its rate is that of names per hour.
constexpr std::uint64_t kTokensPerName =
    std::chrono::duration_cast<std::chrono::seconds>(std::chrono::hours(1)).count();
/// Room for the labels of most robots.
constexpr std::size_t kLabelsAtFirst = 8;

limits::BucketSize BucketOf(const SeriesNames::Limits& limits) {
  return {.rate = limits.new_per_hour, .burst = limits.new_per_hour * kTokensPerName};
}

constexpr SeriesNames::Set Without(SeriesNames::Set set, SeriesNames::Set others) {
  return static_cast<SeriesNames::Set>(set & ~others);
}

}  // namespace

void SeriesNames::BeginScrape(SteadyTime now) {
  before_ = now_;
  now_ = now;
  none_to_forget_ = false;
}

std::vector<SeriesNames::Label>::iterator SeriesNames::Find(std::uint64_t label) {
  return std::ranges::lower_bound(labels_, label, {}, &Label::label);
}

SeriesNames::Answer SeriesNames::Admit(std::uint64_t label, Set wanted, const Limits& limits) {
  const auto found = Find(label);
  const bool known = found != labels_.end() && found->label == label;
  if (known) found->said_at = now_;
  const Set fresh = known ? Without(wanted, found->names) : wanted;
  if (fresh == 0) return {.shown = wanted};
  return AdmitNew(label, wanted, fresh, limits);
}

SeriesNames::Answer SeriesNames::AdmitNew(std::uint64_t label, Set wanted, Set fresh,
                                          const Limits& limits) {
  Set taken = 0;
  Answer answer;
  for (std::size_t i = 0; i < kOfLabelMax; ++i) {
    const auto name = static_cast<Set>(fresh & (1U << i));
    if (name == 0) continue;
    switch (TakePlace(limits)) {
      case Place::kTaken:
        taken |= name;
        break;
      case Place::kNone:
        answer.no_place |= name;
        break;
      case Place::kTooManyNew:
        break;
    }
  }
  if (taken != 0) Keep(label, taken, limits.names_max);
  answer.shown = static_cast<Set>(Without(wanted, fresh) | taken);
  return answer;
}

SeriesNames::Place SeriesNames::TakePlace(const Limits& limits) {
  if (free_taken_ < limits.names_max) {
    ++free_taken_;
    ++names_;
    return Place::kTaken;
  }
  const limits::BucketSize size = BucketOf(limits);
  if (bucket_.PassesAt(kTokensPerName, size, now_) > now_) return Place::kTooManyNew;
  if (names_ >= limits.names_max && !ForgetOne(limits.forget_after)) return Place::kNone;
  bucket_.Take(kTokensPerName, size, now_);
  ++names_;
  return Place::kTaken;
}

bool SeriesNames::ForgetOne(milliseconds forget_after) {
  if (none_to_forget_) return false;
  const auto oldest = std::ranges::min_element(labels_, {}, &Label::said_at);
  // Names of the last scrape may come again in this one, however long ago that was.
  if (oldest == labels_.end() || oldest->said_at >= before_ ||
      oldest->said_at + forget_after > now_) {
    none_to_forget_ = true;
    return false;
  }
  names_ -= static_cast<std::size_t>(std::popcount(oldest->names));
  labels_.erase(oldest);
  return true;
}

void SeriesNames::Keep(std::uint64_t label, Set names, std::size_t names_max) {
  if (labels_.size() == labels_.capacity()) {
    labels_.reserve(std::min(std::max(2 * labels_.size(), kLabelsAtFirst), names_max));
  }
  const auto found = Find(label);
  if (found != labels_.end() && found->label == label) {
    found->names |= names;
  } else {
    labels_.insert(found, {.label = label, .said_at = now_, .names = names});
  }
}

}  // namespace uplink::rcan
