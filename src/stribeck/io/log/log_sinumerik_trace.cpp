#include <expat.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <map>
#include <memory>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log_formats.hpp>
#include <stribeck/io/log/log_text.hpp>
#include <stribeck/io/units.hpp>
#include <unordered_map>

namespace stribeck::io::detail {

namespace {

struct FreeParser {
  void operator()(XML_ParserStruct* parser) const noexcept { XML_ParserFree(parser); }
};

/// Layout: traceDisplaySetup/signals/signal and traceData/dataFrame with frameHeader, dataSignal and rec.
///
/// Missing values of a rec depend on the signal: one with a slow interval has no sample there, one recorded on change keeps its
/// value. The number of samples stated by dataSignal tells which.
class TraceReader : Reader {
 public:
  TraceReader(std::string_view text, const std::string& source)
      : Reader(text, source, "SINUMERIK trace"), text_(text), parser_(XML_ParserCreate(nullptr)) {}

  Log read() {
    if (parser_ == nullptr) fail(0, "cannot be read: no memory");
    XML_SetUserData(parser_.get(), this);
    XML_SetElementHandler(
        parser_.get(),
        [](void* self, const XML_Char* name, const XML_Char** attributes) {
          static_cast<TraceReader*>(self)->guarded([&](TraceReader& r) { r.start(name, attributes); });
        },
        [](void* self, const XML_Char*) {
          auto& r = *static_cast<TraceReader*>(self);
          if (!r.path_.empty()) r.path_.pop_back();
        });
    // Document types are refused, because their entities can grow without bound.
    XML_SetStartDoctypeDeclHandler(
        parser_.get(), [](void* self, const XML_Char*, const XML_Char*, const XML_Char*, int) {
          static_cast<TraceReader*>(self)->guarded(
              [](TraceReader& r) { r.fail(r.line(), "has a document type, which no trace has"); });
        });
    parse();
    if (frames_ == 0 && ball_bar_) {
      fail(
          0,
          "is a ball-bar file of Renishaw (.b5r): it is known how the results in it are written, but not its "
          "samples, so it is not read (export the samples as a table with angle and radius, or deviation)");
    }
    if (frames_ == 0) {
      fail(
          0,
          "is XML but no SINUMERIK trace with samples, expected traceData/dataFrame with dataSignal and rec");
    }
    build();
    finish();
    return std::move(log_);
  }

 private:
  using Attributes = const XML_Char**;
  struct Channel {
    std::string name;
    std::string description;
    std::string units_type;
    double interval = 0.0;
    std::optional<std::size_t> stated;
    std::vector<double> t;
    std::vector<double> values;
  };
  struct Described {
    std::string name;
    std::string description;
  };

  /// Exceptions must not pass through the parser, which is written in C.
  template <class F>
  void guarded(F&& f) noexcept {
    if (error_) return;
    try {
      f(*this);
    } catch (...) {
      error_ = std::current_exception();
      XML_StopParser(parser_.get(), XML_FALSE);
    }
  }

  void parse() {
    constexpr std::size_t kChunk = 1 << 20;
    for (std::size_t at = 0; at <= text_.size(); at += kChunk) {
      const auto part = text_.substr(at, kChunk);
      const bool last = at + kChunk >= text_.size();
      const auto status = XML_Parse(parser_.get(), part.data(), static_cast<int>(part.size()), last ? 1 : 0);
      if (error_) std::rethrow_exception(error_);
      if (status != XML_STATUS_OK) {
        const auto code = XML_GetErrorCode(parser_.get());
        const bool cut_off = code == XML_ERROR_NO_ELEMENTS || code == XML_ERROR_UNCLOSED_TOKEN || last_byte();
        fail(line(), std::string(cut_off ? "is cut off or damaged: " : "is not valid XML: ") +
                         XML_ErrorString(code) + " (export it again)");
      }
      if (last) break;
    }
  }

