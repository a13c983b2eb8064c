#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <google/protobuf/message.h>

#include "server/view/text_members.h"

namespace uplink::view {

/// The wire form of a message with its `texts`, which become its fields of type Struct without ever
/// being one: a Struct takes up to 200 bytes for each of their bytes. A text that is no object is
/// the empty Struct. A number of more than 15 digits may differ in its last one: Boost's parser
/// does not round it correctly.
///
/// Thread: pure; any thread.
[[nodiscard]] std::string WireOf(const google::protobuf::Message& message,
                                 const TextMembers& texts = {});

/// Appends a field whose value has a length: a text, or a message in its wire form.
void AppendField(std::uint32_t number, std::string_view value, std::string& wire);

}  // namespace uplink::view
