#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace uplink::identity {

/// The placeholder for a drone's id in uncrew.ruri_template.
inline constexpr std::string_view kUavIdPlace = "{uav_id}";

/// Why this is no template of RURIs, as the end of a sentence ("names no {uav_id}"); nothing if it
/// is one.
///
/// Thread: pure; any thread.
[[nodiscard]] std::optional<std::string> FlawOfUavTemplate(std::string_view ruri_template);

/// The RURI of the drone with this id, from a template without a flaw. Check the result with
/// FlawOfRuri: the id may be any text.
///
/// Thread: pure; any thread.
[[nodiscard]] std::string UavRuri(std::string_view ruri_template, std::string_view uav_id);

}  // namespace uplink::identity
