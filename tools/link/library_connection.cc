#include "tools/link/library_connection.h"

#include <condition_variable>
#include <deque>
#include <mutex>
#include <utility>

#include <boost/asio/post.hpp>
#include <grpcpp/client_context.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>
#include <grpcpp/support/channel_arguments.h>
#include <grpcpp/support/client_callback.h>

#include "schema/base/check.h"
#include "uplink/v1/relay.grpc.pb.h"

namespace uplink::link {
namespace {

constexpr const char* kMethod = "/uplink.v1.UplinkRelay/Relay";

}  // namespace

struct LibraryConnection::Channel {
  explicit Channel(const DialOptions& options) {
    grpc::ChannelArguments arguments;
    // A connection of its own, also beside others to the same server.
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
    stub = v1::UplinkRelay::NewStub(grpc::CreateCustomChannel(
        options.target, grpc::SslCredentials({options.server_ca, options.key, options.certificate}),
        arguments));
  }

  std::unique_ptr<v1::UplinkRelay::Stub> stub;
};

/// One stream. The library tells of it on threads of its own, which post to the loop.
class LibraryConnection::Call final
    : private grpc::ClientBidiReactor<v1::RelayRequest, v1::RelayResponse> {
 public:
  Call(LibraryConnection& owner, v1::UplinkRelay::Stub& stub)
      : loop_(owner.loop_), owner_(owner.self_), paused_(owner.paused_) {
    stub.async()->Relay(&context_, this);
    // The library may not let go while the loop may still begin something: until Release.
    AddHold();
    ReadOn();
    StartCall();
  }

  ~Call() override {
    context_.TryCancel();
    Release();
    std::unique_lock lock(mutex_);
    gone_.wait(lock, [this] { return done_; });
  }

  void Send(std::string_view message) {
    v1::RelayRequest frame;
    UPLINK_CHECK(frame.ParseFromArray(message.data(), static_cast<int>(message.size())),
                 "the agent sends frames of its own");
    unsent_ += message.size();
    waiting_.emplace_back(std::move(frame), message.size());
    Write();
  }

  void HalfClose() {
    half_closed_ = true;
    Write();
  }

  void Cancel() {
    context_.TryCancel();
    // No read is under way that would tell the end.
    if (!reading_) Release();
  }

  void PauseReading(bool pause) {
    paused_ = pause;
    ReadOn();
  }

  void Freeze() { paused_ = frozen_ = true; }

  [[nodiscard]] std::size_t unsent() const { return unsent_; }

 private:
  /// On the loop, while the connection is there.
  template <typename Job>
  void Post(Job job) {
    boost::asio::post(loop_.io, [owner = owner_, job = std::move(job)] {
      if (LibraryConnection* const connection = *owner) job(*connection);
    });
  }

  void OnReadDone(bool ok) override {
    Post([this, ok, message = ok ? response_.SerializeAsString() : std::string()](
             LibraryConnection& connection) {
      reading_ = false;
      if (!ok) return Release();
      // The receiver of the message may drop the connection.
      const auto owner = owner_;
      connection.OnMessage(message);
      if (*owner != nullptr && connection.call_.get() == this) ReadOn();
    });
  }

  void OnWriteDone(bool ok) override {
    Post([this, ok](LibraryConnection& connection) {
      writing_ = false;
      if (waiting_.empty()) return;
      unsent_ -= waiting_.front().second;
      waiting_.pop_front();
      if (!ok) return;
      Write();
      if (waiting_.empty()) connection.OnWritten();
    });
  }

  void OnDone(const grpc::Status& status) override {
    Post([end = StreamEnd{static_cast<int>(status.error_code()), status.error_message()}](
             LibraryConnection& connection) { connection.OnEnded(end); });
    // With the lock: the call may be gone as soon as it is free.
    const std::scoped_lock lock(mutex_);
    done_ = true;
    gone_.notify_all();
  }

  void ReadOn() {
    if (paused_ || reading_ || released_) return;
    reading_ = true;
    StartRead(&response_);
  }

  void Write() {
    if (writing_ || released_ || frozen_) return;
    if (!waiting_.empty()) {
      writing_ = true;
      StartWrite(&waiting_.front().first);
    } else if (half_closed_ && !std::exchange(closed_, true)) {
      StartWritesDone();
    }
  }

  void Release() {
    if (!std::exchange(released_, true)) RemoveHold();
  }

  Loop& loop_;
  const std::shared_ptr<LibraryConnection*> owner_;
  grpc::ClientContext context_;
  v1::RelayResponse response_;
  /// Frames that wait, with their bytes; the first is being written.
  std::deque<std::pair<v1::RelayRequest, std::size_t>> waiting_;
  std::size_t unsent_ = 0;
  bool reading_ = false;
  bool writing_ = false;
  bool paused_ = false;
  bool frozen_ = false;
  bool half_closed_ = false;
  bool closed_ = false;
  /// Nothing may be begun any more.
  bool released_ = false;

  std::mutex mutex_;
  std::condition_variable gone_;
  bool done_ = false;
};

LibraryConnection::LibraryConnection(Loop& loop, const DialOptions& options, StreamEvents& events)
    : loop_(loop), events_(&events), channel_(std::make_unique<Channel>(options)) {}

LibraryConnection::~LibraryConnection() { *self_ = nullptr; }

void LibraryConnection::Connect() {
  boost::asio::post(loop_.io, [owner = self_] {
    if (LibraryConnection* const connection = *owner) connection->events_->OnConnected();
  });
}

bool LibraryConnection::OpenStream(const std::string& path) {
  if (path != kMethod || !usable()) return false;
  call_ = std::make_unique<Call>(*this, *channel_->stub);
  return true;
}

void LibraryConnection::Send(std::string_view message) {
  if (call_ != nullptr) call_->Send(message);
}

void LibraryConnection::HalfClose() {
  if (call_ != nullptr) call_->HalfClose();
}

void LibraryConnection::CancelStream() {
  if (call_ != nullptr) call_->Cancel();
}

std::size_t LibraryConnection::unsent() const { return call_ == nullptr ? 0 : call_->unsent(); }

void LibraryConnection::PauseReading(bool pause) {
  if (silent_) return;
  paused_ = pause;
  if (call_ != nullptr) call_->PauseReading(pause);
}

void LibraryConnection::Freeze() {
  silent_ = true;
  if (call_ != nullptr) call_->Freeze();
}

void LibraryConnection::Cut() {
  silent_ = true;
  usable_ = false;
  if (call_ != nullptr) call_->Cancel();
}

void LibraryConnection::OnMessage(std::string_view message) {
  if (!silent_) events_->OnMessage(message);
}

void LibraryConnection::OnWritten() {
  if (!silent_) events_->OnSent();
}

void LibraryConnection::OnEnded(const StreamEnd& end) {
  call_.reset();
  if (end.code == kCodeUnavailable) usable_ = false;
  if (!silent_) events_->OnEnded(end);
}

}  // namespace uplink::link
