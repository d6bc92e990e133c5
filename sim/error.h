// Errors a user can cause, and the invariants only we can break.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <utility>

namespace gnomon {

/// Bad input: a file, an option, a trace, a mesh. The message is one line that says what, where and what was expected;
/// the command line prints it on stderr and exits with code 2.
class Error : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Throws Error with a formatted message.
template <class... Args>
[[noreturn]] void fail(fmt::format_string<Args...> format, Args&&... args) {
    throw Error(fmt::format(format, std::forward<Args>(args)...));
}

/// The user asked to stop (Ctrl-C); what was finished stays.
class Stopped : public std::runtime_error {
public:
    Stopped() : std::runtime_error("stopped") {}
};

namespace detail {
template <class A, class B>
[[noreturn]] void check_failed(const char* file, int line, const char* what, const A& a, const B& b) {
    fmt::print(stderr, "{}:{}: check failed: {} (left {}, right {})\n", file, line, what, a, b);
    std::abort();
}
}  // namespace detail

}  // namespace gnomon

/// Always on; prints both operands. For our own mistakes, never for input.
#define GNOMON_CHECK_OP(a, op, b)                                                                    \
    do {                                                                                             \
        const auto& check_a = (a);                                                                   \
        const auto& check_b = (b);                                                                   \
        if (!(check_a op check_b)) [[unlikely]]                                                      \
            ::gnomon::detail::check_failed(__FILE__, __LINE__, #a " " #op " " #b, check_a, check_b); \
    } while (false)
#define GNOMON_CHECK(condition) GNOMON_CHECK_OP(static_cast<bool>(condition), ==, true)
#define GNOMON_CHECK_EQ(a, b) GNOMON_CHECK_OP(a, ==, b)
#define GNOMON_CHECK_LT(a, b) GNOMON_CHECK_OP(a, <, b)
#define GNOMON_CHECK_LE(a, b) GNOMON_CHECK_OP(a, <=, b)
