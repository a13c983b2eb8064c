#include "tools/uplink-fleet/compare/findings.h"

#include <utility>

#include "schema/base/utf8.h"

namespace uplink::synthetic {
namespace {

constexpr auto kTexts = std::to_array<ThingText>({
#define UPLINK_THING(Name, text, of_store) {text, of_store},
#define UPLINK_PART(Part, column, view, Message, keys_max) {"last " #column, false},
    UPLINK_THINGS(UPLINK_THING, UPLINK_PART)
#undef UPLINK_PART
#undef UPLINK_THING
});

}  // namespace

ThingText TextOf(Thing thing) {
  if (thing == Thing::kRcan) return {"last RCAN states", false};
  return kTexts[static_cast<std::size_t>(thing)];
}

void Findings::Differ(Thing thing, const std::string& ruri, std::string expected,
                      std::string found) {
  ++At(thing).differences;
  if (differences_.size() >= kDifferencesMax) return;
  // The server's words among them: a report is read at a terminal.
  expected = PrintableUtf8(expected, std::string::npos);
  found = PrintableUtf8(found, std::string::npos);
  differences_.push_back({ruri, thing, std::move(expected), std::move(found)});
}

void Findings::Check(Thing thing, const std::string& ruri, bool right, std::string expected,
                     std::string found) {
  Expect(thing);
  if (right) return Find(thing);
  Differ(thing, ruri, std::move(expected), std::move(found));
}

std::uint64_t Findings::differences_in_all() const {
  std::uint64_t sum = 0;
  for (const Tally& tally : tallies_) sum += tally.differences;
  return sum;
}

}  // namespace uplink::synthetic
