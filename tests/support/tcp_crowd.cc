#include "tests/support/tcp_crowd.h"

namespace uplink::testing {

std::vector<std::string> LoopbackSources(std::size_t first, std::size_t count) {
  std::vector<std::string> sources;
  sources.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    sources.push_back("127.0.0." + std::to_string(first + i));
  }
  return sources;
}

std::unique_ptr<RawTcp> TcpCrowd::Make() {
  auto member = std::make_unique<RawTcp>(port_, sources_[made_++ % sources_.size()]);
  static_cast<void>(member->SendSome(word_));
  return member;
}

void TcpCrowd::Grow(std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) members_.push_back(Make());
}

std::size_t TcpCrowd::Replace() {
  std::size_t replaced = 0;
  for (auto& member : members_) {
    static_cast<void>(member->Receive());
    if (member->end() == RawTcp::End::kNone) continue;
    member = Make();
    ++replaced;
  }
  return replaced;
}

}  // namespace uplink::testing
