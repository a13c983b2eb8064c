#pragma once

#include <string>
#include <string_view>

namespace uplink::ctl {

/// Bytes as people read them: offset, sixteen bytes in hex, and the same as ASCII. Pure; any
/// thread.
[[nodiscard]] std::string HexText(std::string_view bytes);

/// A rejected payload in lines, or why it cannot be decoded: of `uplink` the message's members, of
/// `cyberwave` its JSON, of `uncrew` its fields by number. Pure; any thread.
[[nodiscard]] std::string DecodedText(std::string_view source, std::string_view payload);

}  // namespace uplink::ctl
