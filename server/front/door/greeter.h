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

/// How long a load balancer may take for its header. It is looked at once a second.
inline constexpr std::chrono::seconds kProxyHeaderWait{5};

/// Asks each connection where it really comes from, before the door: from a load balancer a PROXY
/// header is required, and its address stands for the peer's from then on. From others nothing is
/// read.
///
/// A load balancer that connects and leaves without a byte, or says that it came on its own account
/// (LOCAL), looks whether we answer: that is neither counted nor logged. A header that is wrong, or
/// does not come in time, is both, with the address of the load balancer.
/// Limits: kProxyHeaderWait; Setup::waiting_max, past which the one that came first goes.
/// Thread: confined to the acceptor's, whose context it waits with; made and destroyed while that
///         does not run.
class Greeter final {
 public:
  struct Setup {
    /// listen.proxy_protocol_from.
    std::vector<config::Network> load_balancers;
    /// Connections whose header is not whole.
    std::size_t waiting_max = 0;
    /// Takes whose origin is known.
    std::function<void(Visitor visitor)> hand;
  };

  Greeter(boost::asio::io_context& context, DoorBook& book, transport::RelayProbe& probe,
          const Clock& clock, Setup setup);
  /// Closes what waits.
  ~Greeter();
  Greeter(const Greeter&) = delete;
  Greeter& operator=(const Greeter&) = delete;

  void Arrive(Accepted accepted);
  /// A second has passed: those that took too long go.
  void Tick();
  [[nodiscard]] std::size_t waiting() const { return waiting_.size(); }

 private:
  /// Whose header is not whole.
  struct Guest {
    Guest(boost::asio::io_context& context, Descriptor its_descriptor, Origin load_balancer,
          SteadyTime until);
    ~Guest();
    Guest(const Guest&) = delete;
    Guest& operator=(const Guest&) = delete;

    Descriptor descriptor;
    /// Of that descriptor, once it had to be waited for.
    boost::asio::posix::stream_descriptor watch;
    Origin origin;
    ProxyHeader header;
    SteadyTime by;
  };

  /// Reads what is there of its header, and lets it go or waits for more.
  void Serve(std::uint64_t id, Guest& guest);
  void Wait(std::uint64_t id, Guest& guest);
  void OnReadable(std::uint64_t id);
  /// False if the peer has ended.
  [[nodiscard]] static bool Read(Guest& guest);
  /// The header is whole.
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
