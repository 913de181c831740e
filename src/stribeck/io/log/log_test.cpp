#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/log/log.hpp>
#include <thread>

namespace stribeck::io::log_test {
namespace {

using testing::ThrowsMessage;

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;
using testing::StrEq;

Log parse(std::string_view text) { return parse_csv(text, "log.csv"); }

std::string refusal(std::string_view text) {
  try {
    parse(text);
    return "accepted";
  } catch (const InputError& e) {
    return e.what();
  }
}

/// A directory of its own for each test.
class LogFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("stribeck_io_" + std::to_string(::getpid()) +
               testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
  [[nodiscard]] std::size_t files() const {
    std::size_t n = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder_)) ++n;
    return n;
  }
  std::filesystem::path folder_;
};

TEST(Log, ReadsColumnsWithUnits) {
  const Log log = parse(
      "t [s],x (mm),u_V,v_mm_s,X1_CurrentFeedback,ratio [-],x "
      "(1),dq_deg_s\n0,1,2,3,4,5,6,7\n1,-1.5,2e3,.5,4,5,6,7\n");
  ASSERT_EQ(log.rows, 2u);
  const auto is = [&](std::size_t i, std::string_view name, std::string_view unit) {
    EXPECT_EQ(log.columns.at(i).name, name);
    EXPECT_EQ(log.columns.at(i).unit_text, unit);
  };
  is(0, "t", "s");
  is(1, "x", "mm");
  is(2, "u", "V");
  is(3, "v", "mm/s");
  is(4, "X1_CurrentFeedback", "");
  is(5, "ratio", "1");
  is(6, "x (1)", "");
  is(7, "dq", "deg/s");
  EXPECT_THAT(log.columns[1].values, ElementsAre(1.0, -1.5));
  EXPECT_THAT(log.columns[3].values, ElementsAre(3.0, 0.5));
  EXPECT_EQ(log.find("u_V"), &log.columns[2]);
  EXPECT_EQ(log.find("u"), &log.columns[2]);
  EXPECT_EQ(log.find("w"), nullptr);
  EXPECT_THAT(log.notes, IsEmpty());
}

TEST(Log, FindsSeparatorAndDecimalMark) {
  const std::vector<double> x{0.5, -1250.0};
  for (const char* text :
       {"t,x\n0,0.5\n1,-1250\n", "t;x\n0;0.5\n1;-1.25e3\n", "t;x\n0;0,5\n1;-1250,0\n",
        "t\tx\n0\t0,5\n1\t-1250\n", "t x\n0 0.5\n1 -1250\n", "  t   x  \n  0  0.5 \n 1 -1250 \n",
        "t [s] x [mm]\n0 0.5\n1 -1250\n", "\"t\";\"x\"\n\"0\";\"0,5\"\n\"1\";\"-1250\"\n",
        "t,x,\n0,0.5,\n1,-1250,\n", "t; x; \n0; 0.5; \n1; -1.25e+003; \n",
        "\xEF\xBB\xBFt,x\r\n0,0.5\r\n1,-1250\r\n", "t , x\n0 , +0.5\n1 , -1250\n",
        "t [s, since start];x\n0;0.5\n1;-1250\n", "t,x\n\n0,0.5\n\n1,-1250\n\n\n", "# t,x\n0,0.5\n1,-1250\n",
        "t\tx y\n0\t0.5\n1\t-1250\n", "a comment: yes\n# b: c\nt,x\n0,0.5\n1,-1250"}) {
    CsvOptions options;
    if (text[0] == 'a') options.skip_lines = 1;
    const Log log = parse_csv(text, "log.csv", options);
    ASSERT_EQ(log.columns.size(), 2u) << text;
    EXPECT_EQ(log.columns[1].values, x) << text;
  }
}

TEST(Log, DecimalCommaThatComesLate) {
  std::string text = "t;x\n";
  for (int i = 0; i < 150; ++i) text += std::to_string(i) + ";0\n";
  const Log log = parse(text + "150;0,25\n");
  EXPECT_EQ(log.columns[1].values.back(), 0.25);
}

TEST(Log, ReadsMetadataAndComments) {
  const Log log =
      parse("# machine: table A\n% rate : 5 ms\n# free text\nt,x\n0,1\n# operator: stopped: here\n1,2\n");
  EXPECT_THAT(log.metadata, ElementsAre(testing::Pair("machine", "table A"), testing::Pair("rate", "5 ms"),
                                        testing::Pair("operator", "stopped: here")));
  EXPECT_EQ(log.rows, 2u);
}

