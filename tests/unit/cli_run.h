// The gnomon program as a child process, for tests.
#pragma once

#include "tests/unit/scenes_files.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

namespace gnomon::test {

struct Outcome {
    int code = 0;
    std::string out;
    std::string err;
};

inline std::string text_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// Runs gnomon in the folder, with arguments as a shell has them and `input` on stdin.
inline Outcome gnomon_run(const TemporaryFolder& folder, const std::string& arguments, const std::string& input = {}) {
    const auto in = folder.path() / "stdin.txt";
    const auto out = folder.path() / "stdout.txt";
    const auto err = folder.path() / "stderr.txt";
    if (!input.empty()) std::ofstream(in, std::ios::binary) << input;
    const std::string command = fmt::format("cd '{}' && '{}' {} <'{}' >'{}' 2>'{}'", folder.path().string(), GNOMON_CLI_PATH,
                                            arguments, input.empty() ? "/dev/null" : in.string(), out.string(), err.string());
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), text_of(out), text_of(err)};
}

inline std::set<std::string> files_in(const std::filesystem::path& path) {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(path)) names.insert(entry.path().filename().string());
    return names;
}

/// Whether bad input gets one line on stderr, exit code 2, and nothing written.
inline void check_refused(const TemporaryFolder& folder, const std::string& arguments) {
    const auto without_streams = [&] {
        std::set<std::string> names = files_in(folder.path());
        names.erase("stdout.txt");
        names.erase("stderr.txt");
        return names;
    };
    const std::set<std::string> before = without_streams();
    INFO(arguments);
    const Outcome run = gnomon_run(folder, arguments);
    CHECK(run.code == 2);
    INFO(run.err);
    CHECK(run.err.starts_with("gnomon: "));
    CHECK(std::ranges::count(run.err, '\n') == 1);
    CHECK(without_streams() == before);
}

}  // namespace gnomon::test
