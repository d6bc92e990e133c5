// Warnings for input that is valid but not fully supported: one line on stderr, each message once per process.
#pragma once

#include <string>

namespace gnomon {

/// Prints `warning: <message>` on stderr the first time this exact message is given. Safe from any thread.
void warn_once(const std::string& message);

}  // namespace gnomon
