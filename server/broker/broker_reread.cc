// A broker's reader asks the store anew what it knows of deliveries.
#include <utility>

#include "server/broker/broker.h"

namespace uplink::broker {

void Broker::Reread() {
  if (!began_ || draining_) return;
  commits_.BeginReread();
  if (!std::exchange(rereads_, true)) context_.post([this] { StopClient(Connection::kDurable); });
  if (lease_ != nullptr) lease_->RereadSoon(++reread_asked_);
}

void Broker::GoOn(Remembered remembered) {
  // What was read before it was asked for last may lack what was committed since.
  if (!rereads_ || remembered.asked != reread_asked_) return;
  rereads_ = false;
  if (!began_ || draining_) return;
  StopClient(Connection::kDurable);
  commits_.Reread(remembered.memory);
  streams_.SetFaults(std::move(remembered.faults));
  Start(Connection::kDurable, true);
}

}  // namespace uplink::broker
