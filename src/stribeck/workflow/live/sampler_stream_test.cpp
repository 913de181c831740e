#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/io/test_folder.hpp>
#include <stribeck/workflow/live/sampler_stream.hpp>

namespace stribeck::workflow::sampler_stream_test {
namespace {

using test::Folder;
using testing::HasSubstr;

SamplerLayout layout(std::vector<std::string> columns) {
  SamplerOptions o;
  o.source = "-";
  o.columns = std::move(columns);
  o.sample_time = "1 ms";
  return sampler_layout(o);
}

struct Lines {
  std::shared_ptr<LiveStream> stream;
  SamplerLines lines;
  explicit Lines(const SamplerLayout& l) : stream(std::make_shared<LiveStream>(l.live)), lines(l, stream) {}
  LiveState operator()(std::string_view bytes) {
    lines.take(bytes);
    return stream->state();
  }
};

std::string refusal(const SamplerOptions& o) {
  try {
    sampler_layout(o);
  } catch (const io::InputError& e) {
    return e.problems().front().text();
  }
  return "nothing";
}

TEST(SamplerLayout, FindsTheAxesOfLinuxCncsExport) {
  const SamplerLayout l = layout({"x-cmd mm", "x-fb mm", "x-force N", "y-cmd mm", "y-fb mm", "line"});
  ASSERT_EQ(l.live.axes.size(), 2U);
  EXPECT_EQ(l.live.axes[1].name, "y");
  EXPECT_EQ(l.live.axes[1].commanded, 3U);
  EXPECT_EQ(l.actual[1], 4U);
  EXPECT_DOUBLE_EQ(l.actual_to_m[1], 1e-3);
  EXPECT_EQ(l.columns, 6U);
  EXPECT_EQ(l.live.channels.back().name, "contour_error");
}

TEST(SamplerLayout, WithoutPositionsThereIsNoContourError) {
  const SamplerLayout l = layout({"a V", "b"});
  EXPECT_FALSE(l.live.error);
  EXPECT_EQ(l.live.channels.size(), 2U);
}

TEST(SamplerLayout, SaysWhatIsMissing) {
  SamplerOptions o;
  o.source = "-";
  EXPECT_THAT(refusal(o), HasSubstr("--live-columns"));
  o.columns = {"a mm", "b mm"};
  EXPECT_THAT(refusal(o), HasSubstr("--live-period"));
  o.sample_time = "1 mm";
  EXPECT_THAT(refusal(o), HasSubstr("1 mm"));
  o.sample_time = "1 ms";
  o.axes = {"x=a,c"};
  EXPECT_THAT(refusal(o), HasSubstr("\"c\", expected one of a, b"));
  o.columns = {"a", "b mm"};
  o.axes = {"x=a,b"};
  EXPECT_THAT(refusal(o), HasSubstr("has no unit"));
  o.columns = {"a mm", "b mm"};
  o.axes = {"x=a,b", "y=a,b", "z=a,b", "u=a,b"};
  EXPECT_THAT(refusal(o), HasSubstr("got 4 axes, expected at most 3"));
  o.axes = {};
  o.columns = {"a mm", "a mm"};
  EXPECT_THAT(refusal(o), HasSubstr("twice"));
}

TEST(SamplerLines, RowsMayBeCutAnywhere) {
  Lines lines(layout({"a mm", "b N"}));
  for (const char c : std::string("1 2\n3.5 -4e2\r\n  5\t6  \n\n7 8")) lines(std::string_view(&c, 1));
  EXPECT_EQ(lines.stream->state().rows, 3U);  // the last line is not complete
  EXPECT_EQ(lines.stream->state().refused, 0U);
  EXPECT_EQ(lines("\n").rows, 4U);
}

TEST(SamplerLines, WhatIsNoRowIsCountedAndSaid) {
  Lines lines(layout({"a mm", "b N"}));
  EXPECT_EQ(lines("1 2\n").refused, 0U);
  for (const auto& [text, part] : std::initializer_list<std::pair<std::string, std::string>>{
           {"1 nan\n", "1 nan"},
           {"inf 1\n", "expected numbers"},
           {"1\n", "got 1 values, expected 2"},
           {"1 2 3 4 5 6\n", "got more values"},
           {"1 2,5\n", "2,5"},
           {"hello\n", "hello"},
           {std::string(70000, '1') + "\n", "longer"},
           {std::string("1 \0 2\n", 6), "expected numbers"}}) {
    const std::uint64_t before = lines.stream->state().refused;
    const LiveState s = lines(text);
    EXPECT_EQ(s.refused, before + 1) << part;
    EXPECT_THAT(s.last_refused, HasSubstr(part));
  }
  // Each of them but the long one, of which nobody knows what it was, stands for a sample.
  EXPECT_EQ(lines("1 2\n").rows, 2U);
  EXPECT_DOUBLE_EQ(lines.stream->state().t, 8e-3);
}

TEST(SamplerLines, TheSampleNumberTellsLossesAndRestarts) {
  Lines lines(layout({"a mm", "b N"}));
  lines("10 1 2\n11 1 2\n15 1 2\n");
  EXPECT_EQ(lines.stream->state().lost, 3U);
  EXPECT_DOUBLE_EQ(lines.stream->state().t, 5e-3);
  const LiveState s = lines("0 1 2\n");
  EXPECT_EQ(s.restarts, 1U);
  EXPECT_DOUBLE_EQ(s.t, 7e-3);  // a gap, whose length nobody knows
  EXPECT_EQ(lines("overrun\n1 1 2\n").overruns, 1U);
  EXPECT_EQ(lines("2.5 1 2\n").refused, 1U);
  EXPECT_EQ(lines("99999999999 1 2\n").refused, 2U);
}

// One wild sample number refused every later row.
TEST(SamplerLines, AWildSampleNumberCostsItsRowAlone) {
  Lines lines(layout({"a mm", "b N"}));
  EXPECT_EQ(lines("1 1 2\n2 1 2\n").rows, 2U);
  const LiveState s = lines("900000000 1 2\n900000001 1 2\n900000002 1 2\n");
  EXPECT_EQ(s.refused, 1U);
  EXPECT_EQ(s.rows, 4U);
}

// A first line that was cut, and refused, said how many values every line has.
TEST(SamplerLines, ALineThatIsRefusedIsNoForm) {
  Lines lines(layout({"a mm", "b N"}));
  EXPECT_EQ(lines("0.5 1 2\n").refused, 1U);
  EXPECT_EQ(lines("1 2\n3 4\n").rows, 2U);
}

TEST(SamplerLines, AnotherNumberOfColumnsIsNotGuessed) {
  Lines lines(layout({"a mm", "b N"}));
  lines("1 2\n1 2\n");
  const LiveState s = lines("0 1 2\n1 1 2\n");
  EXPECT_EQ(s.rows, 2U);
  EXPECT_EQ(s.refused, 2U);
  EXPECT_THAT(s.last_refused, HasSubstr("got 3 values, expected 2 as before"));
  // After a restart the form may be another one.
  lines.lines.restart();
  EXPECT_EQ(lines("0 1 2\n1 1 2\n").rows, 4U);
}

/// Resident memory of this program [bytes].
double resident() {
  std::ifstream in("/proc/self/statm");
  double all = 0.0;
  double pages = 0.0;
  in >> all >> pages;
  return pages * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

// Twelve channels at 1 kHz for ten minutes, as text, recorded, and looked at ten times a second.
#if defined(__SANITIZE_ADDRESS__)
constexpr bool kSanitized = true;
#elif defined(__has_feature)
constexpr bool kSanitized = __has_feature(address_sanitizer) != 0;
#else
constexpr bool kSanitized = false;
#endif

TEST(SamplerLines, TenMinutesOfTwelveChannelsWithoutLossOrGrowth) {
  const Folder folder;
  std::vector<std::string> columns{"x-cmd mm", "x-fb mm", "y-cmd mm", "y-fb mm"};
  for (int c = 0; c < 8; ++c) columns.push_back(fmt::format("c{} V", c));
  Lines lines(layout(columns));
  lines.stream->record(folder / "");
  constexpr int kRows = 600'000;
  std::uint64_t bin = 0;
  std::uint64_t glitch = 0;
  std::size_t glitches = 0;
  double early = 0.0;
  std::string block;
  for (int k = 0; k < kRows; ++k) {
    const double angle = 0.95e-3 * k;
    const double x = 10.0 * std::cos(angle);
    const double y = 10.0 * std::sin(angle);
    fmt::format_to(std::back_inserter(block), "{} {:.6f} {:.6f} {:.6f} {:.6f} 1 2 3 4 5 6 7 {}\n", k, x, x, y,
                   y, k);
    if (k % 100 != 99) continue;
    lines(block);
    block.clear();
    const LiveBins bins = lines.stream->bins(bin, 500);
    ASSERT_EQ(bins.missed, 0U);
    bin = bins.first + bins.t.size();
    std::uint64_t first = 0;
    const auto found = lines.stream->glitches(glitch, first);
    ASSERT_EQ(first, glitch);
    glitch = first + found.size();
    glitches += found.size();
    if (k == kRows / 10 - 1) early = resident();
  }
  const LiveState s = lines.stream->state();
  EXPECT_EQ(s.rows, 600'000U);
  EXPECT_EQ(s.lost + s.overruns + s.refused + s.restarts, 0U);
  EXPECT_EQ(bin, 60'000U);
  // 570 rad: a reversal every quarter of a turn; the last one is open.
  EXPECT_EQ(glitches, 362U);
  // Ten times the rows; pages that the system counts late are far less than the 90 MB of all rows. The address sanitizer keeps
  // what was freed, and its memory grows.
  if (!kSanitized) {
    EXPECT_LT(resident() - early, 2e6);
  }
  EXPECT_EQ(s.recorded_rows, 600'000U);
  const std::filesystem::path file = lines.stream->save();
  std::ifstream in(file);
  std::size_t count = 0;
  for (std::string line; std::getline(in, line);) count += line.empty() || line[0] == '#' ? 0 : 1;
  EXPECT_EQ(count, 600'001U);  // and the header
}

bool becomes(const std::function<bool()>& is_so) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!is_so() && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  return is_so();
}

TEST(SamplerStream, AFileGrowsAndBeginsAgain) {
  const Folder folder;
  const std::string file = folder.write("run.log", "1 2\n1 2\n1");
  const SamplerLayout l = layout({"a mm", "b N"});
  const auto stream = std::make_shared<LiveStream>(l.live);
  const SamplerStream reading(file, l, stream);
  ASSERT_TRUE(becomes([&] { return stream->state().rows == 2; }));
  std::ofstream(file, std::ios::app) << " 2\n1 2\n";
  ASSERT_TRUE(becomes([&] { return stream->state().rows == 4; }));
  EXPECT_EQ(stream->state().refused, 0U);
  folder.write("run.log", "1 2\n");
  ASSERT_TRUE(becomes([&] { return stream->state().rows == 5; }));
  EXPECT_EQ(stream->state().restarts, 1U);
}

TEST(SamplerStream, ANamedPipeMayBeOpenedAgain) {
  const Folder folder;
  const std::string file = folder / "pipe";
  ASSERT_EQ(::mkfifo(file.c_str(), 0600), 0);
  const SamplerLayout l = layout({"a mm", "b N"});
  const auto stream = std::make_shared<LiveStream>(l.live);
  const SamplerStream reading(file, l, stream);
  std::ofstream(file) << "1 2\n3 4\n5";
  ASSERT_TRUE(becomes([&] { return stream->state().restarts == 1; }));
  std::ofstream(file) << "0 1 2\n";
  ASSERT_TRUE(becomes([&] { return stream->state().rows == 3; }));
  EXPECT_EQ(stream->state().refused, 0U);
  EXPECT_FALSE(stream->state().ended);
}

TEST(SamplerStream, WhatCannotBeOpenedIsRefused) {
  const Folder folder;
  const SamplerLayout l = layout({"a mm", "b N"});
  const auto stream = std::make_shared<LiveStream>(l.live);
  EXPECT_THROW(SamplerStream(folder / "no", l, stream), io::InputError);
  EXPECT_THROW(SamplerStream(folder / "", l, stream), io::InputError);
}

}  // namespace
}  // namespace stribeck::workflow::sampler_stream_test
