#include "tests/bench/avatar/sink_calls.h"

#include <optional>
#include <utility>

#include "schema/model/uncrew/types.h"

namespace uplink::bench {
namespace {

namespace avatar = ::uncrew::v1;
using Service = avatar::AvatarService::AsyncService;
using Responder = grpc::ServerAsyncResponseWriter<avatar::PublishResponse>;

/// Calls of one type that the library may take before the sink has answered the first.
constexpr int kCallsPerType = 16;

/// A call of one type, and then the next one in the same place.
template <typename Request>
class SinkCall final : public SinkTag {
 public:
  /// The service's way to ask for the next call of the type.
  using Ask = void (Service::*)(grpc::ServerContext*, Request*, Responder*, grpc::CompletionQueue*,
                                grpc::ServerCompletionQueue*, void*);

  SinkCall(Service& service, Ask ask, grpc::ServerCompletionQueue& queue)
      : service_(service), ask_(ask), queue_(queue) {
    Await();
  }

  void Proceed(bool ok) override {
    if (answering_) return Await();
    if (!ok) return;
    answering_ = true;
    avatar::PublishResponse answer;
    answer.set_outcome(avatar::OUTCOME_APPLIED);
    responder_->Finish(answer, grpc::Status::OK, tag());
  }

 private:
  void Await() {
    answering_ = false;
    responder_.reset();
    context_.emplace();
    responder_.emplace(&*context_);
    (service_.*ask_)(&*context_, &request_, &*responder_, &queue_, &queue_, tag());
  }

  Service& service_;
  const Ask ask_;
  grpc::ServerCompletionQueue& queue_;
  std::optional<grpc::ServerContext> context_;
  std::optional<Responder> responder_;
  Request request_;
  bool answering_ = false;
};

}  // namespace

void SinkCalls::Await(grpc::ServerCompletionQueue& queue) {
  for (int i = 0; i < kCallsPerType; ++i) {
#define UPLINK_TYPE(Type, Method, member, name, kind, parts_max)        \
  calls_.push_back(std::make_unique<SinkCall<avatar::Method##Request>>( \
      service_, &Service::Request##Method, queue));
    UPLINK_UNCREW_TYPES(UPLINK_TYPE)
#undef UPLINK_TYPE
  }
}

}  // namespace uplink::bench
