#include "server/rcan/named_series.h"

#include <algorithm>
#include <bit>
#include <cstdint>

namespace uplink::rcan {
namespace {

using metrics::rcan::SeriesId;
using Set = SeriesNames::Set;

SeriesId At(SeriesId first, std::size_t i) {
  return static_cast<SeriesId>(static_cast<std::size_t>(first) + i);
}

constexpr bool Has(Set set, std::size_t i) { return ((unsigned{set} >> i) & 1U) != 0; }

std::size_t Count(unsigned set) { return static_cast<std::size_t>(std::popcount(set)); }

}  // namespace

void NamedSeries::Add(SeriesId first, std::string_view label,
                      std::span<const std::optional<double>> values) {
  const std::size_t most = rules_.limits.names_max;
  std::size_t room = most - std::min(most, scrape_.basic + page_.robot_samples());
  Set wanted = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!values[i] || !page_.Writes(At(first, i))) continue;
    if (room == 0) {
      ++left_out_.over_max;
      continue;
    }
    --room;
    wanted = static_cast<Set>(wanted | 1U << i);
  }
  if (wanted == 0) return;
  const SeriesNames::Answer answer = Admit(first, label, wanted);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (Has(answer.shown, i)) page_.Add(At(first, i), label, *values[i]);
  }
  if (answer.shown == wanted) return;
  const std::size_t no_place = Count(answer.no_place);
  left_out_.over_max += no_place;
  left_out_.new_names += Count(wanted) - Count(answer.shown) - no_place;
}

SeriesNames::Answer NamedSeries::Admit(SeriesId first, std::string_view label, Set wanted) {
  if (!begun_) names_.BeginScrape(scrape_.now);
  begun_ = true;
  // A joint and a computer of the same name are two labels.
  const std::uint64_t number = rules_.hash(label) ^ static_cast<std::uint64_t>(first);
  return names_.Admit(number, wanted, rules_.limits);
}

}  // namespace uplink::rcan
