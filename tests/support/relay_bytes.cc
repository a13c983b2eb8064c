#include "tests/support/relay_bytes.h"

#include <algorithm>

#include "schema/base/check.h"

namespace uplink::testing {
namespace {

constexpr std::size_t kPrefixBytes = 5;

}  // namespace

http2::Fields RelayFields(const http2::Fields& changes) {
  http2::Fields fields = {{":method", "POST"},
                          {":scheme", "https"},
                          {":path", "/uplink.v1.UplinkRelay/Relay"},
                          {":authority", "localhost"},
                          {"content-type", "application/grpc"},
                          {"te", "trailers"}};
  for (const auto& change : changes) {
    const auto found = std::find_if(fields.begin(), fields.end(),
                                    [&](const auto& field) { return field.first == change.first; });
    if (found == fields.end()) {
      fields.push_back(change);
    } else {
      found->second = change.second;
    }
  }
  std::erase_if(fields, [](const auto& field) { return field.second.empty(); });
  return fields;
}

std::string OpenRelay(std::uint32_t stream, const http2::Fields& changes) {
  return http2::Headers(stream, RelayFields(changes));
}

std::string Prefix(std::uint32_t bytes, char flag) {
  std::string prefix(1, flag);
  for (int shift = 24; shift >= 0; shift -= 8) {
    prefix += static_cast<char>((bytes >> static_cast<unsigned>(shift)) & 0xFFU);
  }
  return prefix;
}

std::string WithPrefix(std::string_view message) {
  return Prefix(static_cast<std::uint32_t>(message.size())).append(message);
}

std::string HelloMessage(std::uint8_t number, const std::string& ruri) {
  v1::RelayRequest hello = HelloFrame(SessionOf(number));
  hello.mutable_hello()->set_robot_ruri(ruri);
  return WithPrefix(hello.SerializeAsString());
}

std::string FaultsMessage(model::Seq first, std::size_t count) {
  std::vector<Sent> messages;
  for (model::Seq seq = first; seq < first + count; ++seq) {
    messages.push_back({seq, FaultPayload("fault-" + std::to_string(seq))});
  }
  return WithPrefix(BatchFrame(messages).SerializeAsString());
}

std::vector<v1::RelayResponse> FramesOf(const RawStream& stream) {
  std::vector<v1::RelayResponse> frames;
  std::string_view rest = stream.data;
  while (rest.size() >= kPrefixBytes) {
    const std::size_t bytes = http2::NumberOf(rest.substr(1, 4));
    if (rest.size() - kPrefixBytes < bytes) break;
    const std::string_view message = rest.substr(kPrefixBytes, bytes);
    UPLINK_CHECK(rest.front() == '\0' && frames.emplace_back().ParseFromArray(
                                             message.data(), static_cast<int>(message.size())),
                 "the server sent no RelayResponse");
    rest.remove_prefix(kPrefixBytes + bytes);
  }
  return frames;
}

v1::Ack LastAck(const RawStream& stream) {
  v1::Ack last;
  for (const v1::RelayResponse& frame : FramesOf(stream)) {
    if (frame.has_ack()) last = frame.ack();
  }
  return last;
}

std::string StatusOf(const RawStream& stream) { return stream.Trailer("grpc-status"); }

}  // namespace uplink::testing
