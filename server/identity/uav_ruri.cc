#include "server/identity/uav_ruri.h"

#include <fmt/format.h>

#include "server/identity/ruri.h"

namespace uplink::identity {

std::optional<std::string> FlawOfUavTemplate(std::string_view ruri_template) {
  const std::size_t place = ruri_template.find(kUavIdPlace);
  if (place == std::string_view::npos) return fmt::format("names no {}", kUavIdPlace);
  if (ruri_template.find(kUavIdPlace, place + 1) != std::string_view::npos) {
    return fmt::format("names {} twice", kUavIdPlace);
  }
  const std::string example = UavRuri(ruri_template, "1");
  if (auto flaw = FlawOfRuri(example)) return flaw;
  if (NamesTwin(example)) return "names twins, which are heard through their broker alone";
  return std::nullopt;
}

std::string UavRuri(std::string_view ruri_template, std::string_view uav_id) {
  std::string ruri(ruri_template);
  ruri.replace(ruri.find(kUavIdPlace), kUavIdPlace.size(), uav_id);
  return ruri;
}

}  // namespace uplink::identity
