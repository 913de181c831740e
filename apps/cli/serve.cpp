#include <fmt/format.h>
#include <unistd.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <apps/cli/commands.hpp>
#include <apps/cli/expected.hpp>
#include <apps/cli/shared.hpp>
#include <apps/web/guard.hpp>
#include <apps/web/http_server.hpp>
#include <apps/web/offline/offline_page.hpp>
#include <apps/web/site.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/printable.hpp>
#include <stribeck/workflow/live/sampler_stream.hpp>
#include <stribeck/workflow/live/stream_out.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::cli {
namespace {

struct ServeCommand {
  std::string folder = ".";
  int port = 0;
  std::string address = "127.0.0.1";
  std::string token;
  workflow::SamplerOptions live;
  std::string live_columns;
  std::string udp;
  std::string mqtt;
  std::string page;  ///< file of the dashboard that computes without the program; empty: serve
};

/// "x-cmd mm, x-fb mm"
std::vector<std::string> apart(const std::string& text) {
  std::vector<std::string> all;
  for (std::size_t at = 0; at <= text.size() && !text.empty();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    const std::size_t first = text.find_first_not_of(' ', at);
    const std::size_t last = text.find_last_not_of(' ', end == 0 ? 0 : end - 1);
    if (first >= end || last < first)
      refuse_option("--live-columns",
                    fmt::format("got {}, expected \"NAME UNIT,NAME UNIT,…\"", io::in_quotes(text)));
    all.push_back(text.substr(first, last - first + 1));
    at = end + 1;
  }
  return all;
}

/// The stream that the options name; absent: none.
std::optional<workflow::SamplerOptions> sampler_of(const ServeCommand& o) {
  if (o.live.source.empty()) {
    if (!o.live_columns.empty() || !o.live.side_file.empty() || !o.live.sample_time.empty() ||
        !o.live.axes.empty())
      refuse_option("--live", "is missing, the options --live-… belong to it (add --live FILE, or --live -)");
    return {};
  }
  workflow::SamplerOptions sampler = o.live;
  sampler.columns = apart(o.live_columns);
  return sampler;
}

std::vector<std::shared_ptr<workflow::LiveSink>> sinks_of(const ServeCommand& o) {
  constexpr unsigned short kMqttPort = 1883;
  std::vector<std::shared_ptr<workflow::LiveSink>> sinks;
  if (!o.udp.empty()) sinks.push_back(workflow::udp_sink(workflow::read_endpoint("--udp", o.udp, 0, false)));
  if (!o.mqtt.empty())
    sinks.push_back(workflow::mqtt_sink(workflow::read_endpoint("--mqtt", o.mqtt, kMqttPort, true)));
  return sinks;
}

void check_serve(const ServeCommand& o) {
  std::error_code wrong;
  if (!std::filesystem::is_directory(o.folder, wrong))
    refuse_option("FOLDER", fmt::format("got {}, expected a folder that exists", io::in_quotes(o.folder)));
  if (!o.token.empty()) {
    if (const auto what = web::Guard::problem(o.token); !what.empty())
      refuse_option("--token", std::string(what));
  } else if (!web::HttpServer::is_loopback(o.address)) {
    refuse_option(
        "--address",
        fmt::format(
            "others can reach {}, so it needs a token (add --token, e.g. what `openssl rand -hex 16` prints)",
            o.address));
  }
}

/// What stands in the address line of a browser. "All addresses" is none that it can open: the name of this computer then.
std::string host_to_open(const std::string& address) {
  if (address == "0.0.0.0" || address == "::") {
    std::array<char, 256> name{};
    if (::gethostname(name.data(), name.size() - 1) == 0 && name[0] != '\0')
      return io::printable(name.data());
  }
  return address.find(':') == std::string::npos ? address : "[" + address + "]";
}

/// The dashboard with the machine files of the folder, as one file.
int write_dashboard(const ServeCommand& o) {
  io::write_atomically(o.page, web::offline_page(web::machine_files(o.folder)));
  fmt::print("{}: open it in a browser; it needs neither the program nor a network\n", io::printable(o.page));
  return 0;
}

int serve(const ServeCommand& o) {
  check_serve(o);
  if (!o.page.empty()) return write_dashboard(o);
  web::Site site({o.folder, o.token, STRIBECK_VERSION, sampler_of(o), sinks_of(o)});
  web::Listen listen{o.address, static_cast<unsigned short>(o.port)};
  listen.signals = true;
  web::HttpServer server(listen, {[&](const web::Request& head) { return site.admit(head); },
                                  [&](web::Request request, web::Reply reply) {
                                    site.answer(std::move(request), std::move(reply));
                                  }});
  const std::string host = host_to_open(o.address);
  fmt::print("Dashboard of {}: http://{}:{}/{} (Ctrl-C ends it)\n", o.folder, host, server.port(),
             o.token.empty() ? "" : "?token=" + o.token);
  std::fflush(stdout);
  server.run();
  // An identification cannot be interrupted; nobody waits for it any more.
  constexpr std::chrono::milliseconds kPatience{500};
  if (!site.stop(kPatience)) {
    site.save_recording();
    std::error_code ignored;
    std::filesystem::remove_all(site.session_folder(), ignored);
    std::_Exit(0);
  }
  return 0;
}

}  // namespace

