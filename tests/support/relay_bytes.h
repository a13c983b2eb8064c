#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "schema/model/ids.h"
#include "tests/support/http2_answers.h"
#include "tests/support/http2_frames.h"
#include "tests/support/relay_samples.h"
#include "uplink/v1/relay.pb.h"

// What an agent says on the wire of gRPC over HTTP/2, and what it reads there.
namespace uplink::testing {

/// The headers of a call of Relay, with these in place of its own or beside them; an empty value
/// leaves the header out.
[[nodiscard]] http2::Fields RelayFields(const http2::Fields& changes = {});
/// HEADERS that open a call of Relay on the stream.
[[nodiscard]] std::string OpenRelay(std::uint32_t stream, const http2::Fields& changes = {});
/// The five bytes before a message.
[[nodiscard]] std::string Prefix(std::uint32_t bytes, char flag = '\0');
[[nodiscard]] std::string WithPrefix(std::string_view message);
/// Hello of the session that `number` tells apart, for a robot; a gateway names it.
[[nodiscard]] std::string HelloMessage(std::uint8_t number, const std::string& ruri = {});
/// A batch of faults, one for each seq from `first` on.
[[nodiscard]] std::string FaultsMessage(model::Seq first, std::size_t count);

/// What the server sent on the stream so far, of whole messages.
[[nodiscard]] std::vector<v1::RelayResponse> FramesOf(const RawStream& stream);
/// The highest through_seq and judged_seq of its Acks.
[[nodiscard]] v1::Ack LastAck(const RawStream& stream);
/// `grpc-status`, empty before the end.
[[nodiscard]] std::string StatusOf(const RawStream& stream);

}  // namespace uplink::testing
