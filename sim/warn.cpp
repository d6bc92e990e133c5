#include "sim/warn.h"

#include <fmt/format.h>

#include <cstdio>
#include <mutex>
#include <set>

namespace gnomon {

void warn_once(const std::string& message) {
    static std::mutex mutex;
    static std::set<std::string> said;
    const std::lock_guard lock(mutex);
    if (said.insert(message).second) fmt::print(stderr, "warning: {}\n", message);
}

}  // namespace gnomon
