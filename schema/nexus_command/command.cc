#include "schema/nexus_command/command.h"

namespace uplink::nexus_command {
namespace {

constexpr std::size_t kWordBytes = sizeof(std::uint64_t);

}  // namespace

CommandId RandomCommandId(const std::function<std::uint64_t()>& random) {
  CommandId id{};
  for (std::size_t begin = 0; begin < id.size(); begin += kWordBytes) {
    const std::uint64_t word = random();
    for (std::size_t i = 0; i < kWordBytes; ++i) {
      id[begin + i] = static_cast<std::uint8_t>(word >> (8 * i));
    }
  }
  // RFC 4122, 4.4: the version is in the upper half of octet 6, the variant in the upper two bits
  // of octet 8.
  id[6] = static_cast<std::uint8_t>((id[6] & 0x0FU) | 0x40U);
  id[8] = static_cast<std::uint8_t>((id[8] & 0x3FU) | 0x80U);
  return id;
}

std::string ForwardedId(std::string_view id, std::string_view origin_ruri) {
  std::string forwarded;
  forwarded.reserve(id.size() + 1 + origin_ruri.size());
  forwarded.append(id).append(1, '@').append(origin_ruri);
  return forwarded;
}

std::optional<std::string_view> OriginalId(std::string_view forwarded_id,
                                           std::string_view origin_ruri) {
  if (!forwarded_id.ends_with(origin_ruri)) return std::nullopt;
  forwarded_id.remove_suffix(origin_ruri.size());
  if (!forwarded_id.ends_with('@')) return std::nullopt;
  forwarded_id.remove_suffix(1);
  return forwarded_id;
}

}  // namespace uplink::nexus_command
