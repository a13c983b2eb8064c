#include "server/front/door/proxy_header.h"

#include <algorithm>
#include <cstring>

#include <netinet/in.h>

#include "schema/base/check.h"

namespace uplink::front {
namespace {

constexpr std::array<std::uint8_t, 12> kSignature{0x0D, 0x0A, 0x0D, 0x0A, 0x00, 0x0D,
                                                  0x0A, 0x51, 0x55, 0x49, 0x54, 0x0A};
constexpr std::size_t kCommandAt = kSignature.size();
constexpr std::size_t kFamilyAt = kCommandAt + 1;
constexpr std::size_t kLengthAt = kFamilyAt + 1;
static_assert(kLengthAt + 2 == ProxyHeader::kFixedBytes);

// Version 2 in the upper half.
constexpr std::uint8_t kCommandLocal = 0x20;
constexpr std::uint8_t kCommandProxy = 0x21;
// The family in the upper half, below it the kind of socket.
constexpr std::uint8_t kFamilyUnspec = 0x00;
constexpr std::uint8_t kFamilyTcp4 = 0x11;
constexpr std::uint8_t kFamilyTcp6 = 0x21;

}  // namespace

ProxyHeader::Result ProxyHeader::Take(std::string_view bytes) {
  UPLINK_CHECK(bytes.size() <= wanted(), "more was read than the header has");
  const std::size_t kept = std::min(taken_, kept_.size());
  const std::string_view begin = bytes.substr(0, kept_.size() - kept);
  std::memcpy(kept_.data() + kept, begin.data(), begin.size());
  taken_ += bytes.size();
  result_ = Judge();
  return result_;
}

ProxyHeader::Result ProxyHeader::Judge() {
  const std::size_t signature = std::min(taken_, kSignature.size());
  if (!std::equal(kept_.begin(), kept_.begin() + signature, kSignature.begin())) {
    return Result::kInvalid;
  }
  if (taken_ < kFixedBytes) return Result::kMore;
  if (taken_ == kFixedBytes && !JudgeFixed()) return Result::kInvalid;
  if (taken_ < bytes_) return Result::kMore;
  SetSource();
  return whole_;
}

bool ProxyHeader::JudgeFixed() {
  const std::size_t rest = std::size_t{kept_[kLengthAt]} << 8U | kept_[kLengthAt + 1];
  if (rest > kRestBytesMax) return false;
  bytes_ = kFixedBytes + rest;
  const std::uint8_t command = kept_[kCommandAt];
  // The specification says to ignore the family of LOCAL.
  whole_ = Result::kLocal;
  if (command == kCommandLocal) return true;
  if (command != kCommandProxy) return false;
  whole_ = Result::kRelayed;
  switch (kept_[kFamilyAt]) {
    case kFamilyUnspec:
      whole_ = Result::kUntold;
      return true;
    case kFamilyTcp4:
      family_ = Family::kIpv4;
      return rest >= kIpv4Bytes;
    case kFamilyTcp6:
      family_ = Family::kIpv6;
      return rest >= kIpv6Bytes;
    default:
      return false;
  }
}

void ProxyHeader::SetSource() {
  // Source and destination, then the port of each.
  const std::uint8_t* const addresses = kept_.data() + kFixedBytes;
  switch (family_) {
    case Family::kNone:
      return;
    case Family::kIpv4: {
      sockaddr_in source{};
      source.sin_family = AF_INET;
      std::memcpy(&source.sin_addr, addresses, sizeof(source.sin_addr));
      std::memcpy(&source.sin_port, addresses + 2 * sizeof(source.sin_addr),
                  sizeof(source.sin_port));
      std::memcpy(&source_, &source, sizeof(source));
      return;
    }
    case Family::kIpv6: {
      sockaddr_in6 source{};
      source.sin6_family = AF_INET6;
      std::memcpy(&source.sin6_addr, addresses, sizeof(source.sin6_addr));
      std::memcpy(&source.sin6_port, addresses + 2 * sizeof(source.sin6_addr),
                  sizeof(source.sin6_port));
      std::memcpy(&source_, &source, sizeof(source));
      return;
    }
  }
}

}  // namespace uplink::front