TEST(Log, NamesGivenByTheCaller) {
  CsvOptions options;
  options.names = {"t [s]", "x [mm]"};
  const Log log = parse_csv("0 1.5 \n1 2.5 \n", "hal.txt", options);
  EXPECT_EQ(log.rows, 2u);
  EXPECT_EQ(log.at("x").unit_text, "mm");
  EXPECT_THAT([&] { parse_csv("0 1.5 3\n1 2.5 3\n", "hal.txt", options); },
              ThrowsMessage<InputError>(HasSubstr("got 3 columns, expected 2 as named")));
}

TEST(Log, RefusesWithLineRowAndColumn) {
  EXPECT_EQ(refusal("t,x\n0,1\n1,abc\n2,3\n"),
            "log.csv:3: row 2, column \"x\": got \"abc\", expected a number");
  EXPECT_EQ(refusal("t,x\n0,1\n1,2mm\n2,3\n"),
            "log.csv:3: row 2, column \"x\": got \"2mm\", expected a number");
  EXPECT_EQ(refusal("# c\nt,x\n\n0,1\nnan,2\n2,3\n"),
            "log.csv:5: row 2, column \"t\": got \"nan\", expected a finite number");
  EXPECT_THAT(refusal("t,x\n0,1\n1,-inf\n2,3\n"),
              HasSubstr("row 2, column \"x\": got \"-inf\", expected a finite"));
  EXPECT_THAT(refusal("t,x\n0,1\n1,1e999\n2,3\n"), HasSubstr("row 2, column \"x\""));
  EXPECT_THAT(refusal("t,x,v\n0,1,2\n1,,3\n2,3,4\n"),
              HasSubstr("log.csv:3: row 2, column \"x\": the cell is blank"));
  EXPECT_THAT(refusal("t,x,v\n0,1,2\n1,2,\n2,3,4\n"),
              HasSubstr("log.csv:3: row 2, column \"v\": the cell is blank"));
  EXPECT_THAT(refusal("t,x,v\n0,1,2\n1,2\n2,3,4\n"), HasSubstr("log.csv:3: row 2: got 2 cells, expected 3"));
  EXPECT_THAT(refusal("t,x\n0,1\n1,2,3\n2,3\n"), HasSubstr("log.csv:3: row 2: got 3 cells, expected 2"));
  EXPECT_THAT(refusal("t x\n0 1\n1 2 3\n2 3\n"), HasSubstr("log.csv:3: row 2: got 3 cells, expected 2"));
  EXPECT_THAT(refusal("t,x\n0,1\n1,5,2,5\n2,3\n"), HasSubstr("decimal comma?"));
  EXPECT_THAT(refusal("t;x\n0;1,5\n1;2.5\n2;3\n"),
              HasSubstr("got \"2.5\", expected a number with a decimal comma"));
  EXPECT_THAT(refusal("t;x\n0;1,5\n1;1.234\n2;3\n"), HasSubstr("got \"1.234\", expected a number"));
  EXPECT_THAT(refusal("t,x,t\n0,1,2\n1,2,3\n"),
              HasSubstr("log.csv: columns \"t\" and \"t in column 3\" hold different times"));
  EXPECT_THAT(refusal(""), HasSubstr("is empty"));
  EXPECT_THAT(refusal("\n\n# only\n"), HasSubstr("has no header"));
  EXPECT_THAT(refusal("0,1\n1,2\n"), HasSubstr("log.csv:1: has no header"));
  EXPECT_THAT(refusal("t,x\n"), HasSubstr("has a header but no data rows"));
  EXPECT_THAT(refusal("t,x"), HasSubstr("has a header but no data rows"));
  EXPECT_THAT(refusal("t,x\n0,1\n"), HasSubstr("one data row"));
  EXPECT_THAT(refusal(std::string_view("t,x\n0,1\n1,\0\n", 12)), HasSubstr("log.csv:3: holds a NUL byte"));
  EXPECT_THAT(refusal("\x7f\x45\x4c\x46\x02\x01\n\x03,\x04\n"), HasSubstr("not a text file"));
  EXPECT_THAT(refusal(std::string_view("\xFF\xFEt\0,\0x\0\n\0\0", 11)),
              HasSubstr("log.csv:2: is UTF-16 text that ends"));
  EXPECT_THAT(refusal(std::string_view("\xFF\xFE\0\xDC,\0", 6)),
              HasSubstr("log.csv:1: is UTF-16 text that ends or breaks"));
  EXPECT_THAT(refusal("\xFF\xFE"), HasSubstr("is empty"));
  EXPECT_THAT(refusal(std::string_view("PK\x03\x04xx", 6)), HasSubstr("spreadsheet"));
  EXPECT_THAT(refusal("t,x\r0,1\r1,2\r"), HasSubstr("CR alone"));
}

