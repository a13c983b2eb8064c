#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "server/session/forward_source.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::session {

/// Gives one stream what a test offers, and notes who receives.
class ScriptedForwards final : public ForwardSource {
 public:
  std::unique_ptr<ForwardReceiver> Join(const model::RobotId& robot,
                                        loop::StreamRef stream) override {
    joined.push_back(robot.fleet + " " + robot.ruri);
    stream_ = stream;
    ++receiving;
    return std::make_unique<Receiver>(*this);
  }
  /// One more command of this origin is due.
  void Offer(const std::string& origin) {
    v1::RelayResponse frame;
    frame.mutable_forward()->set_kind(v1::FORWARD_KIND_COMMAND);
    frame.mutable_forward()->set_origin_ruri(origin);
    offered.push_back(std::make_shared<const std::string>(frame.SerializeAsString()));
    stream_.Wake();
  }

  /// Fleet and robot of every stream that came to receive.
  std::vector<std::string> joined;
  int receiving = 0;
  /// What was not taken yet.
  std::vector<EncodedFrame> offered;
  /// Frames that one Take gives.
  std::size_t at_once = 16;

 private:
  class Receiver final : public ForwardReceiver {
   public:
    explicit Receiver(ScriptedForwards& forwards) : forwards_(forwards) {}
    ~Receiver() override { --forwards_.receiving; }
    Receiver(const Receiver&) = delete;
    Receiver& operator=(const Receiver&) = delete;

    void Take(std::vector<EncodedFrame>& into) override {
      while (!forwards_.offered.empty() && into.size() < forwards_.at_once) {
        into.push_back(forwards_.offered.front());
        forwards_.offered.erase(forwards_.offered.begin());
      }
    }

   private:
    ScriptedForwards& forwards_;
  };

  loop::StreamRef stream_;
};

}  // namespace uplink::session