  [[nodiscard]] bool last_byte() const {
    return static_cast<std::size_t>(std::max<XML_Index>(0, XML_GetCurrentByteIndex(parser_.get()))) + 1 >=
           text_.size();
  }
  [[nodiscard]] std::size_t line() const {
    return static_cast<std::size_t>(XML_GetCurrentLineNumber(parser_.get()));
  }

  static std::string_view attribute(Attributes attributes, std::string_view name) {
    for (; attributes[0] != nullptr; attributes += 2) {
      if (attributes[0] == name) return attributes[1];
    }
    return {};
  }

  void start(std::string_view name, Attributes attributes) {
    constexpr std::size_t kDeepest = 64;
    if (path_.size() >= kDeepest) fail(line(), "is nested deeper than 64 levels: not a trace");
    // As in files of Ballbar 20: <PLANE TEST_PLANE="XY">, <FEATURE NAME="AF_CIRCULARITY" DT="UT_LENGTH_UM">.
    if ((name == "PLANE" && !attribute(attributes, "TEST_PLANE").empty()) ||
        (name == "FEATURE" && begins_with(attribute(attributes, "DT"), "UT_")))
      ball_bar_ = true;
    const std::string_view parent = path_.empty() ? std::string_view() : path_.back();
    if (parent == "dataFrame") {
      if (frames_ == 1) start_in_frame(name, attributes);
    } else if (name == "dataFrame") {
      if (++frames_ == 2) note("only the first data frame is read, the others are left out");
    } else if (name == "signal" && path_.size() > 1 &&
               begins_with(path_[path_.size() - 2], "traceDisplaySetup")) {
      const std::string key(attribute(attributes, "key"));
      if (described_.size() > kMaxColumns) fail(line(), "has too many signals");
      if (!key.empty()) {
        described_[key] = {std::string(attribute(attributes, "name")),
                           std::string(attribute(attributes, "description"))};
      }
    }
    path_.emplace_back(name);
  }

  void start_in_frame(std::string_view name, Attributes attributes) {
    if (name == "rec") {
      read_rec(attributes);
    } else if (name == "frameHeader") {
      for (const char* key : {"startTime", "stopInc", "dropOuts"}) {
        const auto value = attribute(attributes, key);
        if (!value.empty()) add_metadata(key, value);
      }
      const auto lost = attribute(attributes, "dropOuts");
      if (!lost.empty() && lost != "0") note("the control states " + std::string(lost) + " drop-outs");
    } else if (name == "dataSignal") {
      const std::string id(attribute(attributes, "id"));
      if (id.empty()) fail(line(), "dataSignal without id");
      if (channels_.size() >= kMaxColumns) fail(line(), "has too many signals");
      if (!index_.emplace(id, channels_.size()).second)
        fail(line(), "dataSignal " + in_quotes(id) + " stands twice");
      Channel c;
      const auto found = described_.find(std::string(attribute(attributes, "key")));
      c.name = attribute(attributes, "name");
      c.description = attribute(attributes, "description");
      if (found != described_.end()) {
        if (c.name.empty()) c.name = found->second.name;
        if (c.description.empty()) c.description = found->second.description;
      }
      if (c.name.empty()) c.name = id;
      if (c.description.empty()) c.description = c.name;
      c.units_type = attribute(attributes, "unitsType");
      const auto interval = cell_number(attribute(attributes, "interval"), '.');
      if (interval && std::isfinite(*interval) && *interval > 0.0) c.interval = *interval;
      c.stated = count(attribute(attributes, "datapointCount"));
      channels_.push_back(std::move(c));
    }
  }

