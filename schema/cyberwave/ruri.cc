#include "schema/cyberwave/ruri.h"

#include "schema/cyberwave/prefix.h"
#include "schema/model/ids.h"

namespace uplink::cyberwave {
namespace {

constexpr std::string_view kReal = "twin";
constexpr std::string_view kSimulated = "sim";

// With the dot before the prefix and the slash behind it.
static_assert(kRuriStem.size() + kReal.size() + 1 + kPrefixEncodedBytesMax + 1 +
                      model::cyberwave::Uuid::kTextBytes <=
                  model::kRuriBytesMax,
              "the longest prefix must fit a RURI");

}  // namespace

std::string TwinRuri(std::string_view prefix, const model::cyberwave::Uuid& twin, RobotKind kind) {
  std::string ruri;
  // Made for each message: without a longer prefix it takes memory once.
  ruri.reserve(kRuriStem.size() + kReal.size() + 1 + prefix.size() + 1 +
               model::cyberwave::Uuid::kTextBytes);
  ruri += kRuriStem;
  ruri += kind == RobotKind::kReal ? kReal : kSimulated;
  if (!prefix.empty()) ruri.append(".").append(PercentEncoded(prefix));
  return ruri.append("/").append(twin.ToText());
}

bool IsTwinRuri(std::string_view ruri) {
  if (!ruri.starts_with(kRuriStem)) return false;
  ruri.remove_prefix(kRuriStem.size());
  const std::string_view kind = ruri.substr(0, ruri.find_first_of("./"));
  return kind.size() < ruri.size() && (kind == kReal || kind == kSimulated);
}

}  // namespace uplink::cyberwave
