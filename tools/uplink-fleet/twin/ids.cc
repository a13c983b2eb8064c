#include "tools/uplink-fleet/twin/ids.h"

#include <charconv>
#include <system_error>

#include <fmt/core.h>

#include "tools/uplink-fleet/robot/behaviour/seeded.h"

namespace uplink::synthetic {
namespace {

/// Apart from all that the twin's own chance decides.
constexpr std::uint64_t kIdsSalt = 0x7477'696e'5f69'6473ULL;

std::string UuidOf(Seeded& chance) {
  const std::uint64_t high = chance.Next();
  const std::uint64_t low = chance.Next();
  return fmt::format("{:08x}-{:04x}-4{:03x}-8{:03x}-{:012x}", high >> 32U, (high >> 16U) & 0xFFFFU,
                     high & 0xFFFU, low >> 52U, low & 0xFFFF'FFFF'FFFFULL);
}

std::string SessionOf(std::string_view name, std::string_view kind, const std::string& run,
                      Seeded& chance) {
  return fmt::format("{}-{}_{}_{:016x}", name, run, kind, chance.Next());
}

std::string RuriOf(std::string_view kind, const TwinOptions& options, const std::string& twin) {
  std::string ruri = fmt::format("rcan://local.rcan/cyberwave/{}", kind);
  if (!options.prefix.empty()) ruri += '.';
  for (const char c : options.prefix) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '-' || c == '.' || c == '_' || c == '~';
    if (plain) {
      ruri += c;
    } else {
      ruri += fmt::format("%{:02X}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    }
  }
  return ruri + "/" + twin;
}

std::string MarkBegin(const TwinOptions& options) {
  return fmt::format("~{}-{}-", options.run, options.index);
}

}  // namespace

TwinIds IdsOf(const TwinOptions& options) {
  Seeded chance(Seeded(options.seed ^ kIdsSalt).Next() + options.index);
  TwinIds ids;
  ids.twin = UuidOf(chance);
  ids.environment = UuidOf(chance);
  ids.workflow_run = UuidOf(chance);
  ids.computer = fmt::format("edge-{:08x}", chance.Next() >> 32U);
  ids.driver_session = SessionOf("driver", "live", options.run, chance);
  ids.sim_session = SessionOf("simulation", "sim", options.run, chance);
  ids.viewer_session = SessionOf("viewer", "live", options.run, chance);
  ids.ruri = RuriOf("twin", options, ids.twin);
  ids.sim_ruri = RuriOf("sim", options, ids.twin);
  return ids;
}

std::string MarkOf(const TwinOptions& options, std::uint64_t number) {
  return fmt::format("{}{}~", MarkBegin(options), number);
}

std::optional<std::uint64_t> MarkIn(const TwinOptions& options, std::string_view bytes) {
  const std::string begin = MarkBegin(options);
  const std::size_t at = bytes.find(begin);
  if (at == std::string_view::npos) return std::nullopt;
  const std::string_view rest = bytes.substr(at + begin.size());
  std::uint64_t number = 0;
  const auto read = std::from_chars(rest.data(), rest.data() + rest.size(), number);
  const bool whole = read.ec == std::errc() && read.ptr != rest.data() + rest.size();
  return whole && *read.ptr == '~' ? std::optional(number) : std::nullopt;
}

}  // namespace uplink::synthetic
