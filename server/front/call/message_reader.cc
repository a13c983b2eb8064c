#include "server/front/call/message_reader.h"

#include <utility>

#include "schema/base/check.h"

namespace uplink::front {
namespace {

/// Memory that is kept for the next message; more is given back.
constexpr std::size_t kKeptIdleBytes = 256;

std::uint64_t LengthOf(std::string_view prefix) {
  std::uint64_t length = 0;
  for (std::size_t i = 1; i < kPrefixBytes; ++i) {
    length = (length << 8U) | static_cast<unsigned char>(prefix[i]);
  }
  return length;
}

}  // namespace

void MessageReader::Add(std::string_view chunk) {
  UPLINK_CHECK(fresh_.empty(), "the bytes before were not kept");
  if (kept_.empty()) {
    fresh_ = chunk;
    return;
  }
  if (kept_from_ > 0) {
    kept_.erase(0, kept_from_);
    kept_from_ = 0;
  }
  kept_.append(chunk);
}

std::string_view MessageReader::Rest() const {
  return kept_.empty() ? fresh_ : std::string_view(kept_).substr(kept_from_);
}

MessageReader::Next MessageReader::Peek() const {
  const std::string_view rest = Rest();
  if (rest.size() < kPrefixBytes) return {};
  if (rest.front() != 0) return {.kind = Next::Kind::kBadFlag};
  const std::uint64_t length = LengthOf(rest);
  if (length > bytes_max_) return {.kind = Next::Kind::kTooLarge, .bytes = length};
  if (rest.size() - kPrefixBytes < length) return {.bytes = length};
  return {.kind = Next::Kind::kMessage,
          .message = rest.substr(kPrefixBytes, static_cast<std::size_t>(length)),
          .bytes = length};
}

std::size_t MessageReader::Pop() {
  const std::size_t bytes = kPrefixBytes + Peek().message.size();
  ++popped_;
  if (kept_.empty()) {
    fresh_.remove_prefix(bytes);
    return bytes;
  }
  kept_from_ += bytes;
  if (kept_from_ == kept_.size()) {
    if (kept_.capacity() > kKeptIdleBytes) std::string().swap(kept_);
    kept_.clear();
    kept_from_ = 0;
  } else if (kept_from_ >= kept_.size() / 2 && kept_.capacity() > kKeptIdleBytes) {
    // Do not keep a large message's memory for the few bytes behind it.
    std::string(kept_, kept_from_).swap(kept_);
    kept_from_ = 0;
  }
  return bytes;
}

void MessageReader::Keep() {
  if (fresh_.empty()) return;
  kept_.assign(std::exchange(fresh_, {}));
  kept_from_ = 0;
}

void MessageReader::Clear() {
  fresh_ = {};
  std::string().swap(kept_);
  kept_from_ = 0;
}

std::optional<std::size_t> MessageReader::unfinished() const {
  const Next next = Peek();
  if (next.kind != Next::Kind::kNone || Rest().size() < kPrefixBytes) return std::nullopt;
  return kPrefixBytes + static_cast<std::size_t>(next.bytes);
}

}  // namespace uplink::front
