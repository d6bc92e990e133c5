// The `gnomon` command line: parse, call, print. docs/command_line.md is its manual.
//
// Exit codes: 0 done, 2 bad input or output (one line on stderr says what), 130 stopped by Ctrl-C, 143 by SIGTERM.
#include "commands.h"

#include "sim/error.h"
#include "studies/report.h"
#include "terminal.h"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <new>

namespace {

constexpr int kBadInput = 2;

/// Prints one line on stderr, whatever the message holds.
int complain(std::string message) {
    std::ranges::replace_if(message, [](char c) { return c == '\n' || c == '\r'; }, ' ');
    fmt::print(stderr, "gnomon: {}\n", message);
    return kBadInput;
}

int run(int argc, char** argv) {
    CLI::App app(
        "Gnomon: a software GPU for people who study shadow maps.\nRenders shadow techniques as the hardware would, to the "
        "bit, and measures them against ray-traced truth.",
        "gnomon");
    app.set_version_flag("--version", "gnomon " + gnomon::studies::version());
    app.require_subcommand(1);
    app.footer(
        "gnomon COMMAND --help tells more. Start with:\n"
        "  gnomon list\n"
        "  gnomon render --scene car --technique all --out out/car\n"
        "  gnomon contact-sheet out\n"
        "  gnomon study equal-storage --out out/studies\n"
        "  gnomon seam --scene city --technique psvsm --out out/seam\n"
        "  echo '0.3 0.6' | gnomon sample --checker 8x8 --footprint\n"
        "  echo '1 1 9 1 1 9' | gnomon coverage --size 16x16 --samples 4");
    gnomon::cli::add_list(app);
    gnomon::cli::add_render(app);
    gnomon::cli::add_export(app);
    gnomon::cli::add_contact_sheet(app);
    gnomon::cli::add_study(app);
    gnomon::cli::add_seam(app);
    gnomon::cli::add_sample(app);
    gnomon::cli::add_convert(app);
    gnomon::cli::add_coverage(app);
    gnomon::cli::add_chart(app);
    gnomon::cli::add_pipeline_chart(app);
    try {
        const auto is_named = [&](const CLI::App* command) { return command->get_name() == argv[1]; };
        if (argc > 1 && argv[1][0] != '-' && std::ranges::none_of(app.get_subcommands({}), is_named))
            return complain(fmt::format(
                "'{}' is not a command; expected list, render, study, seam, export, contact-sheet, sample, convert, coverage, "
                "chart or pipeline-chart",
                argv[1]));
        app.parse(argc, argv);
        if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) return complain("the output cannot be written to stdout");
        return 0;
    } catch (const CLI::Success& asked_for_help) {
        return app.exit(asked_for_help);
    } catch (const CLI::ParseError& error) {
        return complain(fmt::format("{} (gnomon --help shows the options)", error.what()));
    }
}

}  // namespace

int main(int argc, char** argv) {
    std::signal(SIGPIPE, SIG_IGN);  // a closed pipe is an error of writing, after which files are still put in order
    try {
        return run(argc, argv);
    } catch (const gnomon::Stopped&) {
        fmt::print(stderr, "gnomon: stopped; what was finished is there\n");
        return gnomon::cli::stop_exit_code();
    } catch (const std::bad_alloc&) {
        return complain("not enough memory for this request");
    } catch (const std::exception& error) {
        return complain(error.what());
    }
}
