#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/log.hpp>
#include <stribeck/io/log/test_logs.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::io::damaged_logs_test {
namespace {

ReadOptions options_of(const test::SampleLog& sample) {
  ReadOptions options;
  options.names = sample.names;
  if (sample.sample_time > 0.0) options.sample_time = sample.sample_time;
  return options;
}

/// What is wrong with how a damaged log was taken; "" when it was refused, was noted, or did not matter.
std::string silent_garbage(std::string_view text, const ReadOptions& options, const Log& clean) {
  Log log;
  try {
    log = parse_log(text, "damaged.log", options);
  } catch (const InputError& e) {
    return std::string(e.what()).find("damaged.log") == std::string::npos ? "a refusal without the file" : "";
  }
  for (const Column& c : log.columns) {
    for (const double x : c.values) {
      if (!std::isfinite(x)) return "a value that is not finite in " + c.name;
    }
    const std::size_t n = std::max(c.values.size(), c.texts.size());
    if (n == 0 || n > log.rows) return "a column of wrong length";
    if (c.time >= 0 && log.columns.at(static_cast<std::size_t>(c.time)).values.size() != n)
      return "a column that differs in length from its time";
  }
  const auto is_new = [&](const Note& note) {
    return std::find(clean.notes.begin(), clean.notes.end(), note) == clean.notes.end();
  };
  if (std::any_of(log.notes.begin(), log.notes.end(), is_new)) return "";
  if (log.columns.size() != clean.columns.size()) return "other columns, without a note";
  for (const Column& c : log.columns) {
    const Column* same = clean.find(c.header);
    if (same == nullptr) return "a new column " + c.header + ", without a note";
    if (c.unit_text != same->unit_text) return "another unit of " + c.header + ", without a note";
    if (c.values.size() > same->values.size() || c.texts.size() > same->texts.size())
      return "more rows, without a note";
    if (!std::equal(c.values.begin(), c.values.end(), same->values.begin()))
      return "other values of " + c.header + ", without a note";
    if (!std::equal(c.texts.begin(), c.texts.end(), same->texts.begin()))
      return "other texts of " + c.header + ", without a note";
  }
  return "";
}

std::string refusal(std::string_view text, const ReadOptions& options = {}) {
  try {
    static_cast<void>(parse_log(text, "damaged.log", options));
    return "accepted";
  } catch (const InputError& e) {
    return e.what();
  }
}

class DamagedLogs : public testing::Test {
 protected:
  void expect_loud(const test::SampleLog& sample, std::string_view text, const std::string& damage) {
    ++damaged_;
    const auto options = options_of(sample);
    if (last_ != sample.name) {
      clean_ = parse_log(sample.text, "damaged.log", options);
      last_ = sample.name;
    }
    const std::string wrong = silent_garbage(text, options, clean_);
    EXPECT_EQ(wrong, "") << sample.name << ", " << damage << ":\n" << text;
  }
  int damaged_ = 0;

