// Threads that take the steps of one motion together, each in a call of its own.
//
// A structure has parts, which its Model fixes: runs with the bands inside them. There are either one thread or as many
// as parts. Forces and sums that concern several parts belong to the first thread, while the others wait; so the order
// of all sums, and with it every bit, is the same for any number of threads.
#pragma once

#include "arena.hpp"

namespace RW_VARIANT {

inline void pause() {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#elif defined(__aarch64__)
    __asm__ volatile("yield");
#endif
}

struct Team {
    I64 thread, threads;
    Workspace& w;

    bool leads() const { return thread == 0; }

    // Wait for all others. Each writes a counter of its own, on a line of its own.
    void meet() const {
        if (threads == 1) return;
        const I64 mine = *slot(thread) + 1;
        __atomic_store_n(slot(thread), mine, __ATOMIC_RELEASE);
        for (I64 other = 0; other < threads; other++)
            while (__atomic_load_n(slot(other), __ATOMIC_ACQUIRE) < mine) pause();
    }

  private:
    I64* slot(I64 of) const { return w.arrived.at(of * stride_of(1)); }
};

}  // namespace RW_VARIANT
