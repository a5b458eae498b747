// Functions that a compiler may call by itself: nothing is linked against.
#include "types.hpp"

#define RW_HIDDEN extern "C" __attribute__((used, visibility("hidden")))

RW_HIDDEN void* memset(void* target, int value, Size count) {
    for (Size i = 0; i < count; i++) static_cast<volatile char*>(target)[i] = static_cast<char>(value);
    return target;
}

RW_HIDDEN void* memcpy(void* target, const void* source, Size count) {
    for (Size i = 0; i < count; i++) static_cast<volatile char*>(target)[i] = static_cast<const char*>(source)[i];
    return target;
}

RW_HIDDEN void* memmove(void* target, const void* source, Size count) {
    if (target <= source) return memcpy(target, source, count);
    for (Size i = count; i-- > 0;) static_cast<volatile char*>(target)[i] = static_cast<const char*>(source)[i];
    return target;
}

#if defined(_WIN32)
extern "C" __attribute__((used)) int DllMainCRTStartup(void*, unsigned, void*) { return 1; }
#endif

#if defined(__wasm__)
// Products and shifts of whole numbers of 128 bits, which the compiler calls where a processor has none.
static U128 joined(U64 high, U64 low) { return static_cast<U128>(high) << 64 | low; }

RW_HIDDEN U128 __multi3(U128 a, U128 b) {
    const U64 x = static_cast<U64>(a), y = static_cast<U64>(b), mask = 0xffffffffu;
    const U64 low = (x & mask) * (y & mask), middle = (x >> 32) * (y & mask) + (low >> 32);
    const U64 other = (x & mask) * (y >> 32) + (middle & mask);
    const U64 high = (x >> 32) * (y >> 32) + (middle >> 32) + (other >> 32);
    const U64 crossed = static_cast<U64>(a >> 64) * y + x * static_cast<U64>(b >> 64);
    return joined(high + crossed, other << 32 | (low & mask));
}

RW_HIDDEN U128 __ashlti3(U128 a, int count) {
    const U64 low = static_cast<U64>(a), high = static_cast<U64>(a >> 64);
    if (count >= 64) return joined(low << (count - 64), 0);
    return count ? joined(high << count | low >> (64 - count), low << count) : a;
}
#endif
