// The options that say what to render: scene, technique, machine. Shared by the commands that render.
#pragma once

#include "studies/experiment.h"

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace gnomon::cli {

/// A request as options fill it in.
struct RequestOptions {
    studies::RenderRequest request{};
    std::vector<std::string> set_texts{};  // "name=value"

    /// The request with what was set. Throws Error.
    [[nodiscard]] studies::RenderRequest checked() const;
};

/// --scene, --ground, --auto-view, --size. `options` must live as long as the parser.
void add_scene_options(CLI::App& command, RequestOptions& options);
/// --reference, --seed.
void add_truth_options(CLI::App& command, RequestOptions& options);
/// --technique (`about` explains it), --map, --format and what else a technique takes.
void add_technique_options(CLI::App& command, RequestOptions& options, const std::string& about);
/// --profile, --threads.
void add_machine_options(CLI::App& command, RequestOptions& options);

}  // namespace gnomon::cli
