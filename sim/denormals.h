// Whether fp32 arithmetic flushes denormals, for the current thread, while the scope lives. D3D11.3 3.1.3.2
//
// The processor does it: FTZ and DAZ on x86, FZ on Arm; results and operands below 2^-126 become zeros that keep their sign.
// Loads, stores, conversions from half and integer operations keep denormal bits, as the specification says of moves. So does
// multiplying by a literal 1, which compilers drop: to them it is a move.
#pragma once

#include <cstdint>
#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace gnomon {

class DenormalScope {
public:
    explicit DenormalScope(bool flush) : saved_(read()) { enter(flush ? saved_ | kFlush : saved_ & ~kFlush); }
    ~DenormalScope() { enter(saved_); }
    DenormalScope(const DenormalScope&) = delete;
    DenormalScope& operator=(const DenormalScope&) = delete;

private:
#if defined(__SSE2__)
    using Control = std::uint32_t;
    static constexpr Control kFlush = 0x8040;  // FTZ, DAZ
    static Control read() { return _mm_getcsr(); }
    static void write(Control control) { _mm_setcsr(control); }
#elif defined(__aarch64__)
    using Control = std::uint64_t;
    static constexpr Control kFlush = 1u << 24;  // FZ
    static Control read() {
        Control control;
        asm volatile("mrs %0, fpcr" : "=r"(control));
        return control;
    }
    static void write(Control control) { asm volatile("msr fpcr, %0" : : "r"(control)); }
#else
#error "no way known to set the denormal mode of this processor"
#endif
    /// Arithmetic on what lies in memory stays on its side of the change.
    static void enter(Control control) {
        asm volatile("" ::: "memory");
        write(control);
        asm volatile("" ::: "memory");
    }

    Control saved_;
};

}  // namespace gnomon
