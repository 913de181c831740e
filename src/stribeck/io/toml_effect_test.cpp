#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stribeck/io/keys.hpp>
#include <stribeck/io/toml.hpp>

/// Settings that count beside others only, and structs that a word may stand for.
namespace stribeck::io::test::toml_effect_test {
namespace {

struct Memory {
  static constexpr std::string_view kShortForm = "enabled";
  bool enabled = false;
  double time = 20.0;

  static constexpr auto fields() {
    return std::tuple{field("enabled", &Memory::enabled, "whether it runs").or_default(),
                      field("time", &Memory::time, quantity("s", "s").positive(), "how long it remembers")
                          .or_default()
                          .when([](const Memory& m) { return m.enabled; }, "goes with memory = \"on\"")};
  }
};

struct Settings {
  bool observed = false;
  double pole = 20.0;
  Memory memory;

  static constexpr auto fields() {
    using S = Settings;
    return std::tuple{field("observed", &S::observed, "whether there is an observer").or_default(),
                      field("pole", &S::pole, quantity("1/s", "1/s").positive(), "its pole")
                          .or_default()
                          .when([](const S& s) { return s.observed; }, "goes with observed = true"),
                      field("memory", &S::memory, "what it learns").or_default()};
  }
};

struct Controller {
  std::string id;
  Settings settings;

  static constexpr auto fields() {
    return std::tuple{field("id", &Controller::id, "name"), embedded(&Controller::settings)};
  }
};

Controller read_text(const std::string& text) { return read_toml_text<Controller>(text, "c.toml"); }

std::string refusal(const std::string& text) {
  try {
    read_text(text);
  } catch (const InputError& e) {
    return e.what();
  }
  return "nothing was refused";
}

TEST(TomlEffect, ReadsAndWritesEmbeddedStructsAsTheOwnersKeys) {
  const Controller c = read_text("id = \"a\"\nobserved = true\npole = \"30 1/s\"\n");
  EXPECT_EQ(c.settings.pole, 30.0);
  EXPECT_EQ(write_toml(c), "id = \"a\"\nobserved = true\npole = \"30 1/s\"\nmemory = \"off\"\n");
  EXPECT_THAT(refusal("id = \"a\"\npoel = 1\n"),
              testing::HasSubstr("c.toml:2: poel: unknown key (meant \"pole\"?)"));
}

TEST(TomlEffect, RefusesASettingWithoutEffectUnlessItIsAsItBegins) {
  EXPECT_EQ(refusal("id = \"a\"\npole = \"30 1/s\"\n"),
            "c.toml:2: pole: goes with observed = true only: set that, or leave this out");
  EXPECT_EQ(read_text("id = \"a\"\npole = \"20 1/s\"\n").settings.pole, 20.0);
  EXPECT_EQ(refusal("id = \"a\"\n[memory]\ntime = \"5 s\"\n"),
            "c.toml:3: memory.time: goes with memory = \"on\" only: set that, or leave this out");
}

TEST(TomlEffect, WritesNoSettingThatItWouldRefuse) {
  Controller c;
  c.id = "a";
  c.settings.pole = 30.0;
  const std::string text = write_toml(c);
  EXPECT_EQ(text, "id = \"a\"\nobserved = false\nmemory = \"off\"\n");
  EXPECT_FALSE(read_text(text).settings.observed);
}

TEST(TomlEffect, AWordStandsForASwitchWithEverythingElseAsItBegins) {
  EXPECT_TRUE(read_text("id = \"a\"\nmemory = \"on\"\n").settings.memory.enabled);
  EXPECT_FALSE(read_text("id = \"a\"\nmemory = \"off\"\n").settings.memory.enabled);
  EXPECT_EQ(refusal("id = \"a\"\nmemory = \"no\"\n"),
            "c.toml:2: memory: got \"no\", expected \"off\", \"on\" or a table [memory]");
  const Controller c = read_text("id = \"a\"\n[memory]\nenabled = true\ntime = \"5 s\"\n");
  EXPECT_TRUE(c.settings.memory.enabled);
  EXPECT_EQ(c.settings.memory.time, 5.0);
  EXPECT_EQ(write_toml(c),
            "id = \"a\"\nobserved = false\npole = \"20 1/s\"\n\n[memory]\nenabled = true\ntime = \"5 s\"\n");
}

TEST(TomlEffect, ReferencePagesSayWhenASettingHasAnEffect) {
  EXPECT_EQ(markdown_by_table(keys_of<Controller>(), 2), R"(
## Top of the file

| Key | Unit | Default | Range | Meaning | Has an effect |
|---|---|---|---|---|---|
| `id` | text | required |  | name |  |
| `observed` | true/false | false |  | whether there is an observer |  |
| `pole` | 1/s | 20 1/s | above 0 1/s | its pole | goes with observed = true |
| `memory` | text or table | off | off \| on, or the keys below | what it learns |  |

## `[memory]`

What it learns; off \| on, or the keys below (may be left out).

| Key | Unit | Default | Range | Meaning | Has an effect |
|---|---|---|---|---|---|
| `enabled` | true/false | false |  | whether it runs |  |
| `time` | s | 20 s | above 0 s | how long it remembers | goes with memory = "on" |
)");
}

}  // namespace
}  // namespace stribeck::io::test::toml_effect_test
