#pragma once

#include <memory>
#include <vector>

#include <grpcpp/grpcpp.h>

#include "tests/bench/sink_tag.h"
#include "uncrew/v1/avatar.grpc.pb.h"

namespace uplink::bench {

/// AvatarService as the gRPC library serves it: each request is parsed into its message, and
/// answered APPLIED. Outlives the server.
///
/// Thread: confined to that of the completion queue, whose tags are SinkTag.
class SinkCalls final {
 public:
  explicit SinkCalls(grpc::ServerBuilder& builder) { builder.RegisterService(&service_); }
  /// Once the server has started: calls are taken from now on.
  void Await(grpc::ServerCompletionQueue& queue);

 private:
  ::uncrew::v1::AvatarService::AsyncService service_;
  /// Each serves one call after the other.
  std::vector<std::unique_ptr<SinkTag>> calls_;
};

}  // namespace uplink::bench
