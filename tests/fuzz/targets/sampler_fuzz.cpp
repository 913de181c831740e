// A stream of a sampler: whatever its bytes are and wherever they are cut, rows with finite numbers at a time that does not go back, and
// the same ones for every cut.
#include <algorithm>
#include <cmath>
#include <stribeck/workflow/live/sampler_stream.hpp>
#include <tests/fuzz/targets/fuzz.hpp>
#include <tests/fuzz/targets/log_checks.hpp>

namespace stribeck::fuzz {
namespace {

struct Rows : workflow::LiveSink {
  std::vector<double> all;
  double last = -1.0;

  void row(const workflow::LiveLayout& layout, double t, std::span<const double> values) override {
    demand(values.size() == layout.channels.size(), "a row of another length");
    demand(std::isfinite(t) && t > last, "a time that goes back");
    last = t;
    all.push_back(t);
    for (const double v : values) all.push_back(v);
    for (std::size_t c = 0; c + 1 < values.size(); ++c)
      demand(std::isfinite(values[c]), "a number that is none");
  }
  void glitch(const workflow::LiveLayout&, const workflow::QuadrantGlitch&) override {}
  [[nodiscard]] std::string in_words() const override { return {}; }
  [[nodiscard]] std::uint64_t left_out() const override { return 0; }
};

std::vector<double> rows_of(std::string_view input, std::size_t cut) {
  workflow::SamplerOptions options;
  options.source = "-";
  options.columns = {"x-cmd mm", "x-fb mm", "y-cmd mm", "y-fb mm"};
  options.sample_time = "1 ms";
  const auto layout = workflow::sampler_layout(options);
  const auto rows = std::make_shared<Rows>();
  const auto stream = std::make_shared<workflow::LiveStream>(
      layout.live, std::vector<std::shared_ptr<workflow::LiveSink>>{rows});
  workflow::SamplerLines lines(layout, stream);
  for (std::size_t at = 0; at < input.size(); at += cut) lines.take(input.substr(at, cut));
  return rows->all;
}

}  // namespace

std::vector<std::string> seeds() {
  return {
      "\7"
      "0 0 0 1 1\n1 0.1 0.1 1 1\n2 0.2 0.2001 1 1\noverrun\n5 0.1 0.1 1 1\n0 0 0 0 0\n",
      "\3"
      "1 1 2 2\n1.5 1.5 2 2\nnan 1 2 2\n1 1 2\n1 1 2 2 2 2 2\n\n1e300 1 2 -1e300\n"};
}

std::vector<std::string> words() {
  return {"overrun\n", "nan", "-inf", "1e308", "1e-320", " ", "\n", "\r\n", "99999999999"};
}

void one(std::string_view input) {
  const std::size_t cut = 1 + mode_of(input) % 64;
  const auto whole = rows_of(input, std::max<std::size_t>(input.size(), 1));
  const auto parts = rows_of(input, cut);
  const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
  demand(whole.size() == parts.size() && std::equal(whole.begin(), whole.end(), parts.begin(), same),
         "a cut changes the rows");
}

}  // namespace stribeck::fuzz
