#include "tests/bench/load/nats.h"

#include <charconv>
#include <optional>

namespace uplink::bench {
namespace {

constexpr std::string_view kLineEnd = "\r\n";
constexpr std::string_view kMessageStart = "MSG ";

/// The last word of a message's line is how long its payload is.
std::optional<std::size_t> PayloadBytes(std::string_view line) {
  const std::string_view word = line.substr(line.rfind(' ') + 1);
  std::size_t bytes = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), bytes);
  if (word.empty() || error != std::errc() || end != word.data() + word.size()) {
    return std::nullopt;
  }
  return bytes;
}

NatsSaid ReadMessage(std::string_view in, std::string_view line) {
  const std::optional<std::size_t> payload = PayloadBytes(line);
  if (!payload) return {.kind = NatsSaid::Kind::kMalformed};
  const std::string_view rest = in.substr(line.size() + kLineEnd.size());
  if (rest.size() < kLineEnd.size() || rest.size() - kLineEnd.size() < *payload) return {};
  if (rest.substr(*payload, kLineEnd.size()) != kLineEnd) {
    return {.kind = NatsSaid::Kind::kMalformed};
  }
  return {.kind = NatsSaid::Kind::kMessage,
          .text = rest.substr(0, *payload),
          .bytes = line.size() + *payload + 2 * kLineEnd.size()};
}

}  // namespace

NatsSaid ReadNats(std::string_view in) {
  const std::size_t end = in.find(kLineEnd);
  if (end == std::string_view::npos) return {};
  const std::string_view line = in.substr(0, end);
  if (line.starts_with(kMessageStart)) return ReadMessage(in, line);
  NatsSaid said{.kind = NatsSaid::Kind::kOther, .text = line, .bytes = end + kLineEnd.size()};
  if (line == "PING") said.kind = NatsSaid::Kind::kPing;
  if (line == "PONG") said.kind = NatsSaid::Kind::kPong;
  if (line.starts_with("-ERR")) said.kind = NatsSaid::Kind::kError;
  return said;
}

}  // namespace uplink::bench
