#pragma once

#include <string_view>

#include "schema/cyberwave/reader.h"
#include "schema/model/cyberwave/head.h"

namespace uplink::cyberwave {

/// Whether a session is one of a simulation: `NAME_sim_HEX`, also with what a publisher appends for
/// one of its streams (`NAME_sim_HEX_front`). Pure.
[[nodiscard]] bool IsSimulatedSession(std::string_view session_id);

/// What the message's `source_type` is, before anything is judged; if it says nothing, the edge, or
/// the simulation if its session is one.
[[nodiscard]] model::cyberwave::SourceType SourceTypeOf(const Reader& in);

/// The head, with that type. `enclosed_seconds` is the time by what enclosed the message, which
/// counts if it has none of its own.
[[nodiscard]] model::cyberwave::Head ReadHead(Reader& in, model::cyberwave::SourceType type,
                                              double enclosed_seconds);

}  // namespace uplink::cyberwave