// As Windows programs write it: the low byte first, or the high one.
TEST(Log, ReadsUtf16) {
  const std::u16string text = u"Zeit [ms]\tWinkel [\u00B0]\r\n0\t1,5\r\n1\t2,5\r\n";
  for (const bool low_first : {true, false}) {
    std::string bytes = low_first ? "\xFF\xFE" : "\xFE\xFF";
    for (const char16_t c : text) {
      const char low = static_cast<char>(c & 0xFF);
      const char high = static_cast<char>(c >> 8);
      bytes += low_first ? low : high;
      bytes += low_first ? high : low;
    }
    const Log log = parse_log(bytes, "log.txt");
    EXPECT_EQ(log.rows, 2u);
    EXPECT_EQ(log.columns.at(1).header, "Winkel [\u00B0]");
    EXPECT_EQ(log.columns.at(1).values, (std::vector<double>{1.5, 2.5}));
  }
}

TEST(Log, DropsACutLastRowWithANote) {
  for (const char* text :
       {"t,x,v\n0,1,2\n1,2,3\n2,3", "t,x,v\n0,1,2\n1,2,3\n2,3\n", "t,x,v\n0,1,2\n1,2,3\n2,",
        "t,x,v\n0,1,2\n1,2,3\n2,3,", "t,x,v\n0,1,2\n1,2,3\n2,3,-", "t x v\n0 1 2\n1 2 3\n2 3\n\n"}) {
    const Log log = parse(text);
    EXPECT_EQ(log.rows, 2u) << text;
    EXPECT_THAT(log.notes, ElementsAre(HasSubstr("the last row (row 3, line 4) was left out"))) << text;
    for (const auto& c : log.columns) EXPECT_EQ(c.values.size(), 2u);
  }
  const Log log = parse("t;x\n0;1\n1;2\n;\n;\n");  // as spreadsheets leave behind
  EXPECT_EQ(log.rows, 2u);
  EXPECT_THAT(log.notes, ElementsAre(StrEq("lines without any value were left out: 2")));
}

TEST(Log, LeavesOutTextColumnsOnRequest) {
  constexpr std::string_view kText = "run,t,x,phase\na b,0,1,\"prep, cold\"\n,1,2,end\nc,2,3,\n";
  EXPECT_THAT(refusal(kText), HasSubstr("row 1, column \"run\": got \"a b\", expected a number"));
  CsvOptions options;
  options.leave_out_text_columns = true;
  const Log log = parse_csv(kText, "log.csv", options);
  ASSERT_EQ(log.columns.size(), 2u);
  EXPECT_THAT(log.columns[0].values, ElementsAre(0.0, 1.0, 2.0));
  EXPECT_THAT(log.columns[1].values, ElementsAre(1.0, 2.0, 3.0));
  EXPECT_THAT(log.notes, ElementsAre(HasSubstr("\"phase\" was left out"), HasSubstr("\"run\" was left out")));
  EXPECT_THAT([&] { parse_csv("t,x,p\n0,1,a\n1,b,a\n2,3,a\n", "log.csv", options); },
              ThrowsMessage<InputError>(HasSubstr("got \"b\", expected a number")));
  EXPECT_THAT([&] { parse_csv("p,q\na,a\nb,b\nc,c\n", "log.csv", options); },
              ThrowsMessage<InputError>(HasSubstr("has no column of numbers")));
}

TEST(Log, LatinHeadersAndUnknownUnits) {
  const Log log = parse("t,x [\xB5m],y [furlongs!],x_mm,x_um,\n0,1,2,3,4\n1,2,3,4,5\n");
  EXPECT_EQ(log.columns[1].unit_text, "µm");
  EXPECT_EQ(log.columns[2].name, "y [furlongs!]");
  EXPECT_THAT(log.notes,
              ElementsAre(HasSubstr("read as Windows-1252"), HasSubstr("unit \"furlongs!\" is not known")));
  EXPECT_EQ(log.columns[3].name, "x_mm");  // x alone would stand for three columns
  EXPECT_EQ(log.columns[3].unit_text, "mm");
}