  void read_rec(Attributes attributes) {
    ++recs_;
    const auto at = attribute(attributes, "time");
    const auto t = cell_number(at, '.');
    if (!t || !std::isfinite(*t)) {
      fail(line(),
           "rec " + std::to_string(recs_) + ": got time " + in_quotes(at) + ", expected a number of seconds");
    }
    for (; attributes[0] != nullptr; attributes += 2) {
      const std::string_view id = attributes[0];
      if (id == "time") continue;
      const auto found = index_.find(std::string(id));
      if (found == index_.end()) {
        fail(line(),
             "rec " + std::to_string(recs_) + " has " + in_quotes(id) + ", which no dataSignal names");
      }
      const std::string_view text = attributes[1];
      auto value = cell_number(text, '.');
      if (text == "true" || text == "false") value = text == "true" ? 1.0 : 0.0;  // signals of the PLC
      if (!value || !std::isfinite(*value)) {
        fail(line(), "rec " + std::to_string(recs_) + ", signal " + in_quotes(channels_[found->second].name) +
                         ": got " + in_quotes(text) + ", expected a finite number");
      }
      channels_[found->second].t.push_back(*t);
      channels_[found->second].values.push_back(*value);
    }
  }

  /// A signal recorded on change: its stated number of samples covers the time from first to last, its recs do not.
  void fill(Channel& c) {
    const std::size_t there = c.values.size();
    if (!c.stated || *c.stated == there || there < 2) return;
    const double span = c.t.back() - c.t.front();
    // A few bytes can state any number of samples; this limit is an hour of ten signals at 2 ms.
    constexpr std::size_t kMostFilled = 20'000'000;
    const bool fits = c.interval > 0.0 && *c.stated > there && *c.stated <= kMostFilled - filled_ &&
                      std::abs(span / c.interval + 1.0 - static_cast<double>(*c.stated)) < 0.5;
    if (!fits) {
      note("signal " + in_quotes(c.name) + ": " + std::to_string(*c.stated) + " samples are stated, " +
           std::to_string(there) + " are there; the others are taken as absent");
      return;
    }
    filled_ += *c.stated;
    std::vector<double> t(*c.stated);
    std::vector<double> values(*c.stated);
    std::size_t k = 0;
    for (std::size_t i = 0; i < t.size(); ++i) {
      t[i] = c.t.front() + static_cast<double>(i) * c.interval;
      while (k + 1 < there && c.t[k + 1] <= t[i] + 0.5 * c.interval) ++k;
      values[i] = c.values[k];
    }
    held_ += (held_.empty() ? "" : ", ") + in_quotes(c.name) + " (" + std::to_string(there) + " of " +
             std::to_string(*c.stated) + ")";
    c.t = std::move(t);
    c.values = std::move(values);
  }

  void build() {
    std::vector<Group> groups;
    bool unitless = false;
    for (Channel& c : channels_) {
      fill(c);
      Column column{c.description, "", std::move(c.values), c.name};
      if (c.units_type == "current") {
        column.unit_text = "A";
      } else if (c.units_type != "none") {
        unitless = true;
      }
      if (!c.units_type.empty()) add_metadata(c.name + " unitsType", c.units_type);
      groups.push_back({std::move(c.t), {std::move(column)}});
    }
    if (!held_.empty()) {
      note("recorded on change, the value before is held where a rec leaves out the signal: " + held_);
    }
    if (unitless) {
      note(
          "units are not in the file, only their kinds: current is taken as A; posn is mm or deg, velo "
          "mm/min or rpm, as the axis moves or turns (name them with the column)");
    }
    add_groups(log_, std::move(groups), "s");
  }

  std::string_view text_;
  std::unique_ptr<XML_ParserStruct, FreeParser> parser_;
  std::exception_ptr error_;
  std::vector<std::string> path_;
  std::map<std::string, Described> described_;
  std::unordered_map<std::string, std::size_t> index_;
  std::vector<Channel> channels_;
  std::string held_;
  std::size_t filled_ = 0;
  std::size_t frames_ = 0;
  std::size_t recs_ = 0;
  bool ball_bar_ = false;
};

}  // namespace

Log read_sinumerik_trace(std::string_view text, const std::string& source) {
  return TraceReader(text, source).read();
}

}  // namespace stribeck::io::detail
