// The dashboard without its socket. The first byte chooses: the head of a request in lines (target, host, origin, authorization, cookie),
// or the body of a request. Whatever it says, the answer is one of HTTP's that are meant, and nothing of a file beside the folder is in it.
#include <unistd.h>

#include <apps/web/json_request.hpp>
#include <apps/web/site.hpp>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/sim/contour_run.hpp>
#include <tests/fuzz/targets/fuzz.hpp>

namespace stribeck::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr const char* kToken = "0123456789abcdef";
constexpr std::string_view kSecret = "NOBODY-MAY-READ-THIS";

/// A folder that is served, and beside it a file that is not; of this process.
struct Served {
  fs::path outer;
  std::unique_ptr<web::Machines> machines;
  std::unique_ptr<web::WhatIf> what_if;
  std::unique_ptr<web::Site> open;
  std::unique_ptr<web::Site> guarded;

  Served() {
    std::string name = (fs::temp_directory_path() / "stribeck-fuzz-XXXXXX").string();
    demand(mkdtemp(name.data()) != nullptr, "no folder");
    outer = name;
    const fs::path folder = outer / "served";
    fs::create_directory(folder);
    std::string machine = file_of("machines/biaxial-table.toml");
    std::ofstream(folder / "mine.toml") << machine;
    machine.replace(machine.find("name = \"biaxial table\"") + 8, 13, kSecret);
    std::ofstream(outer / "secret.toml") << machine;
    fs::create_symlink("../secret.toml", folder / "link.toml");
    machines = std::make_unique<web::Machines>(folder);
    what_if = std::make_unique<web::WhatIf>(*machines);
    open = std::make_unique<web::Site>(web::SiteOptions{folder, "", "fuzz"});
    guarded = std::make_unique<web::Site>(web::SiteOptions{folder, kToken, "fuzz"});
  }
  ~Served() {
    open.reset();
    guarded.reset();
    std::error_code ignored;
    fs::remove_all(outer, ignored);
  }
};

void check(const web::Response& r) {
  constexpr std::array kMeant{200, 303, 400, 401, 403, 404, 405, 422, 503};
  demand(std::find(kMeant.begin(), kMeant.end(), r.status) != kMeant.end(), "a status that is not meant");
  demand(r.body.find(kSecret) == std::string::npos, "a file outside the folder");
  for (const auto& [name, value] : r.headers)
    demand(value.find_first_of("\r\n") == std::string::npos, "a header of two lines");
}

void ask(web::Site& site, const web::Request& request) {
  if (const auto admitted = site.admit(request); admitted.refused) return check(*admitted.refused);
  if (web::path_of(request.target) == "/results/page") return;  // answers from another thread
  int answers = 0;
  site.answer(request, [&](const web::Response& r) {
    ++answers;
    check(r);
  });
  demand(answers == 1, "not one answer");
}

void head(Served& served, std::string_view input) {
  std::array<std::string, 5> lines;
  for (std::string& line : lines) {
    line = input.substr(0, input.find('\n'));
    input.remove_prefix(std::min(line.size() + 1, input.size()));
  }
  web::Request request{"GET", lines[0], lines[1], lines[2], lines[3], lines[4], {}};
  ask(*served.open, request);
  ask(*served.guarded, request);
  const bool knows = request.authorization.find(kToken) != std::string::npos ||
                     request.cookie.find(kToken) != std::string::npos ||
                     request.target.find(kToken) != std::string::npos ||
                     request.target.find('%') != std::string::npos;
  const auto refused = served.guarded->admit(request).refused;
  demand(knows || (refused && refused->status == 401), "no token, and let in");
}

/// As far as the identification, which takes seconds.
void plan(Served& served, std::string_view input) {
  int asked = 0;
  try {
    const auto request = web::read_request<web::WhatIfRequest>(input);
    const std::string text = served.what_if->run(request, [&] { return ++asked > 1; }).dump();
    demand(text.find(kSecret) == std::string::npos, "a file outside the folder");
  } catch (const web::Outdated&) {
  } catch (const io::InputError& e) {
    demand(std::string_view(e.what()).find(kSecret) == std::string_view::npos, "a file outside the folder");
  } catch (const sim::Refused&) {
  }
}

}  // namespace

std::vector<std::string> seeds() {
  const std::string zero(1, '\0');
  return {
      zero +
          "/api/machine?id=folder/mine.toml\n127.0.0.1:80\nhttp://127.0.0.1:80\nBearer 0123456789abcdef\nstribeck=0123456789abcdef",
      zero + "/?token=0123456789abcdef\nlocalhost\n\n\na=b; stribeck=x",
      zero + "/what-if.js\n[::1]:80\n\n\n",
      zero + "/api/machine?id=folder%2flink.toml\nlocalhost\n\n\n",
      "\1{\"machine\":\"folder/link.toml\",\"controllers\":[\"a\"]}",
      "\1{\"machine\":\"folder/../secret.toml\",\"controllers\":[\"a\"]}",
      "\1{\"machine\":\"folder/mine.toml\",\"controllers\":[\"a\"],\"changes\":[{\"key\":\"*.friction.coulomb\",\"scale\":2},{\"key\":\"x.mass\",\"value\":\"60 N s2/mm\"}],\"sample_time\":\"4 ms\"}",
      "\2{\"machine\":\"folder/mine.toml\",\"motion\":\"own\",\"size\":\"8 mm\",\"speed\":\"5 mm/s\",\"controllers\":[\"a\",\"f\",\"kalman\"],\"omega_t\":\"50 rad/s\",\"observer_pole\":\"30 1/s\",\"parameters\":\"thesis\",\"seed\":3,\"client\":\"p\"}",
      "\2{\"machine\":\"built-in/triaxial-tool\",\"motion\":\"experiment\",\"controllers\":[\"c\"],\"identify_changed\":true,\"changes\":[{\"key\":\"z.friction.steady.positive.eta0\",\"scale\":1.5}]}",
      "\1{\"machine\":\"folder/link.toml\",\"controller\":\"a\",\"friction\":1.5,\"times\":20}",
      "\3{\"logs\":[\"1\"],\"axis\":\"x\",\"maps\":[\"x=pos mm\"],\"gain\":\"3 N/V\",\"method\":\"jog\",\"model\":\"gaussian\"}"};
}

std::vector<std::string> words() {
  return {"folder/",       "built-in/",   "../",       "..%2f",      "secret.toml",
          "link.toml",     "/etc/passwd", "/api/",     "machines",   "what-if",
          "?id=",          "&",           "%00",       "\"key\"",    "\"scale\"",
          "\"value\"",     "*.friction.", "viscous",   "noise.rms",  "encoder.resolution",
          "delay_periods", "\"20 um\"",   "trifolium", "experiment", "null",
          "true",          "[1]"};
}

void one(std::string_view input) {
  static Served served;
  const std::uint8_t mode = mode_of(input);
  if (mode % 4 == 0) return head(served, input);
  if (mode % 4 == 2) return plan(served, input);
  web::Request request;
  request.method = "POST";
  request.target = mode % 4 == 1 ? "/api/machine-file" : "/api/logs?name=x.csv";
  request.host = "127.0.0.1:80";
  request.body = std::string(input);
  ask(*served.open, request);
  if (mode % 4 != 3) return;
  try {
    web::read_request<web::IdentifyRequest>(input);
  } catch (const io::InputError&) {
  }
}

}  // namespace stribeck::fuzz
