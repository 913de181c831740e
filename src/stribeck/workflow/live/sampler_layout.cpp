#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/io/units.hpp>
#include <stribeck/workflow/live/sampler_stream.hpp>
#include <stribeck/workflow/log/names/column_words.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::workflow {
namespace {

bool is_length(const std::string& unit) {
  try {
    static_cast<void>(io::conversion(unit, "m"));
    return !unit.empty();
  } catch (const std::exception&) {
    return false;
  }
}

/// Metres of a unit of the channel; the machine's length unit is not guessed.
double metres(const LiveChannel& c, const std::string& option) {
  if (is_length(c.unit)) return io::conversion(c.unit, "m")(1.0);
  refuse_option(
      option, fmt::format("column {} is a position of an axis and has {}, expected a length, e.g. \"{} mm\"",
                          io::in_quotes(c.name),
                          c.unit.empty() ? "no unit" : "the unit " + io::in_quotes(c.unit), c.name));
}

std::size_t channel(const std::vector<LiveChannel>& channels, const std::string& name) {
  const auto found =
      std::find_if(channels.begin(), channels.end(), [&](const LiveChannel& c) { return c.name == name; });
  if (found == channels.end()) {
    std::string names;
    for (const LiveChannel& c : channels) names += (names.empty() ? "" : ", ") + c.name;
    refuse_option("--live-axis",
                  fmt::format("got the column {}, expected one of {}", io::in_quotes(name), names));
  }
  return static_cast<std::size_t>(found - channels.begin());
}

struct Pair {
  std::string axis;
  std::size_t commanded;
  std::size_t actual;
};

/// "x=x-cmd,x-fb"
Pair read_pair(const std::string& text, const std::vector<LiveChannel>& channels) {
  const std::size_t equals = text.find('=');
  const std::size_t comma = text.find(',', equals == std::string::npos ? 0 : equals);
  if (equals == std::string::npos || comma == std::string::npos || equals == 0)
    refuse_option("--live-axis", fmt::format("got {}, expected AXIS=COMMANDED,ACTUAL, e.g. x=x-cmd,x-fb",
                                             io::in_quotes(text)));
  return {text.substr(0, equals), channel(channels, text.substr(equals + 1, comma - equals - 1)),
          channel(channels, text.substr(comma + 1))};
}

/// The nets of the configuration that `export --to linuxcnc` writes: x-cmd, x-fb.
std::optional<NameMeaning> linuxcnc_net(const std::string& name) {
  for (const auto& [end, what] : {std::pair{std::string_view("-cmd"), LogQuantity::kReference},
                                  std::pair{std::string_view("-fb"), LogQuantity::kPosition}}) {
    if (name.size() > end.size() && name.ends_with(end))
      return NameMeaning{what, 0, lower_case(name.substr(0, name.size() - end.size())), false};
  }
  return {};
}

/// Axes whose commanded and actual position have names that say so.
std::vector<Pair> found_pairs(const std::vector<LiveChannel>& channels) {
  struct Found {
    std::string axis;
    std::size_t at;
    std::size_t rank;
    bool commanded;
  };
  std::vector<Found> all;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    auto meaning = linuxcnc_net(channels[i].name);
    if (!meaning) meaning = meaning_of(channels[i].name, channels[i].unit);
    if (!meaning || meaning->axis.empty() || !is_length(channels[i].unit)) continue;
    if (meaning->what == LogQuantity::kReference || meaning->what == LogQuantity::kPosition)
      all.push_back({meaning->axis, i, meaning->rank, meaning->what == LogQuantity::kReference});
  }
  std::vector<Pair> pairs;
  for (const Found& r : all) {
    const bool known =
        std::any_of(pairs.begin(), pairs.end(), [&](const Pair& p) { return p.axis == r.axis; });
    if (!r.commanded || known) continue;
    const Found* best = nullptr;
    for (const Found& x : all) {
      if (!x.commanded && x.axis == r.axis && (best == nullptr || x.rank < best->rank)) best = &x;
    }
    if (best != nullptr) pairs.push_back({r.axis, r.at, best->at});
  }
  return pairs;
}

}  // namespace

SamplerLayout sampler_layout(const SamplerOptions& o) {
  io::SideFileData side;
  if (!o.side_file.empty()) side = io::read_side_file(o.side_file);
  const std::vector<std::string>& names = o.columns.empty() ? side.columns : o.columns;
  if (names.empty())
    refuse_option("--live",
                  "needs the columns of the stream: --live-columns \"x-cmd mm,x-fb mm\", or "
                  "--live-side FILE.toml with columns = [\"x-cmd mm\", …]");
  if (names.size() >= LiveLayout::kMostChannels)
    refuse_option("--live-columns", fmt::format("got {} columns, expected at most {}", names.size(),
                                                LiveLayout::kMostChannels - 1));
  SamplerLayout out;
  out.columns = names.size();
  out.live.source = o.source == "-" ? "standard input" : o.source;
  for (const io::Column& c : io::named_columns(names)) {
    for (const LiveChannel& before : out.live.channels) {
      if (before.name == c.name)
        refuse_option("--live-columns", fmt::format("the name {} is there twice", io::in_quotes(c.name)));
    }
    out.live.channels.push_back({c.name, c.unit_text});
  }
  if (!o.sample_time.empty()) {
    out.live.sample_time =
        option_si("--live-period", o.sample_time, quantity("s", "ms").at_least(1e-5).at_most(10.0));
  } else if (side.sample_time) {
    out.live.sample_time = *side.sample_time;
  } else {
    refuse_option(
        "--live",
        "needs the period of the sampling thread: --live-period \"1 ms\", or sample_time in the side file");
  }
  std::vector<Pair> pairs;
  for (const std::string& text : o.axes) pairs.push_back(read_pair(text, out.live.channels));
  if (pairs.size() > ContourTracker::kMostAxes)
    refuse_option("--live-axis",
                  fmt::format("got {} axes, expected at most {}", pairs.size(), ContourTracker::kMostAxes));
  if (pairs.empty()) pairs = found_pairs(out.live.channels);
  if (pairs.size() > ContourTracker::kMostAxes) pairs.resize(ContourTracker::kMostAxes);
  for (const Pair& p : pairs) {
    out.live.axes.push_back({p.axis, p.commanded, metres(out.live.channels[p.commanded], "--live-columns")});
    out.actual.push_back(p.actual);
    out.actual_to_m.push_back(metres(out.live.channels[p.actual], "--live-columns"));
  }
  if (!pairs.empty()) {
    out.live.error = out.live.channels.size();
    out.live.channels.push_back({"contour_error", "um"});
  }
  out.live.metadata = {{"source", out.live.source},
                       {"sample time", fmt::format("{:.9g} s", out.live.sample_time)}};
  return out;
}

}  // namespace stribeck::workflow
