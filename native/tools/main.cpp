// gradus: renders saved scenes into frame stores, reconstructs frame stores, compares images.
#include <csignal>
#include <cstdio>
#include <exception>

#include "common.h"

int main(int argc, char** argv) {
  using namespace gradus::tool;
  std::signal(SIGXFSZ, SIG_IGN);  // so that a write beyond the limit of file sizes fails, and the error names the file
  CLI::App app(
      "Gradus, a gradient-domain path tracer: renders saved scenes, reconstructs stored films, compares images.",
      "gradus");
  app.set_version_flag("--version", gradus_version_text());
  app.require_subcommand(1);
  app.get_formatter()->column_width(34);
  app.footer("Exit codes: 0 done, 1 failed, 2 wrong usage, 130 interrupted. gradus COMMAND --help shows more.");
  int exit_code = 0;
  add_render(&app, &exit_code);
  add_reconstruct(&app, &exit_code);
  add_compare(&app, &exit_code);
  add_info(&app, &exit_code);
  add_motion(&app, &exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (app.get_subcommands().empty() && !app.remaining().empty()) {
      std::fprintf(stderr, "gradus: there is no command or option %s\n", app.remaining().front().c_str());
    }
    return app.exit(e) == 0 ? 0 : kExitUsage;
  } catch (const gradus::client::Error& e) {
    std::fprintf(stderr, "gradus: %s\n", e.what());
    return e.code() == GRADUS_ERROR_CANCELLED ? kExitInterrupted : kExitFailure;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "gradus: %s\n", e.what());
    return kExitFailure;
  }
  return exit_code;
}