TEST(Log, ColumnsInSi) {
  const Log log = parse("t [ms],x [mm],F,T [degC]\n0,35,1,2\n5,-1.5,1,2\n");
  EXPECT_THAT(in_si(log.at("t"), quantity("s", "ms")), ElementsAre(0.0, 0.005));
  EXPECT_THAT(in_si(log.at("x"), quantity("m", "mm")), ElementsAre(0.035, -0.0015));
  EXPECT_THAT([&] { in_si(log.at("x"), quantity("N", "N")); },
              ThrowsMessage<InputError>(HasSubstr("column \"x [mm]\"")));
  EXPECT_THAT([&] { in_si(log.at("T"), quantity("K", "K")); },
              ThrowsMessage<InputError>(HasSubstr("column \"T [degC]\"")));
  try {
    in_si(log.at("F"), quantity("N", "N"));
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("column \"F\": has no unit, expected one like N"));
  }
  try {
    (void)log.at("FF");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("no column \"FF\", there are: t, x, F, T"));
  }
}

TEST_F(LogFile, RoundTripsBitForBitOverManyBlocks) {
  const std::uint64_t seed = 11;
  std::mt19937_64 random(seed);
  Log log;
  log.metadata.emplace_back("machine", "table");
  log.columns = {{"t", "s", {}}, {"x, measured", "mm", {}}, {"#3", "", {}}, {"my share", "1", {}}};
  log.rows = 20011;
  for (std::size_t r = 0; r < log.rows; ++r) {
    for (auto& c : log.columns) {
      double x = std::bit_cast<double>(random());
      if (!std::isfinite(x)) x = static_cast<double>(r);
      c.values.push_back(x);
    }
  }
  write_csv(path("a.csv"), log);
  const Log back = read_csv(path("a.csv"));
  ASSERT_EQ(back.rows, log.rows);
  EXPECT_EQ(back.metadata, log.metadata);
  for (std::size_t c = 0; c < log.columns.size(); ++c) {
    EXPECT_EQ(back.columns[c].name, log.columns[c].name);
    EXPECT_EQ(back.columns[c].unit_text, log.columns[c].unit_text);
    EXPECT_EQ(back.columns[c].values, log.columns[c].values) << "seed " << seed;
  }
  EXPECT_EQ(files(), 1u);

  const gzFile out = gzopen(path("a.csv.gz").c_str(), "wb");
  const std::string text = csv_text(log);
  ASSERT_EQ(gzwrite(out, text.data(), static_cast<unsigned>(text.size())), static_cast<int>(text.size()));
  gzclose(out);
  EXPECT_EQ(read_csv(path("a.csv.gz")).columns[1].values, log.columns[1].values);
  const std::string packed = read_text(path("a.csv.gz"));
  EXPECT_EQ(parse_csv("t,x\n0,1\n1,2\n", "").rows, 2u);
  EXPECT_THAT([&] { parse_csv(packed.substr(0, packed.size() / 2), "a.csv.gz"); },
              ThrowsMessage<InputError>(HasSubstr("damaged or cut off")));
  std::string damaged = packed;
  damaged[damaged.size() / 2] = static_cast<char>(damaged[damaged.size() / 2] ^ 0x55);
  EXPECT_THAT([&] { parse_csv(damaged, "a.csv.gz"); },
              ThrowsMessage<InputError>(HasSubstr("damaged or cut off")));
}

TEST_F(LogFile, AGzipBombIsRefusedEarly) {
  // 162 MB from 2.2 MB: what it is is known long before it has grown to hundreds of times its size.
  const std::string line(1 << 20, '0');
  const gzFile out = gzopen(path("bomb.csv.gz").c_str(), "wb");
  for (int i = 0; i < 160; ++i) ASSERT_GT(gzwrite(out, line.data(), static_cast<unsigned>(line.size())), 0);
  for (int i = 0; i < 2; ++i) {
    // And what does not shrink, so that the file is not small.
    std::string noise(1 << 20, '\0');
    std::uint32_t x = 7;
    for (char& c : noise) c = static_cast<char>((x = x * 1664525u + 1013904223u) >> 24);
    gzwrite(out, noise.data(), static_cast<unsigned>(noise.size()));
  }
  gzclose(out);
  try {
    read_csv(path("bomb.csv.gz"));
    FAIL();
  } catch (const InputError& e) {
    const std::string what = e.what();
    const auto at = what.find("grows to more than ");
    ASSERT_NE(at, std::string::npos) << what;
    EXPECT_LT(std::stoi(what.substr(at + 19)), 80) << what;
  }
}

