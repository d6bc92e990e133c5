// The subcommands of `gnomon`. Each adds itself to the parser and runs when it is chosen; errors leave as gnomon::Error.
#pragma once

#include <CLI/CLI.hpp>

namespace gnomon::cli {

void add_list(CLI::App& app);
void add_render(CLI::App& app);
void add_export(CLI::App& app);
void add_contact_sheet(CLI::App& app);
void add_study(CLI::App& app);
void add_seam(CLI::App& app);
void add_sample(CLI::App& app);
void add_convert(CLI::App& app);
void add_coverage(CLI::App& app);
void add_chart(CLI::App& app);
void add_pipeline_chart(CLI::App& app);

}  // namespace gnomon::cli
