#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/raw_tcp.h"

namespace uplink::testing {

/// Addresses of loopback, `127.0.0.FIRST` and those that follow; 127.0.0.254 is the last.
[[nodiscard]] std::vector<std::string> LoopbackSources(std::size_t first, std::size_t count);

/// Connections to one port that each say one word, and no more; from each source alternately.
///
/// Thread: confined to one.
class TcpCrowd final {
 public:
  TcpCrowd(std::uint16_t port, std::vector<std::string> sources, std::string word)
      : port_(port), sources_(std::move(sources)), word_(std::move(word)) {}

  /// So many more of them.
  void Grow(std::size_t count);
  /// A new one in the place of each that the peer has ended; how many.
  std::size_t Replace();
  [[nodiscard]] const std::vector<std::unique_ptr<RawTcp>>& members() const { return members_; }

 private:
  [[nodiscard]] std::unique_ptr<RawTcp> Make();

  const std::uint16_t port_;
  const std::vector<std::string> sources_;
  const std::string word_;
  std::size_t made_ = 0;
  std::vector<std::unique_ptr<RawTcp>> members_;
};

}  // namespace uplink::testing
