#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <utility>

#include "schema/base/clock.h"
#include "tools/link/http2_link.h"
#include "tools/uplink-fleet/robot/shared.h"

namespace uplink::synthetic {

/// Robots of one gateway, as many as one of its certificates names and one connection takes.
inline constexpr std::size_t kRobotsPerGateway = 256;

/// A gateway: the connection that the streams of its robots share, opened again when it is over and
/// one of them wants it.
///
/// Thread: confined to the loop's thread; outlives its robots.
class Gateway final {
 public:
  Gateway(link::Loop& loop, link::LinkOptions options, Shared& shared)
      : loop_(loop), options_(std::move(options)), shared_(shared) {}

  /// For a new stream. A connection lasts as long as a robot has a part in it.
  [[nodiscard]] std::shared_ptr<link::Http2Link> Link(milliseconds delay) {
    if (auto current = link_.lock(); current != nullptr && !current->over()) return current;
    options_.delay = delay;
    auto fresh = std::make_shared<link::Http2Link>(loop_, options_, link::Http2Link::For::kSeveral);
    link_ = fresh;
    shared_.connects.fetch_add(1, std::memory_order_relaxed);
    return fresh;
  }
  [[nodiscard]] const std::string& authority() const { return options_.address.text; }

 private:
  link::Loop& loop_;
  link::LinkOptions options_;
  Shared& shared_;
  std::weak_ptr<link::Http2Link> link_;
};

}  // namespace uplink::synthetic
