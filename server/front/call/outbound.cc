#include "server/front/call/outbound.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>
#include <utility>

namespace uplink::front {
namespace {

/// Memory that is kept for the next message; more is given back.
constexpr std::size_t kIdleBytes = 256;

/// Copies as much of `text`, from `from` on, as fits.
std::size_t CopyFrom(std::string_view text, std::size_t from, char* into, std::size_t size) {
  const std::string_view rest = text.substr(from);
  const std::size_t bytes = std::min(size, rest.size());
  std::memcpy(into, rest.data(), bytes);
  return bytes;
}

}  // namespace

void Outbound::Set(std::string message) {
  own_ = std::move(message);
  from_ = next_ = 0;
}

void Outbound::Set(std::vector<SharedMessage> messages) {
  shared_ = std::move(messages);
  from_ = next_ = 0;
}

std::size_t Outbound::Take(char* into, std::size_t size) {
  if (!shared_.empty()) return TakeShared(into, size);
  const std::size_t bytes = CopyFrom(own_, from_, into, size);
  from_ += bytes;
  if (from_ == own_.size()) Clear();
  return bytes;
}

std::size_t Outbound::TakeShared(char* into, std::size_t size) {
  std::size_t taken = 0;
  while (taken < size && next_ < shared_.size()) {
    const std::string& message = *shared_[next_];
    std::size_t bytes = 0;
    if (from_ < kPrefixBytes) {
      std::array<char, kPrefixBytes> prefix{};
      transport::PutPrefix(message.size(), prefix.data());
      bytes = CopyFrom({prefix.data(), prefix.size()}, from_, into + taken, size - taken);
    } else {
      bytes = CopyFrom(message, from_ - kPrefixBytes, into + taken, size - taken);
    }
    taken += bytes;
    from_ += bytes;
    if (from_ < kPrefixBytes + message.size()) continue;
    shared_[next_++].reset();
    from_ = 0;
  }
  if (next_ == shared_.size()) Clear();
  return taken;
}

void Outbound::Clear() {
  from_ = next_ = 0;
  own_.clear();
  if (own_.capacity() > kIdleBytes) std::string().swap(own_);
  std::vector<SharedMessage>().swap(shared_);
}

}  // namespace uplink::front