void add_serve(CLI::App& app, Action& action) {
  auto* verb = app.add_subcommand(
      "serve",
      "Show the dashboard in a browser: what changes while a knob turns, identification of logs that are dropped, and a machine that runs");
  auto o = std::make_shared<ServeCommand>();
  verb->add_option("folder", o->folder,
                   "Folder whose machine files can be chosen beside those that are built in")
      ->type_name("FOLDER")
      ->capture_default_str();
  verb->add_option("--port", o->port, "Port; 0: any free one")
      ->check(whole_from(0, 65535))
      ->capture_default_str();
  verb->add_option("--address", o->address,
                   "Address to listen at; one that other computers reach needs --token")
      ->type_name("ADDRESS")
      ->capture_default_str();
  verb->add_option(
          "--token", o->token,
          "Word that every request must bring, 16 characters or more; the printed address contains it")
      ->type_name("TOKEN");
  verb->add_option(
          "--live", o->live.source,
          "Stream of a machine to show, as LinuxCNC's halsampler writes it: a file that grows, a pipe, or - for the standard input")
      ->type_name("FILE");
  verb->add_option("--live-columns", o->live_columns, "Its columns in their order, with units")
      ->type_name("\"NAME UNIT,…\"");
  verb->add_option("--live-side", o->live.side_file,
                   "The same, and the sample time, from a side file as beside a log (columns, sample_time)")
      ->type_name("FILE.toml");
  verb->add_option("--live-period", o->live.sample_time, "Period of the thread that samples")
      ->type_name("TIME");
  verb->add_option(
          "--live-axis", o->live.axes,
          "Columns with commanded and actual position of an axis, for the contour error; left out: by their names")
      ->type_name("AXIS=COMMANDED,ACTUAL")
      ->expected(1)
      ->take_all();
  verb->add_option(
          "--udp", o->udp,
          "Send every row of a stream as JSON in a UDP datagram, which PlotJuggler reads: PORT of this computer, or ADDRESS:PORT")
      ->type_name("PORT");
  verb->add_option(
          "--mqtt", o->mqtt,
          "Publish every row of a stream at an MQTT broker: HOST, HOST:PORT or HOST:PORT/TOPIC (1883, stribeck/live)")
      ->type_name("HOST");
  verb->add_option(
          "--page", o->page,
          "In place of serving, write the dashboard with the machine files of the folder as one file: it computes in "
          "any browser, without the program and without a network")
      ->type_name("FILE.html");
  refuse_empty_options(*verb);
  verb->footer(
      "Examples:\n  stribeck serve machines\n  stribeck serve --port 8080\n  stribeck serve machines --page dashboard.html\n"
      "  halsampler -t | stribeck serve --live - --live-side run.log.toml --udp 9870");
  verb->callback([o, &action] { action = [o] { return serve(*o); }; });
}

}  // namespace stribeck::cli
