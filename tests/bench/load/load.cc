#include "tests/bench/load/load.h"

#include <algorithm>
#include <deque>
#include <utility>

#include "schema/base/check.h"
#include "tests/bench/load/relay_client.h"
#include "tests/bench/load/robots.h"

namespace uplink::bench {
namespace {

constexpr milliseconds kLook{20};
constexpr milliseconds kPatience = std::chrono::minutes(2);
constexpr milliseconds kLate{100};
/// Less than a live ack waits for.
constexpr std::uint64_t kUnackedMax = 64;
constexpr std::size_t kUnsentMax = 64 * 1024;

}  // namespace

Load::~Load() {
  clients_.clear();
  gateways_.clear();
  loop_.io.restart();
  loop_.io.poll();
}

std::unique_ptr<Client> Load::NewThroughGateway(std::size_t number) {
  const std::size_t place = number % where_.gateways.size();
  if (place == gateways_.size()) {
    link::LinkOptions options = where_.link;
    options.identity = where_.gateways[place];
    gateways_.push_back(std::make_shared<link::Http2Link>(loop_, std::move(options),
                                                          link::Http2Link::For::kSeveral));
  }
  return std::make_unique<RelayClient>(gateways_[place], where_.link.address.text,
                                       BenchRuri(number), where_.style(number));
}

std::unique_ptr<Client> Load::NewClient(std::size_t number) {
  if (where_.connect) return where_.connect(number);
  if (!where_.gateways.empty()) return NewThroughGateway(number);
  link::LinkOptions options = where_.link;
  options.identity = where_.identities->at(number);
  return Connect(where_.protocol, loop_, std::move(options), where_.style(number));
}

void Load::RunFor(milliseconds duration) {
  loop_.io.restart();
  const SteadyTime end = clock_.Steady() + duration;
  while (clock_.Steady() < end) {
    // Without a connection or a timer there is nothing to run, and it returns at once.
    if (loop_.io.run_until(end) == 0) loop_.io.restart();
  }
}

void Load::CheckNoneFailed(std::size_t from) const {
  for (std::size_t i = from; i < clients_.size(); ++i) {
    UPLINK_CHECK(!clients_[i]->failed(), "a robot was refused or cut: " + clients_[i]->error());
  }
}

void Load::ConnectUpTo(std::size_t robots, std::size_t at_once) {
  const SteadyTime end = clock_.Steady() + kPatience;
  std::size_t ready = clients_.size();
  while (ready < robots) {
    UPLINK_CHECK(clock_.Steady() < end, "the server welcomes all robots within two minutes");
    while (clients_.size() < robots && clients_.size() - ready < at_once) {
      clients_.push_back(NewClient(clients_.size()));
    }
    loop_.io.restart();
    loop_.io.run_one_for(kLook);
    loop_.io.poll();
    while (ready < clients_.size() && clients_[ready]->ready()) ++ready;
    CheckNoneFailed(ready);
  }
}

bool Load::ConnectAgain(std::size_t at_once, milliseconds patience) {
  const SteadyTime end = clock_.Steady() + patience;
  std::deque<std::size_t> away;
  for (std::size_t i = 0; i < clients_.size(); ++i) away.push_back(i);
  clients_.clear();
  clients_.resize(away.size());
  std::vector<std::size_t> on_their_way;
  std::size_t ready = 0;
  while (ready < clients_.size()) {
    if (clock_.Steady() > end) return false;
    while (!away.empty() && on_their_way.size() < at_once) {
      clients_[away.front()] = NewClient(away.front());
      on_their_way.push_back(away.front());
      away.pop_front();
    }
    loop_.io.restart();
    loop_.io.run_one_for(kLook);
    loop_.io.poll();
    std::erase_if(on_their_way, [&](std::size_t number) {
      if (clients_[number]->failed()) away.push_back(number);
      if (clients_[number]->ready()) ++ready;
      return clients_[number]->failed() || clients_[number]->ready();
    });
  }
  return true;
}

void Load::SendEach(std::size_t messages) {
  for (std::size_t i = 0; i < messages; ++i) {
    for (const auto& client : clients_) client->Send(1);
    loop_.io.restart();
    loop_.io.poll();
  }
  const SteadyTime end = clock_.Steady() + kPatience;
  while (sent() - acked() >= kUnackedMax * clients_.size()) {
    UPLINK_CHECK(clock_.Steady() < end, "the server acks");
    RunFor(kLook);
  }
}

void Load::SendOneAndAwaitAck() {
  const SteadyTime end = clock_.Steady() + kPatience;
  for (const auto& client : clients_) client->Send(1);
  while (acked() < sent()) {
    UPLINK_CHECK(clock_.Steady() < end, "the server acks");
    CheckNoneFailed();
    loop_.io.restart();
    loop_.io.run_one_for(kLook);
  }
}

void Load::Pace(double frames_per_second, std::size_t frame_messages, milliseconds duration) {
  const SteadyTime start = clock_.Steady();
  const std::chrono::duration<double> gap(1 / frames_per_second);
  std::uint64_t frames = 0;
  bool over = false;
  const auto due = [&] {
    return start + std::chrono::duration_cast<SteadyTime::duration>(gap * frames);
  };
  const std::function<void(const boost::system::error_code&)> send =
      [&](const boost::system::error_code& error) {
        if (error || over) return;
        const SteadyTime now = clock_.Steady();
        for (; due() <= now; ++frames) {
          if (now - due() > kLate) ++late_;
          clients_[next_++ % clients_.size()]->Send(frame_messages);
        }
        timer_.expires_at(due());
        timer_.async_wait(send);
      };
  send({});
  RunFor(duration);
  // A last turn, so that nothing is left that refers to this call.
  over = true;
  timer_.cancel();
  loop_.io.restart();
  loop_.io.poll();
  CheckNoneFailed();
}

void Load::FillUp(Client& client, std::size_t ahead, std::size_t frame_messages) const {
  while (client.ready() && client.sent() - client.acked() + frame_messages <= ahead &&
         client.unsent() < kUnsentMax) {
    client.Send(frame_messages);
  }
}

void Load::Flood(std::size_t ahead, std::size_t frame_messages, milliseconds duration) {
  for (const auto& client : clients_) {
    client->SetOnMoved(
        [this, of = client.get(), ahead, frame_messages] { FillUp(*of, ahead, frame_messages); });
    FillUp(*client, ahead, frame_messages);
  }
  RunFor(duration);
  for (const auto& client : clients_) client->SetOnMoved({});
  CheckNoneFailed();
}

std::uint64_t Load::sent() const {
  std::uint64_t sum = 0;
  for (const auto& client : clients_) sum += client->sent();
  return sum;
}

std::uint64_t Load::acked() const {
  std::uint64_t sum = 0;
  for (const auto& client : clients_) sum += client->acked();
  return sum;
}

}  // namespace uplink::bench
