#include "server/uncrew/unproven_answers.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <utility>

namespace uplink::uncrew {

TicketRef UnprovenAnswers::Add() {
  if (next_ == nullptr) next_ = std::make_shared<Ticket>();
  TicketRef ticket = next_;
  if (!asked_) Ask();
  return ticket;
}

void UnprovenAnswers::Ask() {
  asked_ = true;
  covered_ = std::exchange(next_, nullptr);
  journal_.WhenCommitted({.inbox = this, .stream = 0});
}

void UnprovenAnswers::Wake(std::uint64_t /*stream*/) {
  std::vector<loop::StreamRef> wake;
  {
    const std::lock_guard lock(owners_);
    asked_ = false;
    if (const TicketRef proven = std::exchange(covered_, nullptr)) {
      proven->state = Ticket::State::kCommitted;
      wake = proven->callers;
    }
    if (next_ != nullptr) Ask();
  }
  for (const loop::StreamRef& caller : wake) caller.Wake();
}

std::vector<loop::StreamRef> UnprovenAnswers::VoidAll() {
  std::vector<loop::StreamRef> wake;
  for (TicketRef* const held : {&covered_, &next_}) {
    const TicketRef ticket = std::exchange(*held, nullptr);
    if (ticket == nullptr) continue;
    ticket->state = Ticket::State::kVoid;
    std::ranges::copy(ticket->callers, std::back_inserter(wake));
  }
  return wake;
}

}  // namespace uplink::uncrew
