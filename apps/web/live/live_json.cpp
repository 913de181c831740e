#include <fmt/format.h>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include <apps/web/live/live_json.hpp>

namespace stribeck::web {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostBins = 500;  // of an event
constexpr int kStateEvery = 5;          // pieces, each a tenth of a second

std::string dumped(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

Json finite(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

Json layout_json(const workflow::LiveStream& stream) {
  const workflow::LiveLayout& l = stream.layout();
  Json out{{"source", l.source},
           {"sample_time_ms", l.sample_time * 1e3},
           {"bin_ms", stream.bin_time() * 1e3},
           {"channels", Json::array()},
           {"axes", Json::array()}};
  for (const workflow::LiveChannel& c : l.channels)
    out["channels"].push_back({{"name", c.name}, {"unit", c.unit}});
  for (const workflow::LiveAxis& a : l.axes) out["axes"].push_back(a.name);
  out["error"] = l.error ? Json(*l.error) : Json(nullptr);
  return out;
}

Json drift_json(const workflow::LiveLayout& layout, const std::vector<control::Drift>& drift) {
  Json out = Json::array();
  for (std::size_t i = 0; i < drift.size(); ++i) {
    const control::Drift& d = drift[i];
    // An axis that does not adapt has no entry: then nobody knows whose this is.
    const bool known = drift.size() == layout.axes.size();
    out.push_back({{"axis", known ? Json(layout.axes[i].name) : Json(nullptr)},
                   {"level_percent", finite(100.0 * d.level)},
                   {"level_deviation_percent", finite(100.0 * d.level_deviation)},
                   {"viscous_percent", finite(100.0 * d.viscous)},
                   {"trend_percent_per_hour", finite(100.0 * 3600.0 * d.trend)},
                   {"verdict", std::string(control::describe(d.verdict))}});
  }
  return out;
}

/// Channel by channel; six digits are more than a screen shows.
void add_values(std::string& text, const char* key, const std::vector<float>& values, std::size_t channels) {
  text += fmt::format(",\"{}\":[", key);
  for (std::size_t c = 0; c < channels; ++c) {
    text += c == 0 ? "[" : ",[";
    for (std::size_t i = c; i < values.size(); i += channels) {
      if (i != c) text += ',';
      if (std::isfinite(values[i])) {
        fmt::format_to(std::back_inserter(text), "{:.6g}", values[i]);
      } else {
        text += "null";
      }
    }
    text += ']';
  }
  text += ']';
}

}  // namespace

Json state_json(const workflow::LiveStream& stream) {
  const workflow::LiveState s = stream.state();
  Json out{{"rows", s.rows},
           {"t_s", s.t},
           {"lost", s.lost},
           {"overruns", s.overruns},
           {"restarts", s.restarts},
           {"refused", s.refused},
           {"last_refused", s.last_refused},
           {"slipped_s", s.slipped},
           {"ended", s.ended},
           {"why", s.why},
           {"recording", s.recording},
           {"recorded_rows", s.recorded_rows},
           {"recorded_bytes", s.recorded_bytes},
           {"recording_stopped", s.recording_stopped},
           {"most_bytes", workflow::LiveRecording::kMostBytes},
           {"drift", drift_json(stream.layout(), s.drift)},
           {"out", Json::array()}};
  for (const auto& sink : stream.sinks())
    out["out"].push_back({{"where", sink->in_words()}, {"left_out", sink->left_out()}});
  return out;
}

std::string LiveReader::next(std::uint64_t id, const std::shared_ptr<const workflow::LiveStream>& stream) {
  ++quiet_;
  const bool fresh = !begun_ || id != id_;
  std::string text = fmt::format("data: {{\"id\":{}", id);
  if (!stream) {
    if (!fresh && quiet_ < 4 * kStateEvery) return {};
    begun_ = true;
    id_ = id;
    quiet_ = 0;
    return text + ",\"state\":null}\n\n";
  }
  if (fresh) {
    begun_ = true;
    id_ = id;
    bin_ = stream->bins(0, 0).first;
    glitch_ = 0;
    quiet_ = kStateEvery;
    text += ",\"layout\":" + dumped(layout_json(*stream));
  }
  const workflow::LiveBins bins = stream->bins(bin_, kMostBins);
  bin_ = bins.first + bins.t.size();
  std::uint64_t first = 0;
  const auto glitches = stream->glitches(glitch_, first);
  glitch_ = first + glitches.size();
  const bool with_state = quiet_ >= kStateEvery;
  if (bins.t.empty() && glitches.empty() && !with_state) return {};
  if (!bins.t.empty()) {
    text += fmt::format(",\"first\":{},\"missed\":{},\"t\":[", bins.first, bins.missed);
    for (std::size_t i = 0; i < bins.t.size(); ++i)
      fmt::format_to(std::back_inserter(text), "{}{:.9g}", i == 0 ? "" : ",", bins.t[i]);
    text += ']';
    const std::size_t channels = stream->layout().channels.size();
    add_values(text, "low", bins.low, channels);
    add_values(text, "high", bins.high, channels);
  }
  if (!glitches.empty()) {
    Json list = Json::array();
    for (const workflow::QuadrantGlitch& p : glitches) {
      list.push_back({{"t_s", p.t},
                      {"axis", stream->layout().axes[p.axis].name},
                      {"to", p.to_positive ? "+" : "-"},
                      {"glitch_um", p.error_um}});
    }
    text += ",\"glitches\":" + dumped(list);
  }
  if (with_state) {
    quiet_ = 0;
    text += ",\"state\":" + dumped(state_json(*stream));
  }
  return text + "}\n\n";
}

}  // namespace stribeck::web
