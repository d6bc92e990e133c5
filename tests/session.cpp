// Catch2's own code: the one unit that defines CATCH_CONFIG_RUNNER.
#include "tests/session.h"

#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>

namespace gnomon {

int run_session(int argc, char** argv, const char* tests) {
    Catch::Session session;
    if (const int error = session.applyCommandLine(argc, argv); error != 0) return error;
    if (tests != nullptr) session.configData().testsOrTags = {tests};
    return session.run();
}

}  // namespace gnomon
