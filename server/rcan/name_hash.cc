#include "server/rcan/name_hash.h"

#include <bit>
#include <cstddef>

namespace uplink::rcan {
namespace {

constexpr std::size_t kBlockBytes = 8;

/// SipHash-1-3 by J.-P. Aumasson and D. J. Bernstein: one round per block, three at the end.
class SipState final {
 public:
  explicit SipState(const NameHash::Key& key)
      // The constants of the paper: "somepseudorandomlygeneratedbytes".
      : a_(key[0] ^ 0x736f6d6570736575U),
        b_(key[1] ^ 0x646f72616e646f6dU),
        c_(key[0] ^ 0x6c7967656e657261U),
        d_(key[1] ^ 0x7465646279746573U) {}

  void Take(std::uint64_t block) {
    d_ ^= block;
    Round();
    a_ ^= block;
  }
  [[nodiscard]] std::uint64_t Finish() {
    constexpr std::uint64_t kEndMark = 0xff;
    c_ ^= kEndMark;
    Round();
    Round();
    Round();
    return a_ ^ b_ ^ c_ ^ d_;
  }

 private:
  void Round() {
    a_ += b_;
    b_ = std::rotl(b_, 13) ^ a_;
    a_ = std::rotl(a_, 32);
    c_ += d_;
    d_ = std::rotl(d_, 16) ^ c_;
    a_ += d_;
    d_ = std::rotl(d_, 21) ^ a_;
    c_ += b_;
    b_ = std::rotl(b_, 17) ^ c_;
    c_ = std::rotl(c_, 32);
  }

  std::uint64_t a_;
  std::uint64_t b_;
  std::uint64_t c_;
  std::uint64_t d_;
};

/// Little-endian on every machine; the compiler turns it into one load.
std::uint64_t BlockOf(std::string_view bytes) {
  std::uint64_t block = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    block |= std::uint64_t{static_cast<unsigned char>(bytes[i])} << (i * kBlockBytes);
  }
  return block;
}

}  // namespace

std::uint64_t NameHash::operator()(std::string_view text) const {
  SipState state(key_);
  std::string_view left = text;
  for (; left.size() >= kBlockBytes; left.remove_prefix(kBlockBytes)) {
    state.Take(BlockOf(left.substr(0, kBlockBytes)));
  }
  constexpr int kTopByte = 56;
  state.Take(BlockOf(left) | std::uint64_t{text.size()} << kTopByte);
  return state.Finish();
}

}  // namespace uplink::rcan
