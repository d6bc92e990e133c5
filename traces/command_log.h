// Writes every command that a device executes as one line of JSON: the front half of a trace.
//
// Lines hold what the device was told and nothing about C++: programs by registered name, constants by field name, states by
// name, data by size and hash. The bytes themselves are not stored yet, so a log can be read, compared and searched; replay
// needs the data beside it and comes with the trace folder. docs/command_line.md shows a log.
#pragma once

#include "pipeline/command.h"

#include <cstddef>
#include <ostream>

namespace gnomon::traces {

/// The command as one line of JSON, without the newline.
std::string command_line(const Command& command);

/// Give it to a device:  device.set_observer([&log](const Command& command) { log.write(command); });
class CommandLog {
public:
    /// `out` must outlive the log; whether it took everything is for its owner to check.
    explicit CommandLog(std::ostream& out) : out_(out) {}

    void write(const Command& command);
    [[nodiscard]] std::size_t count() const { return count_; }

private:
    std::ostream& out_;
    std::size_t count_ = 0;
};

}  // namespace gnomon::traces
