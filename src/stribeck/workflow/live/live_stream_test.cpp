#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <array>
#include <cmath>
#include <fstream>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/io/test_folder.hpp>
#include <stribeck/workflow/live/live_stream.hpp>

namespace stribeck::workflow::live_stream_test {
namespace {

using test::Folder;
using testing::HasSubstr;

LiveLayout two_channels() {
  LiveLayout l;
  l.source = "test";
  l.channels = {{"x", "mm"}, {"f", "N"}};
  l.sample_time = 1e-3;
  return l;
}

TEST(LiveStream, ABinKeepsThePeakOfASingleRow) {
  LiveStream stream(two_channels());
  for (int k = 0; k < 100; ++k) stream.row(k * 1e-3, std::array{1.0, k == 57 ? 99.0 : -1.0});
  const LiveBins bins = stream.bins(0, 1000);
  ASSERT_EQ(bins.t.size(), 10U);
  EXPECT_EQ(bins.high[5 * 2 + 1], 99.0F);
  EXPECT_EQ(bins.low[5 * 2 + 1], -1.0F);
  EXPECT_EQ(bins.high[4 * 2 + 1], -1.0F);
  EXPECT_DOUBLE_EQ(bins.t[5], 0.05);
}

TEST(LiveStream, AReaderThatComesLateIsToldHowMuchItMissed) {
  LiveStream stream(two_channels());
  for (int k = 0; k < 100000; ++k) stream.row(k * 1e-3, std::array{double(k), 0.0});
  const LiveBins bins = stream.bins(10, 100000);
  EXPECT_EQ(bins.missed, bins.first - 10);
  EXPECT_EQ(bins.first + bins.t.size(), 10000U);
  EXPECT_EQ(bins.t.size(), LiveStream::kKeptBins - 1);
  // Numbers and times still belong together.
  EXPECT_NEAR(bins.t.front(), static_cast<double>(bins.first) * 0.01, 1e-9);
  EXPECT_EQ(stream.bins(20000, 5).first, 10000U);
}

TEST(LiveStream, ARecordingIsALogThatCanBeRead) {
  const Folder folder;
  LiveStream stream(two_channels());
  stream.row(0.0, std::array{0.0, 0.0});
  stream.record(folder / "");
  EXPECT_THROW(stream.record(folder / ""), io::InputError);
  EXPECT_THROW(stream.save(), io::InputError);  // no row yet; the recording goes on
  EXPECT_TRUE(stream.state().recording);
  for (int k = 1; k <= 500; ++k) stream.row(k * 1e-3, std::array{k * 0.1, -2.5});
  EXPECT_EQ(stream.state().recorded_rows, 500U);
  const std::string file = stream.save();
  EXPECT_EQ(file, folder / "live-1.csv");
  const io::Log log = io::read_log(file);
  EXPECT_EQ(log.rows, 500U);
  EXPECT_EQ(log.at("x").unit_text, "mm");
  EXPECT_DOUBLE_EQ(log.at("x").values.back(), 50.0);
  EXPECT_TRUE(io::check_time(log.at("t").values).regular());
  EXPECT_THROW(stream.save(), io::InputError);
}

TEST(LiveStream, ARecordingNeverWritesOverAFile) {
  const Folder folder;
  folder.write("live-1.csv", "mine");
  LiveStream stream(two_channels());
  stream.record(folder / "");
  stream.row(0.0, std::array{0.0, 0.0});
  EXPECT_EQ(stream.save(), folder / "live-2.csv");
  EXPECT_EQ(test::text_of(folder / "live-1.csv"), "mine");
}

TEST(LiveStream, WhatIsDiscardedLeavesNothing) {
  const Folder folder;
  {
    LiveStream stream(two_channels());
    stream.record(folder / "");
    stream.row(0.0, std::array{0.0, 0.0});
    stream.discard();
    EXPECT_EQ(folder.files(), 0U);
    stream.record(folder / "");
  }
  EXPECT_EQ(folder.files(), 0U);
}

TEST(LiveStream, AFullRecordingStopsAndIsWhole) {
  const Folder folder;
  LiveStream stream(two_channels());
  stream.record(folder / "", 2000);
  for (int k = 0; k < 1000; ++k) stream.row(k * 1e-3, std::array{1.0, 2.0});
  const LiveState state = stream.state();
  EXPECT_THAT(state.recording_stopped, HasSubstr("the most that is recorded"));
  EXPECT_EQ(state.rows, 1000U);
  const io::Log log = io::read_log(stream.save());
  EXPECT_EQ(log.rows, state.recorded_rows);
  EXPECT_LE(state.recorded_bytes, 2000U);
}

TEST(LiveStream, AFolderThatIsNotThereIsRefused) {
  LiveStream stream(two_channels());
  EXPECT_THROW(stream.record("/no/such/folder"), io::InputError);
  EXPECT_FALSE(stream.state().recording);
}

}  // namespace
}  // namespace stribeck::workflow::live_stream_test