/// 100 MB in 100 kB.
TEST(Log, RefusesGzipThatGrowsWithoutBound) {
  std::string packed(1 << 20, '\0');
  z_stream stream{};
  ASSERT_EQ(deflateInit2(&stream, 9, Z_DEFLATED, 31, 9, Z_DEFAULT_STRATEGY), Z_OK);
  std::string zeros(1 << 20, '0');
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  for (int i = 0; i < 100; ++i) {
    stream.next_in = reinterpret_cast<Bytef*>(zeros.data());
    stream.avail_in = static_cast<uInt>(zeros.size());
    ASSERT_EQ(deflate(&stream, i == 99 ? Z_FINISH : Z_NO_FLUSH), i == 99 ? Z_STREAM_END : Z_OK);
  }
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  EXPECT_THAT(refusal(packed), HasSubstr("no log does"));
}

TEST_F(LogFile, RefusesWhatIsNoFile) {
  const auto message = [](const std::string& p) {
    try {
      read_csv(p);
      return std::string("accepted");
    } catch (const InputError& e) {
      return std::string(e.what());
    }
  };
  EXPECT_EQ(message(path("none.csv")),
            path("none.csv") + ": no such file (check the name and the working directory)");
  EXPECT_THAT(message(folder_.string()), HasSubstr("is a directory"));
  write_atomically(path("empty.csv"), "");
  EXPECT_THAT(message(path("empty.csv")), HasSubstr("is empty"));
  if (::geteuid() != 0) {  // root may read everything
    write_atomically(path("secret.csv"), "t,x\n0,1\n1,2\n");
    ::chmod(path("secret.csv").c_str(), 0);
    EXPECT_THAT(message(path("secret.csv")), HasSubstr("cannot be opened: "));
  }
}

TEST_F(LogFile, ReadsFromAPipe) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  std::string text = "t,x\n";
  for (int i = 0; i < 100000; ++i) text += std::to_string(i) + ",1\n";
  std::thread writer([&] { std::ofstream(path("pipe")) << text; });
  const Log log = read_csv(path("pipe"));
  writer.join();
  EXPECT_EQ(log.rows, 100000u);
}

/// Recorded data of the shared folder; not part of the project.
TEST(LogData, ReadsRecordedFiles) {
  const char* given = std::getenv("STRIBECK_DATA_DIR");
  const std::string file =
      std::string(given != nullptr ? given : STRIBECK_SOURCE_DIR "/../shared/data") + "/emps/emps.csv";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no recordings; set STRIBECK_DATA_DIR";
  const Log log = read_csv(file);
  EXPECT_EQ(log.at("q_ref").unit_text, "m");
  const TimeCheck time = check_time(in_si(log.at("t"), quantity("s", "s")));
  EXPECT_NEAR(time.sample_time, 1e-3, 1e-7);  // sampled at 1 kHz, stamps of 8 ns
  EXPECT_TRUE(time.regular());
}

TEST(Time, MedianStepGapsAndJitter) {
  const TimeCheck even = check_time({0.0, 0.005, 0.010, 0.015, 0.020});
  EXPECT_NEAR(even.sample_time, 0.005, 1e-15);
  EXPECT_TRUE(even.regular());
  EXPECT_THAT(even.notes, IsEmpty());

  const TimeCheck gap = check_time({0, 1, 2, 5, 6, 7.02, 8.02, 9});
  EXPECT_NEAR(gap.sample_time, 1.0, 1e-12);
  ASSERT_EQ(gap.gaps.size(), 1u);
  EXPECT_EQ(gap.gaps[0].row, 4u);
  EXPECT_EQ(gap.gaps[0].duration, 3.0);
  EXPECT_NEAR(gap.jitter, 0.02, 1e-12);
  EXPECT_FALSE(gap.regular());
  EXPECT_THAT(gap.notes, ElementsAre(HasSubstr("1 gap, the first before row 4: 3 instead of 1"),
                                     HasSubstr("up to 2 %")));

  // Shifting time and changing its unit change nothing but the unit.
  const TimeCheck shifted = check_time({100e3, 101e3, 102e3, 105e3, 106e3, 107.02e3, 108.02e3, 109e3});
  EXPECT_NEAR(shifted.sample_time, 1e3, 1e-9);
  EXPECT_EQ(shifted.gaps[0].row, gap.gaps[0].row);
  EXPECT_NEAR(shifted.jitter, gap.jitter, 1e-12);
}

