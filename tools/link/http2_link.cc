#include "tools/link/http2_link.h"

#include <algorithm>
#include <utility>

#include <boost/asio/post.hpp>

namespace uplink::link {

Http2Link::Http2Link(Loop& loop, LinkOptions options, For users)
    : loop_(loop),
      for_(users),
      record_per_message_(options.record_per_message),
      http2_({.bytes = options.window_bytes,
              .renewed = options.window_renewed,
              .by_stream = users == For::kSeveral}),
      link_(std::make_shared<TlsLink>(loop, std::move(options), static_cast<LinkEvents&>(*this))) {}

Http2Link::~Http2Link() { link_->Close(); }

void Http2Link::Leave(LinkUser& user) {
  users_.erase(&user);
  std::erase(touched_, &user);
}

void Http2Link::Connect() {
  if (!std::exchange(connecting_, true)) return link_->Connect();
  if (!up_) return;
  // A user that joins a connected link gets OnUp like the first.
  boost::asio::post(loop_.io, [weak = std::weak_ptr(self_)] {
    if (const auto self = weak.lock()) (*self)->TellAll([](LinkUser& user) { user.OnUp(); });
  });
}

void Http2Link::Touch(LinkUser& user) {
  if (std::ranges::find(touched_, &user) == touched_.end()) touched_.push_back(&user);
}

template <typename Tell>
void Http2Link::TellAll(const Tell& tell) {
  // Users come and go meanwhile, and with the last this.
  const std::weak_ptr<Http2Link*> weak(self_);
  const std::vector<LinkUser*> users(users_.begin(), users_.end());
  for (LinkUser* const user : users) {
    if (weak.expired()) return;
    if (users_.contains(user)) tell(*user);
  }
}

void Http2Link::OnUp() {
  up_ = true;
  Flush();
  TellAll([](LinkUser& user) { user.OnUp(); });
}

void Http2Link::OnBytes(std::string_view bytes) {
  busy_ = true;
  const bool good = http2_.Receive(bytes);
  busy_ = false;
  if (!good) {
    link_->Close();
    return OnDown(absl::UnavailableError("the server's bytes are not HTTP/2"));
  }
  receiving_ = true;
  Produce();
  receiving_ = false;
  const std::weak_ptr<Http2Link*> weak(self_);
  while (!weak.expired() && !touched_.empty()) {
    LinkUser& user = *touched_.front();
    touched_.erase(touched_.begin());
    user.AfterBytes();
  }
}

void Http2Link::OnSent() {
  TellAll([](LinkUser& user) { user.OnSent(); });
}

void Http2Link::OnDown(const absl::Status& why) {
  down_ = true;
  TellAll([&why](LinkUser& user) { user.OnDown(why); });
}

void Http2Link::TellDownLater(const LinkUser& but) {
  if (users_.size() <= 1) return;
  boost::asio::post(loop_.io, [weak = std::weak_ptr(self_), &but] {
    const auto self = weak.lock();
    if (self == nullptr) return;
    (*self)->TellAll([&but](LinkUser& user) {
      if (&user != &but) user.OnDown(absl::UnavailableError("the connection was cut"));
    });
  });
}

void Http2Link::Freeze(const LinkUser& by) {
  down_ = true;
  link_->Freeze();
  TellDownLater(by);
}

void Http2Link::Cut(const LinkUser& by) {
  down_ = true;
  link_->Cut();
  TellDownLater(by);
}

void Http2Link::Flush() {
  if (busy_ || !up_ || down_) return;
  Produce();
  if (receiving_) return;
  for (LinkUser* const user : std::exchange(touched_, {})) user->Soon();
}

void Http2Link::Produce() {
  if (busy_ || !up_ || down_) return;
  busy_ = true;
  loop_.out.clear();
  while (record_per_message_ && http2_.ProduceFrame(loop_.out)) {
    link_->Write(loop_.out);
    loop_.out.clear();
  }
  http2_.Produce(loop_.out);
  busy_ = false;
  if (!loop_.out.empty()) link_->Write(loop_.out);
}

}  // namespace uplink::link
