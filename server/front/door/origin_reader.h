#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>

#include "schema/base/clock.h"
#include "server/config/networks.h"
#include "server/front/door/acceptor.h"
#include "server/front/door/door.h"
#include "server/front/door/door_book.h"
#include "server/front/door/proxy_header.h"
#include "server/transport/probe.h"

namespace uplink::front {

/// How long a load balancer may take for its header; checked once a second.
inline constexpr std::chrono::seconds kProxyHeaderWait{5};

/// Finds out where each connection really comes from, before the door. From a load balancer it
/// requires a PROXY header, whose address then stands for the peer's. From others it reads nothing.
///
/// A load balancer that leaves without a byte, or says that it came on its own account (LOCAL),
/// checks whether we answer: that is neither counted nor logged. A wrong or late header is counted,
/// and logged with the load balancer's address.
/// Limits: kProxyHeaderWait; Setup::waiting_max, past which the oldest one goes.
/// Thread: confined to the acceptor's, whose context it waits with. Made and destroyed while that
///         does not run.
class OriginReader final {
 public:
  struct Setup {
    /// listen.proxy_protocol_from.
    std::vector<config::Network> load_balancers;
    /// Connections whose header is incomplete.
    std::size_t waiting_max = 0;
    /// Takes a connection whose origin is known.
    std::function<void(IncomingConnection incoming)> hand;
  };

  OriginReader(boost::asio::io_context& context, DoorBook& book, transport::RelayProbe& probe,
               const Clock& clock, Setup setup);
  /// Closes what waits.
  ~OriginReader();
  OriginReader(const OriginReader&) = delete;
  OriginReader& operator=(const OriginReader&) = delete;

  void Arrive(Accepted accepted);
  /// A second has passed: drops connections that took too long.
  void Tick();
  [[nodiscard]] std::size_t waiting() const { return waiting_.size(); }

 private:
  /// A connection whose header is incomplete.
  struct Guest {
    Guest(boost::asio::io_context& context, Descriptor its_descriptor, Origin load_balancer,
          SteadyTime until);
    ~Guest();
    Guest(const Guest&) = delete;
    Guest& operator=(const Guest&) = delete;

    Descriptor descriptor;
    /// Watches that descriptor, once it had to wait.
    boost::asio::posix::stream_descriptor watch;
    Origin origin;
    ProxyHeader header;
    SteadyTime by;
  };

  /// Reads what has arrived of its header, and hands it on or waits for more.
  void Serve(std::uint64_t id, Guest& guest);
  void Wait(std::uint64_t id, Guest& guest);
  void OnReadable(std::uint64_t id);
  /// False if the peer has ended.
  [[nodiscard]] static bool Read(Guest& guest);
  /// The header is complete.
  void HandOn(Guest& guest, Origin origin);
  void TurnAway(const Guest& guest);
  void Forget(std::uint64_t id);

  boost::asio::io_context& context_;
  DoorBook& book_;
  transport::RelayProbe& probe_;
  const Clock& clock_;
  const Setup setup_;
  std::uint64_t next_id_ = 1;
  /// By number, which is the order in which they came.
  std::map<std::uint64_t, Guest> waiting_;
};

}  // namespace uplink::front
