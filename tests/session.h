// Catch2's own code, compiled once for all test programs.
#pragma once

namespace gnomon {

/// Runs the tests that the arguments name, or `tests` in their place where it is not null. Returns what main returns.
int run_session(int argc, char** argv, const char* tests = nullptr);

}  // namespace gnomon
