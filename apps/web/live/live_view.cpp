#include <nlohmann/json.hpp>

#include <apps/web/live/live_json.hpp>
#include <apps/web/live/live_view.hpp>
#include <stribeck/io/error.hpp>

namespace stribeck::web {

using Json = nlohmann::ordered_json;

struct LiveView::Running {
  std::uint64_t id = 0;
  std::shared_ptr<workflow::LiveStream> stream;
  // Their threads end before the stream does.
  std::unique_ptr<workflow::SimulatedStream> simulated;
  std::unique_ptr<workflow::SamplerStream> sampler;
};

namespace {

[[noreturn]] void refuse_live(const std::string& key, const std::string& what) {
  throw io::InputError({"request", 0, key, what});
}

}  // namespace

LiveView::LiveView(WhatIf& what_if, LiveOptions options) : what_if_(what_if), options_(std::move(options)) {
  if (!options_.sampler) return;
  workflow::SamplerLayout layout = workflow::sampler_layout(*options_.sampler);
  auto one = std::make_shared<Running>();
  one->id = next_++;
  one->stream = std::make_shared<workflow::LiveStream>(layout.live, options_.sinks);
  one->sampler =
      std::make_unique<workflow::SamplerStream>(options_.sampler->source, std::move(layout), one->stream);
  running_ = std::move(one);
}

LiveView::~LiveView() { save_what_runs(); }

void LiveView::save_what_runs() {
  const auto one = running();
  if (!one || !one->stream->state().recording) return;
  try {
    one->stream->save();
  } catch (const std::exception&) {
    // There is nobody left to tell; the hidden file is removed.
  }
}

std::shared_ptr<LiveView::Running> LiveView::running() const {
  const std::lock_guard lock(mutex_);
  return running_;
}

std::shared_ptr<LiveView::Running> LiveView::some_running() const {
  auto one = running();
  if (!one) refuse_live("live", "nothing runs (start a virtual machine first)");
  return one;
}

Json LiveView::start(const LiveRequest& r, const WhatIf::IsOld& is_old) {
  if (options_.sampler) {
    refuse_live("machine", "this dashboard shows the stream of " + options_.sampler->source +
                               " (start another one without --live for a virtual machine)");
  }
  if (const auto before = running(); before && before->stream->state().recording)
    refuse_live("machine", "a recording runs (save or discard it first)");
  WhatIfRequest request;
  request.machine = r.machine;
  request.motion = r.motion;
  request.size = r.size;
  request.speed = r.speed;
  request.controllers = {r.controller};
  request.seed = r.seed;
  if (r.friction != 1.0) request.changes = {{"*.friction.coulomb", r.friction, {}}};
  auto [run, words] = what_if_.endless(request, is_old);
  auto one = std::make_shared<Running>();
  one->stream = std::make_shared<workflow::LiveStream>(workflow::layout_of(*run, "virtual machine: " + words),
                                                       options_.sinks);
  // Taken away under the lock, by start() or by stop(); its thread ends behind it.
  std::unique_ptr<workflow::SimulatedStream> before;
  {
    const std::lock_guard lock(mutex_);
    if (running_ && running_->stream->state().recording)
      refuse_live("machine", "a recording runs (save or discard it first)");
    one->id = next_++;
    one->simulated = std::make_unique<workflow::SimulatedStream>(std::move(run), one->stream, r.times);
    if (running_) before = std::move(running_->simulated);
    running_ = one;
  }
  before.reset();
  return state();
}

Json LiveView::stop() {
  const auto one = some_running();
  if (one->sampler) refuse_live("live", "the stream of a machine is not stopped here");
  std::unique_ptr<workflow::SimulatedStream> simulated;
  {
    const std::lock_guard lock(mutex_);
    simulated = std::move(one->simulated);
  }
  simulated.reset();
  one->stream->end("stopped");
  return state_json(*one->stream);
}

Json LiveView::record() {
  const auto one = some_running();
  one->stream->record(options_.folder);
  return state_json(*one->stream);
}

Json LiveView::save() {
  const auto one = some_running();
  const std::uint64_t rows = one->stream->state().recorded_rows;
  const std::filesystem::path file = one->stream->save();
  const std::lock_guard lock(mutex_);
  saved_ = file;
  return {{"file", file.filename().string()}, {"rows", rows}};
}

Json LiveView::discard() {
  const auto one = some_running();
  one->stream->discard();
  return state_json(*one->stream);
}

std::filesystem::path LiveView::saved() const {
  const std::lock_guard lock(mutex_);
  if (saved_.empty()) refuse_live("live", "nothing was saved yet");
  return saved_;
}

Json LiveView::state() const {
  const auto one = running();
  if (!one) return {{"id", 0}, {"state", nullptr}, {"sampler", options_.sampler.has_value()}};
  return {{"id", one->id}, {"state", state_json(*one->stream)}, {"sampler", options_.sampler.has_value()}};
}

Response LiveView::events() {
  // Counts the page as long as the server keeps the answer.
  const std::shared_ptr<void> place(nullptr, [pages = pages_](void*) { --*pages; });
  if (++*pages_ > kMostPages)
    return error_response(503, "eight pages look at the stream already (close one)");
  Response out;
  out.type = "text/event-stream";
  out.next = [this, place, reader = LiveReader()]() mutable -> std::optional<std::string> {
    const auto one = running();
    return reader.next(one ? one->id : 0, one ? one->stream : nullptr);
  };
  return out;
}

}  // namespace stribeck::web
