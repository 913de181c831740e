#include <fmt/format.h>
#include <unistd.h>
#include <CLI/CLI.hpp>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>

#include <apps/cli/commands.hpp>
#include <apps/cli/expected.hpp>
#include <apps/cli/shared.hpp>
#include <apps/web/guard.hpp>
#include <apps/web/http_server.hpp>
#include <apps/web/site.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/printable.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::cli {
namespace {

struct ServeCommand {
  std::string folder = ".";
  int port = 0;
  std::string address = "127.0.0.1";
  std::string token;
};

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

int serve(const ServeCommand& o) {
  check_serve(o);
  web::Site site({o.folder, o.token, STRIBECK_VERSION});
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
      "Show the dashboard in a browser: what changes while a knob turns, and identification of logs that are dropped");
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
  refuse_empty_options(*verb);
  verb->footer("Example:\n  stribeck serve machines\n  stribeck serve --port 8080");
  verb->callback([o, &action] { action = [o] { return serve(*o); }; });
}

}  // namespace stribeck::cli