 private:
  Log clean_;
  std::string last_;
};

TEST_F(DamagedLogs, TheSamplesAreGood) {
  for (const auto& sample : test::sample_logs()) {
    const Log log = parse_log(sample.text, "good.log", options_of(sample));
    EXPECT_EQ(log.rows, 8u) << sample.name;
    EXPECT_GE(log.columns.size(), 3u) << sample.name;
    EXPECT_GE(time_column(log), 0) << sample.name;
    for (const Column& c : log.columns) {
      for (const double x : c.values) EXPECT_TRUE(std::isfinite(x)) << sample.name;
    }
  }
}

TEST_F(DamagedLogs, CutAtEveryByte) {
  for (const auto& sample : test::sample_logs()) {
    for (std::size_t n = 0; n < sample.text.size(); ++n)
      expect_loud(sample, std::string_view(sample.text).substr(0, n), "cut at byte " + std::to_string(n));
  }
  EXPECT_GT(damaged_, 200);
}

TEST_F(DamagedLogs, AForeignByteAnywhere) {
  for (const auto& sample : test::sample_logs()) {
    for (std::size_t at = 0; at < sample.text.size(); at += 3) {
      for (const char byte : {'\xFE', '\x01', '\0'}) {
        std::string text = sample.text;
        text[at] = byte;
        expect_loud(sample, text,
                    "byte " + std::to_string(static_cast<unsigned char>(byte)) + " at " + std::to_string(at));
      }
    }
  }
}

/// Random bytes of any kind: a digit for a digit cannot be seen, so only crashes, endless loops and values
/// that are not finite count.
TEST_F(DamagedLogs, RandomBytes) {
  constexpr std::uint64_t kSeed = 7;
  std::mt19937_64 random(kSeed);
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  for (const auto& sample : test::sample_logs()) {
    for (int k = 0; k < 60; ++k) {
      std::string text = sample.text;
      for (std::size_t i = 0, n = 1 + below(12); i < n; ++i) {
        const std::size_t at = below(text.size());
        switch (below(4)) {
          case 0:
            text[at] = static_cast<char>(random());
            break;
          case 1:
            text.erase(at, 1 + below(20));
            break;
          case 2:
            text.insert(at, text.substr(below(text.size()), 1 + below(40)));
            break;
          default:
            text[at] = ",;\n\"0.eE-[{<%\t "[below(15)];
            break;
        }
        if (text.empty()) text = "x";
      }
      try {
        const Log log = parse_log(text, "damaged.log", options_of(sample));
        for (const Column& c : log.columns) {
          for (const double x : c.values)
            EXPECT_TRUE(std::isfinite(x)) << sample.name << ", seed " << kSeed << ", case " << k << ":\n"
                                          << text;
        }
      } catch (const InputError&) {
      }
    }
  }
}

TEST_F(DamagedLogs, RowsTakenOutHalvedOrDoubled) {
  for (const auto& sample : test::sample_logs()) {
    if (sample.separator == 0) continue;
    std::vector<std::string> lines;
    for (std::size_t at = 0; at < sample.text.size();) {
      const auto end = sample.text.find('\n', at) + 1;
      lines.push_back(sample.text.substr(at, end - at));
      at = end;
    }
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      if (lines[i].find_first_of("0123456789") == 0 || lines[i][0] == ' ') rows.push_back(i);
    }
    ASSERT_GE(rows.size(), 8u) << sample.name;
    for (std::size_t k = 1; k + 1 < rows.size(); ++k) {
      const auto joined = [&](const std::string& row) {
        std::string text;
        for (std::size_t i = 0; i < lines.size(); ++i) text += i == rows[k] ? row : lines[i];
        return text;
      };
      const std::string& row = lines[rows[k]];
      const std::string where = " row " + std::to_string(k + 1);
      // Without a time of its own, a table cannot show that a row is missing: the time would be made up.
      if (sample.name != std::string("CSV without times")) {
        expect_loud(sample, joined(""), "without" + where);
        expect_loud(sample, joined(row + row), "twice" + where);
      }
      const auto half = row.find(sample.separator, row.size() / 3);
      if (half != std::string::npos && row.find_first_not_of(" \r\n", half + 1) != std::string::npos) {
        expect_loud(sample, joined(row.substr(0, half) + "\n"), "half of" + where);
        expect_loud(sample, joined(row.substr(0, half) + row.substr(half + 1)), "joined cells in" + where);
      }
      expect_loud(sample, joined("1e999" + row.substr(1)), "huge number in" + where);
      expect_loud(sample, joined("nan" + row.substr(std::min(row.size(), row.find(sample.separator)))),
                  "nan in" + where);
    }
  }
}

/// The first two cells exchanged: the time with a channel that goes up and down.
TEST_F(DamagedLogs, ExchangedColumns) {
  for (const auto& sample : test::sample_logs()) {
    if (sample.separator == 0 || sample.name == std::string("CSV without times")) continue;
    std::string text;
    for (std::size_t at = 0; at < sample.text.size();) {
      const auto end = sample.text.find('\n', at);
      std::string line = sample.text.substr(at, end - at);
      at = end + 1;
      const char c = line.empty() ? 'x' : line[0] == ' ' ? '0' : line[0];
      const auto first = line.find(sample.separator, 1);
      const auto second = first == std::string::npos
                              ? first
                              : line.find_first_of(std::string{sample.separator, '\r'}, first + 1);
      if (c >= '0' && c <= '9' && first != std::string::npos) {
        const auto stop = std::min(second, line.size());
        line = line.substr(first + 1, stop - first - 1) + sample.separator + line.substr(0, first) +
               line.substr(stop);
      }
      text += line + "\n";
    }
    expect_loud(sample, text, "first columns exchanged");
  }
  std::string json = test::sinumerik_json_sample();
  for (auto at = json.find("\"CYCLE\""); at != std::string::npos; at = std::string::npos)
    json.replace(at, 7, "\"ENC_POS|1\"");
  json.replace(json.find("\"ENC_POS|1\"", json.find("\"ENC_POS|1\"") + 1), 11, "\"CYCLE\"");
  test::SampleLog sample{"SINUMERIK JSON", test::sinumerik_json_sample(), 0};
  expect_loud(sample, json, "CYCLE and a position exchanged");
}