TEST(Time, RefusesTimeThatDoesNotIncrease) {
  const auto message = [](const std::vector<double>& t) {
    try {
      check_time(t, "log.csv", "t");
      return std::string("accepted");
    } catch (const InputError& e) {
      return std::string(e.what());
    }
  };
  EXPECT_THAT(message({0, 1, 2, 1.5, 3}),
              StartsWith("log.csv: column \"t\": row 4: time goes back, from 2 to 1.5"));
  EXPECT_THAT(message({0, 1, 1, 2}), HasSubstr("row 3: time stands still"));
  EXPECT_THAT(message({0, std::nan(""), 2}), HasSubstr("row 2: time is not a number"));
  EXPECT_THAT(message({0}), HasSubstr("expected at least two"));
}

/// Not a test but the measurement of docs/decisions/0002: prints the speed of the reader on files of 60 MB.
TEST_F(LogFile, DISABLED_Speed) {
  for (const int digits : {6, 17}) {
    std::ostringstream text;
    text.precision(digits);
    text << "t [s],r [mm],x [mm],u [V],v [mm/s]\n";
    for (int i = 0; text.tellp() < 60'000'000; ++i) {
      const double t = 0.001 * i;
      text << t << ',' << 100 * std::sin(t) << ',' << 100 * std::sin(t) + 1e-3 * std::cos(9 * t) << ','
           << 3 * std::cos(t) << ',' << 100 * std::cos(t) << '\n';
    }
    write_atomically(path("speed.csv"), text.str());
    double best = 1e9;
    for (int k = 0; k < 5; ++k) {
      const auto start = std::chrono::steady_clock::now();
      ASSERT_GT(read_csv(path("speed.csv")).rows, 100'000u);
      best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    std::printf("%d digits: %.0f MB/s\n", digits, 1e-6 * static_cast<double>(text.tellp()) / best);
  }
}

TEST_F(LogFile, WritesAtomically) {
  write_atomically(path("a"), "one");
  write_atomically(path("a"), "two");
  EXPECT_EQ(read_text(path("a")), "two");
  ::chmod(path("a").c_str(), 0640);
  write_atomically(path("a"), "three");
  struct stat info {};
  ::stat(path("a").c_str(), &info);
  EXPECT_EQ(info.st_mode & 0777, 0640u);
  std::filesystem::create_symlink(path("a"), path("link"));
  write_atomically(path("link"), "four");
  EXPECT_EQ(read_text(path("a")), "four");
  EXPECT_TRUE(std::filesystem::is_symlink(path("link")));
  EXPECT_EQ(files(), 2u);

  make_directory(path("deep/er"));
  make_directory(path("deep/er"));
  EXPECT_TRUE(std::filesystem::is_directory(path("deep/er")));
  EXPECT_THAT([&] { make_directory(path("a/b")); },
              ThrowsMessage<InputError>(HasSubstr("cannot be made a directory")));
  EXPECT_THAT([&] { make_directory(path("a")); },
              ThrowsMessage<InputError>(HasSubstr("cannot be made a directory")));
  EXPECT_THAT([&] { write_atomically(path("none/a"), "x"); },
              ThrowsMessage<InputError>(HasSubstr("no such directory (make it first)")));
  EXPECT_THAT([&] { write_atomically(path("deep"), "x"); },
              ThrowsMessage<InputError>(HasSubstr("is a directory, expected a file to write")));
  EXPECT_THAT([&] { write_atomically("", "x"); }, ThrowsMessage<InputError>(HasSubstr("cannot be written")));
  EXPECT_THAT(
      [&] { read_text(path("deep")); },
      ThrowsMessage<InputError>(HasSubstr("is a directory, expected a file (name a file inside it)")));
  write_atomically("/dev/null", "x");
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
  EXPECT_EQ(files(), 3u);
}

TEST_F(LogFile, AFailedWriteLeavesTheOldFileAndNothingElse) {
  write_atomically(path("a"), "old");
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{1000, before.rlim_max};
  std::signal(SIGXFSZ, SIG_IGN);
  ::setrlimit(RLIMIT_FSIZE, &small);
  EXPECT_THAT([&] { write_atomically(path("a"), std::string(5000, 'x')); },
              ThrowsMessage<InputError>(HasSubstr("cannot be written: ")));
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, SIG_DFL);
  EXPECT_EQ(read_text(path("a")), "old");
  EXPECT_EQ(files(), 1u);
}

}  // namespace
}  // namespace stribeck::io::log_test