TEST_F(DamagedLogs, EmptyOrOnlyAHead) {
  EXPECT_NE(refusal(""), "accepted");
  for (const char* text :
       {"\n",
        "\r\n\r\n",
        " ",
        "{}",
        "[]",
        "{",
        "<",
        "<a/>",
        "<a>",
        "\xEF\xBB\xBF",
        "null",
        "#\n",
        "%\n",
        "%TNCscopeNT data file",
        "%TNCscopeNT data file\n%[DATA]\n0;1;\n1;2;\n",
        "Date:;x\nEPOS Studio Version:;3\n",
        "Axis1\nNumber of sampling data,8\n",
        "Timestamp,\nInterval,\nChannel name,\nUnit,\n1,2\n",
        "a\n\"\n\nb",
        "Name\tx\nStarttime of export\t1\n",
        "Name\tx\nStarttime of export\t1\nEndtime of export\t2\n\nName\n\n",
        "overrun\noverrun\n",
        "{\"Payload\":[{\"HFData\":[[1,2],[2,3]]}]}",
        "{\"Header\":{\"SignalListHFData\":[{\"Name\":\"CYCLE\"}]},\"Payload\":[{\"HFData\":[[1],[2]]}]}",
        "<traceSession><traceData><dataFrame/></traceData></traceSession>"}) {
    EXPECT_NE(refusal(text), "accepted") << text;
  }
  for (const auto& sample : test::sample_logs()) {
    // The head alone: everything in front of the first row.
    const auto row = sample.text.find(sample.separator == 0 ? "rec time" : "\n0");
    if (row == std::string::npos) continue;
    EXPECT_NE(refusal(sample.text.substr(0, row + 1), options_of(sample)), "accepted") << sample.name;
  }
}

TEST_F(DamagedLogs, MadeToBeTooLarge) {
  std::string columns = "t [s]";
  std::string cells = "0";
  for (int i = 0; i < 1'000'000; ++i) {
    columns += ",c";
    cells += ",1";
  }
  EXPECT_NE(refusal(columns + "\n" + cells + "\n" + cells + "\n").find("expected at most 10000"),
            std::string::npos);
  EXPECT_NE(refusal("t [s]\tx\n" + std::string(300'000, '\t') + "\n0\t1\n"), "accepted");
  EXPECT_NE(refusal("Name\tx\nStarttime of export\t1\nEndtime of export\t2\n\nName" +
                    std::string(300'000, '\t') + "\n\n0\t1\n"),
            "accepted");

  EXPECT_NE(refusal(std::string(1'000'000, '[')).find("nested deeper"), std::string::npos);
  std::string deep = "{\"Header\":";
  for (int i = 0; i < 100'000; ++i) deep += "{\"a\":";
  EXPECT_NE(refusal(deep).find("nested deeper"), std::string::npos);
  std::string xml = "<traceSession>";
  for (int i = 0; i < 100'000; ++i) xml += "<a>";
  EXPECT_NE(refusal(xml).find("nested deeper"), std::string::npos);
  EXPECT_NE(
      refusal("<!DOCTYPE a [<!ENTITY b \"bbbb\"><!ENTITY c \"&b;&b;&b;\">]><traceSession>&c;</traceSession>")
          .find("document type"),
      std::string::npos);
  EXPECT_NE(refusal("{\"Payload\":[{\"HFData\":[[1e999]]}]}").find("too large"), std::string::npos);

  // A few bytes that state a hundred million samples are taken as absent samples, not filled in.
  std::string stated = test::sinumerik_trace_sample();
  for (const char* what : {"interval=\"0.002000\" datapointCount=\"8\""}) {
    const auto at = stated.find(what);
    stated.replace(at, std::string_view(what).size(),
                   "interval=\"0.00000000014\" datapointCount=\"100000001\"");
  }
  EXPECT_EQ(parse_log(stated, "a").at("Current i(q)").values.size(), 6u);
}

TEST_F(DamagedLogs, NoLogs) {
  EXPECT_NE(refusal(std::string_view("\xFF\xFE{\0\"\0", 6)), "accepted");
  EXPECT_NE(refusal(std::string_view("\xFF\xFE{\0\"", 5)).find("UTF-16"), std::string::npos);
  EXPECT_NE(refusal("PK\x03\x04xx").find("spreadsheet"), std::string::npos);
  EXPECT_NE(refusal(std::string_view("\x7f"
                                     "ELF\x02\x01\x01\0\0",
                                     9)),
            "accepted");
  EXPECT_NE(refusal("{\"name\": \"x\", \"version\": 1}").find("no SINUMERIK capture"), std::string::npos);
  EXPECT_NE(refusal("<html><body><p>404</p></body></html>").find("is a page of HTML"), std::string::npos);
  EXPECT_NE(refusal("Dear all,\n\nplease find the log attached.\n"), "accepted");
}

}  // namespace
}  // namespace stribeck::io::damaged_logs_test
